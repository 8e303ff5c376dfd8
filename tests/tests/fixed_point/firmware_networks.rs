//! The networks of the firmware and the example are up to date.

use std::fs;
use std::path::Path;

#[test]
fn sources_equal_the_output_of_the_generator() {
    let top = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    for (file, generated) in mindgap_tests::firmware_networks::files().unwrap() {
        let existing = fs::read_to_string(top.join(file)).unwrap();
        assert!(existing == generated, "{file} is out of date: run the binary firmware-networks");
    }
}
