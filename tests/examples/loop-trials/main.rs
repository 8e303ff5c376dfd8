//! Measures the loop on the built-in robot in generated rooms against procedures without it, as rows of CSV for
//! docs/reference/measurements.md: `cargo run --release -p mindgap-tests --example loop-trials -- SIM LOGS FIRST COUNT PROCEDURE…`. `LOGS` are those
//! that `SIM` was trained on; `FIRST` and `COUNT` say which of the 360 cases, which are in random order.

mod cases;
mod on_robot;
mod procedures;

use std::path::Path;
use std::process::ExitCode;

use mindgap_foundations::error::{Error, Result};
use mindgap_logs::Logs;
use mindgap_models::simulator::Simulator;
use mindgap_tests::exit_code::exit_code;
use procedures::{PROCEDURES, Settled, Workbench};

fn main() -> ExitCode {
    exit_code(env!("CARGO_BIN_NAME"), measure())
}

fn measure() -> Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [sim, logs, first, count, wanted @ ..] = arguments.as_slice() else {
        return Err(Error::new("SIM LOGS FIRST COUNT PROCEDURE…"));
    };
    let number = |text: &String| text.parse::<usize>().map_err(|e| Error::new(format!("{text}: {e}")));
    let (path, logs) = (Path::new(sim), Logs::read(Path::new(logs), |_| {})?);
    let simulator = Simulator::read(path)?;
    let known = || PROCEDURES.map(|(name, _)| name).join(", ");
    let procedure = |name: &String| {
        let found = PROCEDURES.into_iter().find(|(known, _)| known == name);
        found.ok_or_else(|| Error::new(format!("{name} is none of {}", known())))
    };
    let procedures = wanted.iter().map(procedure).collect::<Result<Vec<_>>>()?;
    let cases = cases::all(simulator.robot.body_radius_cm);
    println!("case,room,start,effect,procedure,trials,fresh_successes,verdict");
    for (case, at) in cases.iter().zip(0..).skip(number(first)?).take(number(count)?) {
        let bench = Workbench { path, simulator: &simulator, logs: &logs, case };
        for (name, run) in &procedures {
            let Settled { controller, trials, verdict } = run(&bench)?;
            let effect = case.effect.map_or_else(|| "none".into(), |effect| effect.to_string());
            let successes = case.fresh_successes(&controller);
            println!("{at},{},{},{effect},{name},{trials},{successes},{verdict}", case.room, case.start);
        }
    }
    Ok(())
}
