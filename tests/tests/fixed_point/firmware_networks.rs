//! The networks of firmware and example are those that their generator makes.

use std::fs;
use std::path::Path;

#[test]
fn the_sources_are_what_the_generator_makes() {
    let top = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    for (file, made) in mindgap_tests::firmware_networks::files().unwrap() {
        let there = fs::read_to_string(top.join(file)).unwrap();
        assert!(there == made, "{file} is old: run the binary firmware-networks");
    }
}
