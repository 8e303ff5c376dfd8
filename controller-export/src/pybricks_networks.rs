//! Networks as a MicroPython module for hubs with Pybricks firmware.
//!
//! They are in floating point: integers on the hubs have 31 bits, too few for the products of fixed point.

use mindgap_core::folded::FoldedNetwork;
use mindgap_core::network::{Activation, Network};

const NETWORK: &str = include_str!("pybricks_networks/network.py");

/// A network as a function with a table of its weights.
///
/// ```
/// use mindgap_controller_export::pybricks_networks::{PybricksNetwork, pybricks_networks};
/// use mindgap_core::network::{Network, Scaling};
///
/// let network = Network::constant([Scaling::onto_one_to_two(0.0, 10.0)], 0.5);
/// let module = pybricks_networks(&[PybricksNetwork::new("turn", "Degrees.", ["left"], &network)]);
/// assert!(module.contains("def turn(left):"));
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PybricksNetwork(String);

impl PybricksNetwork {
    /// Returns the function `name` with arguments named `inputs`. `documentation` is one line of text.
    pub fn new<const N: usize>(
        name: &str,
        documentation: &str,
        inputs: [&str; N],
        network: &Network<f32, N>,
    ) -> PybricksNetwork {
        let FoldedNetwork { inputs: scalings, sum, activation, .. } = FoldedNetwork::<f32, N>::fold(network);
        let scalings = rows(scalings.iter().map(|s| tuple(&[s.gain, s.offset, s.low, s.high])));
        let units = rows(sum.powers.iter().map(|unit| format!("({}, {:?})", tuple(&unit.exponents), unit.output)));
        let is_ramp = if activation == Activation::Ramp { "True" } else { "False" };
        let (table, slopes, bias) = (name.to_uppercase(), tuple(&sum.slopes), sum.bias);
        let inputs = inputs.join(", ");
        PybricksNetwork(format!(
            "{table} = (\n    ({scalings}),\n    {bias:?},\n    {slopes},\n    ({units}),\n    {is_ramp},\n)\n\n\n\
             def {name}({inputs}):\n    \"\"\"{documentation}\"\"\"\n    return network({table}, ({inputs}))\n"
        ))
    }
}

/// Returns the source of a module that defines these networks.
pub fn pybricks_networks(networks: &[PybricksNetwork]) -> String {
    let head = "# A simulator's networks in floating point, for a hub with Pybricks firmware: import the functions from this file.
# Each table holds gain, offset and range of every input; bias; slopes; exponents and weight of every product unit; and
# whether the output is a probability.

from umath import exp, log
";
    let tables = networks.iter().map(|PybricksNetwork(definition)| definition.as_str());
    [head, NETWORK].into_iter().chain(tables).collect::<Vec<_>>().join("\n\n")
}

fn tuple(numbers: &[f32]) -> String {
    let words: Vec<String> = numbers.iter().map(|number| format!("{number:?}")).collect();
    format!("({})", words.join(", "))
}

/// Writes one item per line, each followed by a comma.
fn rows(items: impl Iterator<Item = String>) -> String {
    let rows: String = items.map(|item| format!("\n        {item},")).collect();
    rows + "\n    "
}
