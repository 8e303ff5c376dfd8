//! The networks that the images under `tests/firmware` run.

use mindgap_controller_export::rust_networks::{rust_network, rust_networks};
use mindgap_core::fixed_network::FixedNetwork;
use mindgap_core::network::Network;

use crate::plausible_networks::plausible_networks;

/// Their source text.
pub fn rust_source() -> String {
    let networks = plausible_networks(1);
    let text = rust_networks(&[
        source("TURN", "Turn of a step in degrees.", &networks.turn),
        source("FORWARD", "Forward movement in a step in cm.", &networks.forward),
        source("LATERAL", "Movement to the left in a step in cm.", &networks.lateral),
        source("ECHO_PROBABILITY", "Probability of an echo.", &networks.echo_probability),
        source("ECHO_VALUE", "Mean reading in cm.", &networks.echo_value),
    ]);
    format!(
        "//! Networks of the sizes of Table I; made by `cargo run -p mindgap-tests --bin firmware-networks`.\n\n{text}"
    )
}

fn source<const N: usize>(name: &str, documentation: &str, network: &Network<f32, N>) -> String {
    let quantised = FixedNetwork::quantise(network).expect("the weights are small");
    rust_network(name, documentation, &quantised.network)
}
