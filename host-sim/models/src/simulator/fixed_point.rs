//! A simulator's networks in fixed point, for a board or a brick: quantised, and as source code.

mod quantise;

use mindgap_controller_export::rust_networks::rust_network;
use mindgap_controller_export::tabulated::Tabulated;

pub use quantise::{Quantised, Unrepresentable, Weight};

use super::{Learned, Simulator};
use mindgap_foundations::error::{Error, Result};

/// What the networks answer, in the order turn, forward, lateral, echo_probability, echo_value.
pub const DOCUMENTATION: [&str; 5] = [
    "Turn per step, degrees, positive to the left.",
    "Forward motion per step, cm.",
    "Lateral motion per step, cm, positive to the left.",
    "Probability of an echo.",
    "Mean reading, cm.",
];
/// The inputs of the networks of motion.
pub const COMMANDS: [&str; 4] = ["left", "right", "previous_left", "previous_right"];
/// The inputs of the networks of the sonar.
pub const FACING: [&str; 2] = ["distance_cm", "incidence_deg"];

/// The five networks, quantised.
#[derive(Clone, Debug, PartialEq)]
pub struct FixedNetworks {
    /// Turn per step, degrees, positive to the left.
    pub turn: Quantised<4>,
    /// Forward motion per step, cm.
    pub forward: Quantised<4>,
    /// Lateral motion per step, cm, positive to the left.
    pub lateral: Quantised<4>,
    /// Probability that the sensor produces a value.
    pub echo_probability: Quantised<2>,
    /// The reading if the sensor produces one, cm.
    pub echo_value: Quantised<2>,
}

impl FixedNetworks {
    /// Quantises the networks of a simulator.
    ///
    /// # Errors
    /// Names a network that is missing, a weight that has no place in fixed point, and a filter before the networks.
    pub fn quantise(simulator: &Simulator) -> Result<Self> {
        simulator.need_no_filter()?;
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
        let [turn, forward, lateral, echo_probability, echo_value] = DOCUMENTATION;
        [
            rust_network("TURN", turn, &self.turn.network),
            rust_network("FORWARD", forward, &self.forward.network),
            rust_network("LATERAL", lateral, &self.lateral.network),
            rust_network("ECHO_PROBABILITY", echo_probability, &self.echo_probability.network),
            rust_network("ECHO_VALUE", echo_value, &self.echo_value.network),
        ]
    }

    /// The networks as functions of these names, for
    /// [`nxc_networks`](mindgap_controller_export::nxc_networks::nxc_networks) and
    /// [`c_networks`](mindgap_controller_export::c_networks::c_networks).
    pub fn tabulated(&self, names: [&'static str; 5]) -> [Tabulated; 5] {
        let [turn, forward, lateral, echo_probability, echo_value] = DOCUMENTATION;
        [
            Tabulated::new(names[0], turn, COMMANDS, &self.turn.network),
            Tabulated::new(names[1], forward, COMMANDS, &self.forward.network),
            Tabulated::new(names[2], lateral, COMMANDS, &self.lateral.network),
            Tabulated::new(names[3], echo_probability, FACING, &self.echo_probability.network),
            Tabulated::new(names[4], echo_value, FACING, &self.echo_value.network),
        ]
    }
}

fn quantise<const N: usize>(simulator: &Simulator, learned: &Option<Learned<N>>, name: &str) -> Result<Quantised<N>> {
    Quantised::new(&simulator.need(learned, name)?.network)
        .map_err(|e| Error::new(format!("the {name} network cannot be represented in fixed point: {e}")))
}
