//! A simulator's networks in fixed point, for a board or a brick: quantised, and as Rust or NXC source.

mod quantise;

use mindgap_controller_export::nxc_networks::NxcNetwork;
use mindgap_controller_export::rust_networks::rust_network;

pub use quantise::{Quantised, Unrepresentable, Weight};

use super::{Learned, Simulator};
use crate::error::{Error, Result};

/// The five networks, quantised.
#[derive(Clone, Debug, PartialEq)]
pub struct FixedNetworks {
    /// Turn to the left in a step, degrees.
    pub turn: Quantised<4>,
    /// Way forward in a step, cm.
    pub forward: Quantised<4>,
    /// Way to the left in a step, cm.
    pub lateral: Quantised<4>,
    /// Probability that the sensor produces a value.
    pub echo_probability: Quantised<2>,
    /// The value it then produces, cm.
    pub echo_value: Quantised<2>,
}

impl FixedNetworks {
    /// Quantises the networks of a simulator.
    ///
    /// # Errors
    /// Names a network that is missing, and a weight that has no place in fixed point.
    pub fn quantise(simulator: &Simulator) -> Result<Self> {
        Ok(FixedNetworks {
            turn: quantise(simulator, &simulator.turn, "turn")?,
            forward: quantise(simulator, &simulator.forward, "forward")?,
            lateral: quantise(simulator, &simulator.lateral, "lateral")?,
            echo_probability: quantise(simulator, &simulator.echo_probability, "echo_probability")?,
            echo_value: quantise(simulator, &simulator.echo_value, "echo_value")?,
        })
    }

    /// The definitions of `TURN`, `FORWARD`, `LATERAL`, `ECHO_PROBABILITY` and `ECHO_VALUE` in Rust, for
    /// [`rust_networks`](mindgap_controller_export::rust_networks::rust_networks).
    pub fn rust_definitions(&self) -> [String; 5] {
        [
            rust_network("TURN", "Turn to the left in a step, degrees.", &self.turn.network),
            rust_network("FORWARD", "Way forward in a step, cm.", &self.forward.network),
            rust_network("LATERAL", "Way to the left in a step, cm.", &self.lateral.network),
            rust_network("ECHO_PROBABILITY", "Probability of an echo.", &self.echo_probability.network),
            rust_network("ECHO_VALUE", "Mean reading, cm.", &self.echo_value.network),
        ]
    }

    /// The functions `Turn`, `Forward`, `Lateral`, `EchoProbability` and `EchoValue` in NXC, for
    /// [`nxc_networks`](mindgap_controller_export::nxc_networks::nxc_networks).
    pub fn nxc_definitions(&self) -> [NxcNetwork; 5] {
        let commands = ["left", "right", "previous_left", "previous_right"];
        let facing = ["distance_cm", "incidence_deg"];
        [
            NxcNetwork::new("Turn", "Turn to the left in a step, degrees.", commands, &self.turn.network),
            NxcNetwork::new("Forward", "Way forward in a step, cm.", commands, &self.forward.network),
            NxcNetwork::new("Lateral", "Way to the left in a step, cm.", commands, &self.lateral.network),
            NxcNetwork::new("EchoProbability", "Probability of an echo.", facing, &self.echo_probability.network),
            NxcNetwork::new("EchoValue", "Mean reading, cm.", facing, &self.echo_value.network),
        ]
    }
}

fn quantise<const N: usize>(simulator: &Simulator, learned: &Option<Learned<N>>, name: &str) -> Result<Quantised<N>> {
    Quantised::new(&simulator.need(learned, name)?.network)
        .map_err(|e| Error::new(format!("the {name} network cannot be represented in fixed point: {e}")))
}
