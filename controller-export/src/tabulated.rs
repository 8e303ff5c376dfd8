//! A fixed-point network as a table of integers, which evaluators in several languages read in the same order.

use mindgap_core::fixed_network::{FixedNetwork, FixedScaling};
use mindgap_core::folded::Sign;
use mindgap_core::network::Activation;

/// Number of weights per line of a table.
const WEIGHTS_PER_LINE: usize = 8;

/// A network as a function with a table of its weights.
///
/// ```
/// use mindgap_controller_export::c_networks::c_networks;
/// use mindgap_controller_export::tabulated::Tabulated;
/// use mindgap_core::fixed_network::FixedNetwork;
///
/// fn header(forward: &FixedNetwork<2>) -> String {
///     c_networks(&[Tabulated::new("forward", "Centimetres.", ["left", "right"], forward)], "")
/// }
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Tabulated {
    pub(crate) name: &'static str,
    pub(crate) documentation: &'static str,
    pub(crate) inputs: Vec<&'static str>,
    pub(crate) weights: Vec<i32>,
}

impl Tabulated {
    /// Returns the function `name` with arguments named `inputs`. `documentation` is one line of text.
    pub fn new<const N: usize>(
        name: &'static str,
        documentation: &'static str,
        inputs: [&'static str; N],
        network: &FixedNetwork<N>,
    ) -> Self {
        Tabulated { name, documentation, inputs: inputs.to_vec(), weights: weights(network) }
    }

    /// Returns the number of product units.
    pub(crate) fn powers(&self) -> usize {
        self.weights[1] as usize
    }
}

/// Returns, in this order: number of inputs, number of product units, output shift, whether the output is a ramp; the
/// scaling of each input; bias and slopes; sign, weight and exponents of each product unit.
fn weights<const N: usize>(network: &FixedNetwork<N>) -> Vec<i32> {
    let FixedNetwork { inputs, sum, output_shift, activation } = network;
    let is_ramp = i32::from(*activation == Activation::Ramp);
    let mut weights = vec![N as i32, sum.powers.len() as i32, i32::from(*output_shift), is_ramp];
    weights.extend(inputs.iter().flat_map(scaling));
    weights.push(sum.bias.to_bits());
    weights.extend(sum.slopes.iter().map(|slope| slope.to_bits()));
    for power in &sum.powers {
        weights.extend([i32::from(power.sign == Sign::Minus), power.log2_weight.to_bits()]);
        weights.extend(power.exponents.iter().map(|exponent| exponent.to_bits()));
    }
    weights
}

/// Returns gain, shift, the four 16-bit limbs of the offset from the highest, and the range.
fn scaling(scaling: &FixedScaling) -> [i32; 8] {
    let FixedScaling { gain, shift, offset, low, high } = scaling;
    let offset = offset.to_bits();
    let limb = |i: u32| ((offset >> (16 * i)) & 0xffff) as i32;
    let highest = (offset >> 48) as i32;
    [*gain, i32::from(*shift), highest, limb(2), limb(1), limb(0), low.to_bits(), high.to_bits()]
}

/// Writes numbers in lines, each followed by a comma.
pub(crate) fn lines(numbers: &[i32]) -> String {
    let line = |numbers: &[i32]| {
        let words: Vec<String> = numbers.iter().map(i32::to_string).collect();
        format!("  {},\n", words.join(", "))
    };
    numbers.chunks(WEIGHTS_PER_LINE).map(line).collect()
}
