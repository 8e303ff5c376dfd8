//! Networks in fixed point, for processors without a floating-point unit.
//!
//! Inputs and outputs are Q16.16. Between them everything is Q6.26: scaled inputs lie in [1, 2], their logarithms in
//! [0, 1], exponents and weights below 32. The terms of a network may be larger, and cancel: they are then stored divided
//! by a power of two, chosen so that all of them together stay below 32. The host works out that power, and how far
//! rounding can take the output, when it quantises a trained network. Q16.16 throughout would not do: half an ulp in the
//! logarithm of a term of 1000 cm is 0.005 cm, and a value network sums twenty of them.

use core::array;

use fixed::types::{I6F26, I16F16, I38F26};
use fixed::{FixedI32, Saturating};

use crate::fixed_point::{Q6_26, Q16_16, exp2_of_sum, log2, product, saturate};
use crate::folded::{Power, PowerSum, Sign, Term};
use crate::network::{Activation, MAX_HALF};

/// A folded network in fixed point: `N` inputs, room for `POWERS` product units.
#[derive(Clone, Debug, PartialEq)]
pub struct FixedNetwork<const N: usize, const POWERS: usize = MAX_HALF> {
    /// How each input is brought to the range that was trained.
    pub inputs: [FixedScaling; N],
    /// What reaches the output unit, divided by two to the power of `output_shift`.
    pub sum: PowerSum<I6F26, N, POWERS>,
    /// See `sum`; at most [`MAX_OUTPUT_SHIFT`].
    pub output_shift: u8,
    /// What the output unit does with the sum.
    pub activation: Activation,
}

/// An affine map of one input, clamped to the range that was trained: `clamp(x · gain / 2^shift + offset, low, high)`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FixedScaling {
    /// Factor, as large as 32 bits allow.
    pub gain: i32,
    /// Fractional bits that the product of a Q16.16 input and `gain` has beyond the 26 of Q6.26; at most 63.
    pub shift: u8,
    /// Summand; large where the range is narrow and far from zero.
    pub offset: I38F26,
    /// Least scaled value.
    pub low: I6F26,
    /// Largest scaled value.
    pub high: I6F26,
}

/// Scaled inputs and their logarithms, which networks of equal [`inputs`](FixedNetwork::inputs) can share.
#[derive(Clone, Copy, Debug)]
pub struct ScaledInputs<const N: usize> {
    x: [Q6_26; N],
    log2_x: [Q6_26; N],
    clamped: bool,
}

/// What a network answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Output {
    /// The output, in the unit that the network was trained in.
    pub value: I16F16,
    /// Whether an input lay outside the trained range, so that the range's end was taken for it.
    pub clamped: bool,
}

/// The largest [`FixedNetwork::output_shift`]; the terms then reach 2^31.
pub const MAX_OUTPUT_SHIFT: u8 = 26;

/// A scaled input below 2^-10 counts as 2^-10, so that sums of logarithms have room; trained ones are at least 1.
const LEAST_SCALED: I6F26 = I6F26::from_bits(1 << 16);

/// How far, in scaled units, an input may be outside the trained range before it is said to be clamped, so that
/// rounding at the very end of the range is not.
const CLAMP_TOLERANCE: i64 = 1 << 10;

impl<const N: usize, const POWERS: usize> FixedNetwork<N, POWERS> {
    /// The output for one sample. Any weights and inputs give an answer; what does not fit saturates.
    pub fn evaluate(&self, inputs: [I16F16; N]) -> Output {
        self.evaluate_scaled(&self.scale(inputs))
    }

    /// A sample as [`evaluate_scaled`](Self::evaluate_scaled) takes it.
    pub fn scale(&self, inputs: [I16F16; N]) -> ScaledInputs<N> {
        let mut clamped = false;
        let x = array::from_fn(|i| {
            let (x, outside) = self.inputs[i].apply(inputs[i]);
            clamped |= outside;
            x
        });
        ScaledInputs { x, log2_x: x.map(|x| Saturating(log2(x.0.max(LEAST_SCALED)))), clamped }
    }

    /// The output for a sample that was scaled by this network, or by another with equal `inputs`.
    pub fn evaluate_scaled(&self, scaled: &ScaledInputs<N>) -> Output {
        let sum = self.sum.evaluate(&scaled.x, &scaled.log2_x);
        Output { value: self.activation.apply(self.unscaled(sum)).0, clamped: scaled.clamped }
    }

    /// The sum in Q16.16, rounded to nearest, without its division by two to the power of `output_shift`.
    fn unscaled(&self, sum: Q6_26) -> Q16_16 {
        const FEWER_BITS: u32 = I6F26::FRAC_NBITS - I16F16::FRAC_NBITS;
        let wide = i64::from(sum.0.to_bits()) << self.output_shift.min(MAX_OUTPUT_SHIFT);
        Saturating(I16F16::from_bits(saturate((wide + (1 << (FEWER_BITS - 1))) >> FEWER_BITS)))
    }
}

impl<const N: usize> Term<Q6_26, N> for Power<I6F26, N> {
    #[inline(always)]
    fn add_to(&self, sum: Q6_26, log2_x: &[Q6_26; N]) -> Q6_26 {
        let term = product_of_powers(self.log2_weight, log2_x, &self.exponents);
        match self.sign {
            Sign::Plus => sum + term,
            Sign::Minus => sum - term,
        }
    }
}

/// Two to the power of `start` + Σ `logarithms` · `exponents`; the sum is exact. Not to be inlined: in a loop over
/// product units the compiler would widen the logarithms once, ahead of the loop, and then multiply 64 bits by 64.
#[inline(never)]
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
    /// The scaled input, and whether it had to be clamped.
    #[inline(always)]
    fn apply(&self, input: I16F16) -> (Q6_26, bool) {
        let scaled = (product(input.to_bits(), self.gain) >> self.shift.min(63)).saturating_add(self.offset.to_bits());
        let (low, high) = (i64::from(self.low.to_bits()), i64::from(self.high.to_bits()));
        let outside = scaled < low - CLAMP_TOLERANCE || scaled > high + CLAMP_TOLERANCE;
        (Saturating(FixedI32::from_bits(saturate(scaled.min(high).max(low)))), outside)
    }
}
