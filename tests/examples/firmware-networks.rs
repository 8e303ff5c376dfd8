//! Trains the networks of the firmware and the example, and writes them as Rust source:
//! `cargo run --release -p mindgap-tests --example firmware-networks`.

use std::path::Path;

use mindgap_files as files;
use mindgap_foundations::error::Result;

fn main() -> Result<()> {
    let top = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    for (file, source) in mindgap_tests::firmware_networks::files()? {
        files::write(&top.join(file), &source)?;
    }
    Ok(())
}
