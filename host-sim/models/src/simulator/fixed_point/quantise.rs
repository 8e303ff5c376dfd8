//! From a trained network to fixed point, with a bound on what rounding can do.

use std::f64::consts::LOG2_E;
use std::fmt;

use fixed::types::{I6F26, I38F26};
use mindgap_core::fixed_network::{FixedNetwork, FixedScaling, MAX_OUTPUT_SHIFT};
use mindgap_core::folded::{FoldedNetwork, Power, PowerSum, Sign};
use mindgap_core::network::{InvalidNetwork, Network, ProductUnit, Scaling};

/// A network in fixed point and what is known of its rounding.
#[derive(Clone, Debug, PartialEq)]
pub struct Quantised<const N: usize> {
    /// The network.
    pub network: FixedNetwork<N>,
    /// The most that its output can differ from the trained network's in exact arithmetic, at any Q16.16 input and in
    /// the output's unit. Errors are taken to add up in the worst way; in practice a fraction of it is seen. Outputs
    /// beyond ±32768 are excepted: they saturate.
    pub error_bound: f64,
}

/// Why a network has no fixed-point form.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Unrepresentable {
    /// The network itself is broken.
    Invalid(InvalidNetwork),
    /// A number has no place in its format.
    Weight(Weight, f64),
    /// The largest magnitudes of all terms add up to this, beyond 2^31.
    Terms(f64),
}

/// A number of a network; units and inputs are counted from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Weight {
    /// The gain of an input's scaling.
    Gain(usize),
    /// The offset of an input's scaling.
    Offset(usize),
    /// The least scaled value of an input.
    Low(usize),
    /// The largest scaled value of an input.
    High(usize),
    /// The folded bias.
    Bias,
    /// The folded slope of an input.
    Slope(usize),
    /// The exponent of an input in a product unit.
    Exponent {
        /// The product unit.
        unit: usize,
        /// The input.
        input: usize,
    },
    /// The logarithm to base two of a product unit's output weight.
    OutputWeight(usize),
}

/// One unit in the last place of Q6.26 and of Q16.16.
const ULP: f64 = 1.0 / (1u32 << 26) as f64;
const OUTPUT_ULP: f64 = 1.0 / (1u32 << 16) as f64;
/// How far a scaled input can be off: its product is cut off, its offset and the ends of its range are rounded.
const X_ERROR: f64 = 1.5 * ULP;

impl<const N: usize> Quantised<N> {
    /// Folds a trained network and rounds it to fixed point.
    ///
    /// # Errors
    /// [`Unrepresentable`] names the first weight without a place.
    pub fn new(network: &Network<f32, N>) -> Result<Self, Unrepresentable> {
        network.check().map_err(Unrepresentable::Invalid)?;
        let FoldedNetwork { inputs: scalings, sum: exact, activation, .. } = FoldedNetwork::<f64, N>::fold(network);
        let mut inputs = [CONSTANT; N];
        for (i, (to, from)) in inputs.iter_mut().zip(&scalings).enumerate() {
            *to = quantise_scaling(i, from)?;
        }
        let exponents = exact.powers.iter().enumerate().map(|(unit, power)| quantise_exponents(unit, &power.exponents));
        let exponents = exponents.collect::<Result<Vec<_>, _>>()?;

        let range = scalings.map(|s| (s.low, s.high));
        let output_shift = output_shift(largest_sum(&exact, &range))?;
        let scale = power_of_two(output_shift);
        let mut error_bound = scale * ULP / 2.0 + OUTPUT_ULP / 2.0;
        let mut sum = PowerSum {
            bias: fit(Weight::Bias, exact.bias / scale)?,
            slopes: [I6F26::ZERO; N],
            powers: heapless::Vec::new(),
        };
        for (i, (to, slope)) in sum.slopes.iter_mut().zip(exact.slopes).enumerate() {
            *to = fit(Weight::Slope(i), slope / scale)?;
            error_bound += libm::fabs(slope) * X_ERROR + scale * ULP * (range[i].1 / 2.0 + 1.0);
        }
        for (unit, (power, exponents)) in exact.powers.iter().zip(exponents).enumerate() {
            let largest = largest_power(power, &range);
            if largest < scale * ULP / 2.0 {
                // It would always be rounded to zero.
                error_bound += largest;
                continue;
            }
            error_bound += largest * (libm::exp2(exponent_error(power, &range)) - 1.0) + scale * ULP;
            let log2_weight = fit(Weight::OutputWeight(unit), log2_weight(power) - f64::from(output_shift))?;
            let sign = if power.output < 0.0 { Sign::Minus } else { Sign::Plus };
            sum.powers.extend([Power { exponents, log2_weight, sign }]);
        }
        Ok(Quantised { network: FixedNetwork { inputs, sum, output_shift, activation }, error_bound })
    }
}

/// The scaling to a constant zero.
const CONSTANT: FixedScaling =
    FixedScaling { gain: 0, shift: 0, offset: I38F26::ZERO, low: I6F26::ZERO, high: I6F26::ZERO };

fn quantise_scaling(input: usize, scaling: &Scaling<f64>) -> Result<FixedScaling, Unrepresentable> {
    // gain = mantissa · 2^exponent with a mantissa in [½, 1) of 24 bits, so 31 bits hold it whole. The product of
    // 16 + 31 fractional bits, less the exponent, goes down to 26.
    let (mantissa, exponent) = libm::frexp(scaling.gain);
    let (gain, shift) = match u8::try_from(16 + 31 - 26 - exponent) {
        Ok(shift @ 0..=63) => ((mantissa * power_of_two(31)) as i32, shift),
        // Too small to reach the last place with any input.
        _ if exponent < 0 => (0, 0),
        _ => return Err(Unrepresentable::Weight(Weight::Gain(input), scaling.gain)),
    };
    Ok(FixedScaling {
        gain,
        shift,
        offset: I38F26::checked_from_num(scaling.offset)
            .ok_or(Unrepresentable::Weight(Weight::Offset(input), scaling.offset))?,
        low: fit(Weight::Low(input), scaling.low)?,
        high: fit(Weight::High(input), scaling.high)?,
    })
}

fn quantise_exponents<const N: usize>(unit: usize, exponents: &[f64; N]) -> Result<[I6F26; N], Unrepresentable> {
    let mut quantised = [I6F26::ZERO; N];
    for (input, (to, exponent)) in quantised.iter_mut().zip(exponents).enumerate() {
        *to = fit(Weight::Exponent { unit, input }, *exponent)?;
    }
    Ok(quantised)
}

/// Of a weight of zero, minus infinity.
fn log2_weight<const N: usize>(power: &ProductUnit<f64, N>) -> f64 {
    libm::log2(libm::fabs(power.output))
}

/// The least division of the output by a power of two after which all terms together stay below 32.
fn output_shift(largest_sum: f64) -> Result<u8, Unrepresentable> {
    // A little less than 32, so that rounding cannot reach it.
    const LIMIT: f64 = 31.999;
    (0..=MAX_OUTPUT_SHIFT)
        .find(|shift| largest_sum < LIMIT * power_of_two(*shift))
        .ok_or(Unrepresentable::Terms(largest_sum))
}

/// The magnitudes of all terms together, each at its largest.
fn largest_sum<const N: usize, const POWERS: usize>(
    sum: &PowerSum<f64, N, POWERS, ProductUnit<f64, N>>,
    range: &[(f64, f64); N],
) -> f64 {
    let affine = sum.slopes.iter().zip(range).map(|(slope, (_, high))| libm::fabs(*slope) * high.max(1.0));
    let powers = sum.powers.iter().map(|power| largest_power(power, range));
    affine.chain(powers).fold(libm::fabs(sum.bias), |a, b| a + b)
}

/// The largest magnitude of one term.
fn largest_power<const N: usize>(power: &ProductUnit<f64, N>, range: &[(f64, f64); N]) -> f64 {
    let mut log2 = log2_weight(power);
    for (exponent, (low, high)) in power.exponents.iter().zip(range) {
        log2 += (exponent * libm::log2(*low)).max(exponent * libm::log2(*high));
    }
    libm::exp2(log2)
}

/// How far the exponent of two of one term can be off.
fn exponent_error<const N: usize>(power: &ProductUnit<f64, N>, range: &[(f64, f64); N]) -> f64 {
    let each = power.exponents.iter().zip(range).map(|(exponent, (low, high))| {
        let log2_error = ULP + X_ERROR * LOG2_E / low;
        let log2_largest = libm::fabs(libm::log2(*low)).max(libm::fabs(libm::log2(*high)));
        libm::fabs(*exponent) * log2_error + ULP * (log2_largest / 2.0 + 1.0)
    });
    each.fold(ULP / 2.0, |a, b| a + b)
}

fn fit(weight: Weight, value: f64) -> Result<I6F26, Unrepresentable> {
    I6F26::checked_from_num(value).ok_or(Unrepresentable::Weight(weight, value))
}

fn power_of_two(exponent: u8) -> f64 {
    libm::exp2(f64::from(exponent))
}

impl fmt::Display for Unrepresentable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Unrepresentable::Invalid(reason) => write!(f, "{reason}"),
            Unrepresentable::Weight(weight, value) => write!(f, "{weight} = {value} does not fit Q6.26 (-32..32)"),
            Unrepresentable::Terms(sum) => write!(f, "the largest terms add up to {sum:e}, beyond 2^31"),
        }
    }
}

/// Counted from 1.
impl fmt::Display for Weight {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Weight::Gain(i) => write!(f, "input {}: gain", i + 1),
            Weight::Offset(i) => write!(f, "input {}: offset", i + 1),
            Weight::Low(i) => write!(f, "input {}: least scaled value", i + 1),
            Weight::High(i) => write!(f, "input {}: largest scaled value", i + 1),
            Weight::Bias => write!(f, "bias"),
            Weight::Slope(i) => write!(f, "slope of input {}", i + 1),
            Weight::Exponent { unit, input } => write!(f, "product unit {}: exponent of input {}", unit + 1, input + 1),
            Weight::OutputWeight(unit) => write!(f, "product unit {}: logarithm of the output weight", unit + 1),
        }
    }
}

impl std::error::Error for Unrepresentable {}

#[cfg(test)]
mod tests;
