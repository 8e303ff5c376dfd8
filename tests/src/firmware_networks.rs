//! Generated Rust sources of networks: those that the images under `tests/firmware` run, and those of the example under
//! `core/examples`.

use mindgap_built_in_robot::{default_robot, record, training_room};
use mindgap_controller_export::rust_networks::rust_networks;
use mindgap_foundations::error::Result;
use mindgap_learning::learn::train::{TABLE_ONE, Trainer, train};
use mindgap_models::simulator::fixed_point::FixedNetworks;

/// The logs that the networks are trained on.
const RUNS: usize = 40;
const STEPS: usize = 60;
const SEED: u64 = 1;

/// Each file from the top of the project, and what it has to hold: networks trained on the built-in robot.
///
/// # Errors
/// When a network cannot be trained or has no fixed-point form.
pub fn files() -> Result<[(&'static str, String); 2]> {
    let logs = record(&default_robot(), &training_room(), RUNS, STEPS, &[], SEED)?;
    let simulator = train(&logs, &Trainer::Fast, &TABLE_ONE, SEED, &|_| {})?;
    let all = FixedNetworks::quantise(&simulator)?.rust_definitions();
    let [_, forward, _, echo_probability, _] = all.clone();
    Ok([
        ("tests/firmware/src/networks.rs", file(&all)),
        ("core/examples/rtic/src/networks.rs", file(&[forward, echo_probability])),
    ])
}

fn file(networks: &[String]) -> String {
    let head = "//! Networks trained on logs of the built-in robot; made by
//! `cargo run --release -p mindgap-tests --bin firmware-networks`.";
    format!("{head}\n\n{}", rust_networks(networks))
}
