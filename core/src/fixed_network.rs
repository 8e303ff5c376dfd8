//! Networks in fixed point, for processors without a floating-point unit.
//!
//! Inputs and outputs are Q16.16. Everything in between is Q6.26: scaled inputs lie in [1, 2], their logarithms in [0, 1],
//! exponents and weights below 32. The terms of a network may be larger and cancel each other. They are then stored divided
//! by a power of two, chosen so that their sum stays below 32. The host computes that power, and a bound on the rounding
//! error of the output, when it quantises a trained network. Q16.16 throughout would be too coarse: half an ulp in the
//! logarithm of a term of 1000 cm is 0.005 cm, and a value network sums twenty of them.

use core::array;
use core::hint::black_box;

use fixed::types::{I6F26, I16F16, I38F26};
use fixed::{FixedI32, Saturating};

use crate::fixed_point::{Q6_26, Q16_16, exp2_of_sum, log2, product, saturate};
use crate::folded::{Power, PowerSum, Sign};
use crate::network::{Activation, MAX_HALF};

/// A folded network in fixed point, with `N` inputs and room for `POWERS` product units.
///
/// ```
/// use mindgap_core::fixed::types::{I16F16, I38F26, I6F26};
/// use mindgap_core::fixed_network::{FixedNetwork, FixedScaling};
/// use mindgap_core::folded::{Power, PowerSum, Sign};
/// use mindgap_core::heapless::Vec;
/// use mindgap_core::network::Activation;
///
/// // The square of an input in 1..=2, which is not scaled: 2^10 makes 26 fractional bits of 16.
/// let square = FixedNetwork::<1, 1> {
///     inputs: [FixedScaling { gain: 1 << 10, shift: 0, offset: I38F26::ZERO, low: I6F26::ONE, high: 2 * I6F26::ONE }],
///     sum: PowerSum {
///         bias: I6F26::ZERO,
///         slopes: [I6F26::ZERO],
///         powers: Vec::from_array([
///             Power { exponents: [2 * I6F26::ONE], log2_weight: I6F26::ZERO, sign: Sign::Plus },
///         ]),
///     },
///     output_shift: 0,
///     activation: Activation::Linear,
/// };
/// let output = square.evaluate([I16F16::from_num(1.5)]);
/// assert!((output.value - I16F16::from_num(2.25)).abs() <= I16F16::DELTA && !output.clamped);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct FixedNetwork<const N: usize, const POWERS: usize = MAX_HALF> {
    /// Scaling of each input to the trained range.
    pub inputs: [FixedScaling; N],
    /// Sum that reaches the output unit, divided by 2^`output_shift`.
    pub sum: PowerSum<I6F26, N, POWERS>,
    /// Exponent of the power of two by which `sum` is divided, at most [`MAX_OUTPUT_SHIFT`].
    pub output_shift: u8,
    /// Activation function of the output unit.
    pub activation: Activation,
}

/// An affine map of one input, clamped to the trained range: `clamp(x · gain / 2^shift + offset, low, high)`.
///
/// ```
/// use mindgap_core::fixed::types::{I38F26, I6F26};
/// use mindgap_core::fixed_network::FixedScaling;
///
/// // Maps -100..=100 in Q16.16 onto 1..=2 in Q6.26, so the gain is 2^(26 - 16 + shift) / 200.
/// let (low, high) = (I6F26::ONE, 2 * I6F26::ONE);
/// let scaling = FixedScaling { gain: 1_374_389_535, shift: 28, offset: I38F26::from_num(1.5), low, high };
/// assert!(scaling.gain > i32::MAX / 2, "a larger shift would need more than 32 bits");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FixedScaling {
    /// Factor, as large as 32 bits allow.
    pub gain: i32,
    /// Number of fractional bits that the product of a Q16.16 input and `gain` has beyond the 26 of Q6.26, at most 63.
    pub shift: u8,
    /// Summand. It is large where the range is narrow and far from zero.
    pub offset: I38F26,
    /// Smallest scaled value.
    pub low: I6F26,
    /// Largest scaled value.
    pub high: I6F26,
}

/// Scaled inputs and their logarithms, which networks with equal [`inputs`](FixedNetwork::inputs) can share.
///
/// ```
/// use mindgap_core::fixed::types::I16F16;
/// use mindgap_core::fixed_network::FixedNetwork;
///
/// /// Evaluates two networks that have the same scaling.
/// fn both(turn: &FixedNetwork<4, 2>, forward: &FixedNetwork<4, 10>, commands: [I16F16; 4]) -> [I16F16; 2] {
///     let scaled = turn.scale(commands);
///     [turn.evaluate_scaled(&scaled).value, forward.evaluate_scaled(&scaled).value]
/// }
/// ```
#[derive(Clone, Copy, Debug)]
pub struct ScaledInputs<const N: usize> {
    x: [Q6_26; N],
    log2_x: [Q6_26; N],
    clamped: bool,
}

/// The output of a network.
///
/// ```
/// use mindgap_core::fixed::types::I16F16;
/// use mindgap_core::fixed_network::Output;
///
/// /// Uses a prediction only where the network was trained.
/// fn trusted(output: Output) -> Option<I16F16> {
///     (!output.clamped).then_some(output.value)
/// }
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Output {
    /// The output, in the unit that the network was trained in.
    pub value: I16F16,
    /// Whether an input lay outside the trained range, so that the end of the range was used instead.
    pub clamped: bool,
}

/// The largest [`FixedNetwork::output_shift`]. The terms then reach 2^31.
pub const MAX_OUTPUT_SHIFT: u8 = 26;

/// A scaled input below 2^-10 counts as 2^-10, so that sums of logarithms have room; trained ones are at least 1.
const LEAST_SCALED: I6F26 = I6F26::from_bits(1 << 16);

/// Distance outside the trained range, in scaled units, from which an input is reported as clamped. Rounding at the end of
/// the range stays below it.
const CLAMP_TOLERANCE: i64 = 1 << 10;

impl<const N: usize, const POWERS: usize> FixedNetwork<N, POWERS> {
    /// Returns the output for one sample of `N` inputs.
    ///
    /// Any weights and inputs give a result; numbers that do not fit saturate.
    pub fn evaluate(&self, inputs: [I16F16; N]) -> Output {
        self.evaluate_scaled(&self.scale(inputs))
    }

    /// Returns a sample in the form that [`evaluate_scaled`](Self::evaluate_scaled) takes.
    pub fn scale(&self, inputs: [I16F16; N]) -> ScaledInputs<N> {
        let mut clamped = false;
        let x = array::from_fn(|i| {
            let (x, outside) = self.inputs[i].apply(inputs[i]);
            clamped |= outside;
            x
        });
        ScaledInputs { x, log2_x: x.map(|x| Saturating(log2(x.0.max(LEAST_SCALED)))), clamped }
    }

    /// Returns the output for a sample that was scaled by this network or by another with equal `inputs`.
    pub fn evaluate_scaled(&self, scaled: &ScaledInputs<N>) -> Output {
        let sum = add_powers(&self.sum.powers, self.sum.affine(&scaled.x), &scaled.log2_x);
        Output { value: self.activation.apply(self.unscaled(sum)).0, clamped: scaled.clamped }
    }

    /// Returns the sum times 2^`output_shift` in Q16.16, rounded to nearest.
    fn unscaled(&self, sum: Q6_26) -> Q16_16 {
        const FEWER_BITS: u32 = I6F26::FRAC_NBITS - I16F16::FRAC_NBITS;
        let wide = i64::from(sum.0.to_bits()) << self.output_shift.min(MAX_OUTPUT_SHIFT);
        Saturating(I16F16::from_bits(saturate((wide + (1 << (FEWER_BITS - 1))) >> FEWER_BITS)))
    }
}

/// Returns `start` plus all product units, added from the first to the last. One copy serves all networks with `N` inputs.
#[inline(never)]
fn add_powers<const N: usize>(powers: &[Power<I6F26, N>], start: Q6_26, log2_x: &[Q6_26; N]) -> Q6_26 {
    let mut sum = start;
    for Power { exponents, log2_weight, sign } in powers {
        // If the compiler knew that the logarithms stay the same, it would widen them ahead of the loop, and then multiply 64
        // bits by 64.
        let term = product_of_powers(*log2_weight, black_box(log2_x), exponents);
        sum = match sign {
            Sign::Plus => sum + term,
            Sign::Minus => sum - term,
        };
    }
    sum
}

/// Returns 2^(`start` + Σ `logarithms` · `exponents`), where the sum is exact.
#[inline(always)]
fn product_of_powers<const N: usize>(start: I6F26, logarithms: &[Q6_26; N], exponents: &[I6F26; N]) -> Q6_26 {
    // A logarithm is between -10 and 5, so a product has at most 61 bits.
    const { assert!(N <= 4, "more products might not fit 64 bits") };
    let mut sum = i64::from(start.to_bits()) << I6F26::FRAC_NBITS;
    for (logarithm, exponent) in logarithms.iter().zip(exponents) {
        sum = sum.wrapping_add(product(logarithm.0.to_bits(), exponent.to_bits()));
    }
    Saturating(exp2_of_sum(sum))
}

impl FixedScaling {
    /// Returns the scaled input, and whether it had to be clamped.
    #[inline(always)]
    fn apply(&self, input: I16F16) -> (Q6_26, bool) {
        let scaled = (product(input.to_bits(), self.gain) >> self.shift.min(63)).saturating_add(self.offset.to_bits());
        let (low, high) = (i64::from(self.low.to_bits()), i64::from(self.high.to_bits()));
        let outside = scaled < low - CLAMP_TOLERANCE || scaled > high + CLAMP_TOLERANCE;
        (Saturating(FixedI32::from_bits(saturate(scaled.min(high).max(low)))), outside)
    }
}
