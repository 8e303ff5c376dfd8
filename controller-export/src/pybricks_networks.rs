//! Networks as a MicroPython module for hubs with pybricks firmware.
//!
//! They are in floating point: the hubs' whole numbers have 31 bits, too few for the products of fixed point.

use mindgap_core::folded::FoldedNetwork;
use mindgap_core::network::{Activation, Network};

const NETWORK: &str = include_str!("pybricks_networks/network.py");

/// One network as a function with a table of its weights.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PybricksNetwork(String);

impl PybricksNetwork {
    /// The function `name` with arguments named `inputs`; `documentation` is one line.
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

/// A module that defines these networks.
pub fn pybricks_networks(networks: &[PybricksNetwork]) -> String {
    let head = "# A simulator's networks in floating point, for a hub with pybricks firmware: from this file import what is needed.
# Of each network: gain, offset and range of every input; bias; slopes; product units with exponents and weight; whether the
# answer is a probability.

from umath import exp, log
";
    let tables = networks.iter().map(|PybricksNetwork(definition)| definition.as_str());
    [head, NETWORK].into_iter().chain(tables).collect::<Vec<_>>().join("\n\n")
}

fn tuple(numbers: &[f32]) -> String {
    let words: Vec<String> = numbers.iter().map(|number| format!("{number:?}")).collect();
    format!("({})", words.join(", "))
}

/// Items on lines of their own, with a comma behind each.
fn rows(items: impl Iterator<Item = String>) -> String {
    let rows: String = items.map(|item| format!("\n        {item},")).collect();
    rows + "\n    "
}
