//! Generated Rust sources of networks, for the images in `tests/firmware` and the example in `core/examples`.

use mindgap_built_in_robot::{default_robot, record, training_room};
use mindgap_controller_export::rust_networks::rust_networks;
use mindgap_foundations::error::Result;
use mindgap_foundations::executor::Serial;
use mindgap_learning::learn::train::{TABLE_ONE, Trainer, train};
use mindgap_models::simulator::fixed_point::FixedNetworks;

/// The logs that the networks are trained on.
const RUNS: usize = 40;
const STEPS: usize = 60;
const SEED: u64 = 1;

/// Returns the path of each file in the project and its content: networks trained on the built-in robot.
///
/// # Errors
/// If a network cannot be trained or does not fit fixed point.
pub fn files() -> Result<[(&'static str, String); 2]> {
    let logs = record(&default_robot(), &training_room(), RUNS, STEPS, &[], SEED)?;
    let simulator = train(&Serial, &logs, &Trainer::Fast, &TABLE_ONE, SEED, &|_| {})?;
    let all = FixedNetworks::quantise(&simulator)?.rust_definitions();
    let [_, forward, _, echo_probability, _] = all.clone();
    Ok([
        ("tests/firmware/src/networks.rs", file(&all)),
        ("core/examples/rtic/src/networks.rs", file(&[forward, echo_probability])),
    ])
}

fn file(networks: &[String]) -> String {
    let head = "//! Networks trained on logs of the built-in robot; made by
//! `cargo run --release -p mindgap-tests --example firmware-networks`.";
    format!("{head}\n\n{}", rust_networks(networks))
}
