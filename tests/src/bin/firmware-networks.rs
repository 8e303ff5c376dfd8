//! Prints the networks of `tests/firmware` as Rust source:
//! `cargo run -p mindgap-tests --bin firmware-networks > tests/firmware/src/networks.rs`.

fn main() {
    print!("{}", mindgap_tests::firmware_networks::rust_source());
}
