//! Generated Rust sources of networks: those that the images under `tests/firmware` run, and those of the example under
//! `core/examples`.

use mindgap_controller_export::rust_networks::{rust_network, rust_networks};
use mindgap_core::fixed_network::FixedNetwork;
use mindgap_core::network::Network;

use crate::plausible_networks::plausible_networks;

/// Each file from the top of the project, and what it has to hold.
pub fn files() -> [(&'static str, String); 2] {
    let networks = plausible_networks(1);
    let turn = source("TURN", "Turn of a step in degrees.", &networks.turn);
    let forward = source("FORWARD", "Forward movement in a step in cm.", &networks.forward);
    let lateral = source("LATERAL", "Movement to the left in a step in cm.", &networks.lateral);
    let echo_probability = source("ECHO_PROBABILITY", "Probability of an echo.", &networks.echo_probability);
    let echo_value = source("ECHO_VALUE", "Mean reading in cm.", &networks.echo_value);
    let example = [forward.clone(), echo_probability.clone()];
    let all = [turn, forward, lateral, echo_probability, echo_value];
    [("tests/firmware/src/networks.rs", file(&all)), ("core/examples/rtic/src/networks.rs", file(&example))]
}

fn file(networks: &[String]) -> String {
    let head = "//! Networks of the sizes of Table I; made by `cargo run -p mindgap-tests --bin firmware-networks`.";
    format!("{head}\n\n{}", rust_networks(networks))
}

fn source<const N: usize>(name: &str, documentation: &str, network: &Network<f32, N>) -> String {
    let quantised = FixedNetwork::quantise(network).expect("the weights are small");
    rust_network(name, documentation, &quantised.network)
}
