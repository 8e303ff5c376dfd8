//! The networks that the images run are those that their generator makes.

#[test]
fn the_source_is_what_the_generator_makes() {
    let made = mindgap_tests::firmware_networks::rust_source();
    assert!(made == include_str!("../firmware/src/networks.rs"), "run the binary firmware-networks");
}
