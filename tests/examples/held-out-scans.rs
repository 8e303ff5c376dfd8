//! Prints how likely the first-echo law makes scans at places that it was not fitted on, as a table in Markdown for
//! docs/reference/measurements.md: `cargo run --release -p mindgap-tests --example held-out-scans -- FOLDER…`, one folder of scans each.

use std::path::Path;
use std::process::ExitCode;

use mindgap_foundations::error::Result;
use mindgap_logs::Logs;
use mindgap_tests::exit_code::exit_code;
use mindgap_tests::held_out_scans::HeldOut;

fn main() -> ExitCode {
    exit_code(env!("CARGO_BIN_NAME"), print())
}

fn print() -> Result<()> {
    println!("| team | readings | poses refitted | heading refitted | poses as logged |");
    println!("| --- | --- | --- | --- | --- |");
    for folder in std::env::args().skip(1) {
        let folder = Path::new(&folder);
        let HeldOut { readings, poses_refitted, heading_refitted, as_logged } =
            HeldOut::of(Logs::read(folder, |_| ())?);
        let name = folder.file_name().unwrap_or_default().to_string_lossy();
        println!("| {name} | {readings} | {poses_refitted:.2} | {heading_refitted:.2} | {as_logged:.2} |");
    }
    Ok(())
}
