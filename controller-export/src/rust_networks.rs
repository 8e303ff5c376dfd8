//! Fixed-point networks as Rust source: statics that stay in flash, for a program that depends on `mindgap-core`.

use std::fmt::Write;

use mindgap_core::fixed_network::FixedNetwork;
use mindgap_core::folded::Sign;
use mindgap_core::network::Activation;

/// Returns a Rust source file with these networks, each of which was made by [`rust_network`].
///
/// ```
/// use mindgap_controller_export::rust_networks::rust_networks;
///
/// assert!(rust_networks(&[]).starts_with("use mindgap_core::"));
/// ```
pub fn rust_networks(networks: &[String]) -> String {
    let head = "use mindgap_core::fixed::types::{I6F26, I38F26};
use mindgap_core::fixed_network::{FixedNetwork, FixedScaling};
use mindgap_core::folded::{Power, PowerSum, Sign};
use mindgap_core::heapless::Vec;
use mindgap_core::network::Activation;
";
    networks.iter().fold(head.to_owned(), |text, network| text + "\n" + network)
}

/// Returns the definition of one network as a static, with room for exactly its product units.
///
/// `name` has to be a Rust identifier, and `documentation` one line of text.
pub fn rust_network<const N: usize>(name: &str, documentation: &str, network: &FixedNetwork<N>) -> String {
    let activation = match network.activation {
        Activation::Linear => "Linear",
        Activation::Ramp => "Ramp",
    };
    let inputs = lines(network.inputs.iter().map(|s| {
        let (gain, shift) = (s.gain, s.shift);
        let offset = format!("I38F26::from_bits({})", s.offset.to_bits());
        let (low, high) = (bits(s.low.to_bits()), bits(s.high.to_bits()));
        format!("FixedScaling {{ gain: {gain}, shift: {shift}, offset: {offset}, low: {low}, high: {high} }}")
    }));
    let powers = lines(network.sum.powers.iter().map(|power| {
        let exponents = list(power.exponents.iter().map(|e| e.to_bits()));
        let log2_weight = bits(power.log2_weight.to_bits());
        let sign = match power.sign {
            Sign::Plus => "Plus",
            Sign::Minus => "Minus",
        };
        format!("Power {{ exponents: {exponents}, log2_weight: {log2_weight}, sign: Sign::{sign} }}")
    }));
    let bias = bits(network.sum.bias.to_bits());
    let slopes = list(network.sum.slopes.iter().map(|slope| slope.to_bits()));
    let capacity = network.sum.powers.len();
    let output_shift = network.output_shift;
    format!(
        "/// {documentation}
pub static {name}: FixedNetwork<{N}, {capacity}> = FixedNetwork {{
    inputs: [
{inputs}    ],
    sum: PowerSum {{
        bias: {bias},
        slopes: {slopes},
        powers: Vec::from_array([
{powers}        ]),
    }},
    output_shift: {output_shift},
    activation: Activation::{activation},
}};
"
    )
}

fn bits(bits: i32) -> String {
    format!("I6F26::from_bits({bits})")
}

fn list(values: impl Iterator<Item = i32>) -> String {
    format!("[{}]", values.map(bits).collect::<Vec<_>>().join(", "))
}

/// Writes one item per line.
fn lines(items: impl Iterator<Item = String>) -> String {
    items.fold(String::new(), |mut text, item| {
        let _ = writeln!(text, "            {item},");
        text
    })
}
