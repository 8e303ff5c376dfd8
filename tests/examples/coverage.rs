//! Prints how often open-loop paths of held-out logs end within the regions that a simulator predicts, as the rows of the
//! table in docs/reference/measurements.md: `cargo run --release -p mindgap-tests --example coverage -- SIM LOGS…`. In place of a folder,
//! `controllers` stands for runs of random controllers on the built-in robot.

use std::path::Path;
use std::process::ExitCode;

use mindgap_foundations::error::{Error, Result};
use mindgap_logs::Logs;
use mindgap_models::simulator::Simulator;
use mindgap_tests::coverage::{Coverage, controller_runs, coverage};
use mindgap_tests::exit_code::exit_code;

const SEED: u64 = 5;
const CONTROLLERS: usize = 200;

fn main() -> ExitCode {
    exit_code(env!("CARGO_BIN_NAME"), print())
}

fn print() -> Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [simulator, folders @ ..] = arguments.as_slice() else { return Err(Error::new("SIM LOGS…")) };
    let simulator = Simulator::read(Path::new(simulator))?;
    println!("| logs | steps | paths | places: 50 % | 80 % | 95 % | headings: 50 % | 80 % | 95 % |");
    println!("| --- | --- | --- | --- | --- | --- | --- | --- | --- |");
    for folder in folders {
        let logs = match folder.as_str() {
            "controllers" => controller_runs(&simulator, CONTROLLERS, SEED),
            folder => Logs::read(Path::new(folder), |_| {})?,
        };
        let missing = || Error::new("the simulator file has no parameter uncertainty");
        for Coverage { steps, paths, places, headings } in coverage(&simulator, &logs, SEED).ok_or_else(missing)? {
            let shares: Vec<String> =
                places.iter().chain(&headings).map(|share| format!("{:.0}", 100.0 * share)).collect();
            println!("| {folder} | {steps} | {paths} | {} |", shares.join(" | "));
        }
    }
    Ok(())
}
