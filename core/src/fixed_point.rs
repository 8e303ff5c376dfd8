//! Fixed point: numbers that need no floating-point unit, the same bits on every machine.
//!
//! Two formats are in use, both 32 bits wide: [`Q16_16`] for what comes in and goes out (speeds, centimetres, degrees,
//! probabilities) and [`Q6_26`] for what lies between (scaled inputs, logarithms, exponents). Sums, differences and
//! products saturate; a product drops the bits that do not fit, so it rounds towards minus infinity.
//!
//! | function | of zero and below | where it does not fit |
//! | --- | --- | --- |
//! | [`exp2`] | - | the largest number |
//! | [`log2`] | as of the least positive number | - |
//! | [`cos_pi`] | - | - |
//!
//! Each is within 1 unit of the last place (2^-16 or 2^-26) at every input of both formats: `cargo run --release -p
//! mindgap-tests --example exhaustive-fixed-point` goes through them all.

mod cosine;
mod powers;
mod product;

use fixed::types::extra::{IsLessOrEqual, LeEqU32, True, U16, U26, U30};
use fixed::{FixedI32, Saturating};

pub use cosine::cos_pi;
pub(crate) use powers::exp2_of_sum;
pub use powers::{STEPS, exp2, log2};
pub(crate) use product::product;

use crate::scalar::Scalar;

/// A number with 16 fractional bits, -32768..32768.
pub type Q16_16 = Saturating<FixedI32<U16>>;
/// A number with 26 fractional bits, -32..32.
pub type Q6_26 = Saturating<FixedI32<U26>>;

/// A number of fractional bits that the functions of this module are made and checked for.
pub trait Format: LeEqU32 + IsLessOrEqual<U30, Output = True> {}

impl Format for U16 {}
impl Format for U26 {}

impl<F: Format> Scalar for Saturating<FixedI32<F>> {
    type Weight = FixedI32<F>;
    const ZERO: FixedI32<F> = FixedI32::ZERO;
    const ONE: FixedI32<F> = FixedI32::ONE;

    #[inline(always)]
    fn constant(self, value: FixedI32<F>) -> Self {
        Saturating(value)
    }

    #[inline(always)]
    fn clamp(self, low: Self, high: Self) -> Self {
        self.max(low).min(high)
    }

    /// Each product is rounded towards minus infinity; the sum is exact and saturates once, at the end.
    #[inline(always)]
    fn weighted_sum<const N: usize>(start: Self, terms: &[Self; N], weights: &[FixedI32<F>; N]) -> Self {
        // A product has at most 47 bits here, which leaves room for 2^16 of them.
        let mut sum = i64::from(start.0.to_bits());
        for (term, weight) in terms.iter().zip(weights) {
            sum += product(term.0.to_bits(), weight.to_bits()) >> F::U32;
        }
        Saturating(FixedI32::from_bits(saturate(sum)))
    }
}

/// The nearest number of 32 bits.
#[inline(always)]
pub(crate) fn saturate(wide: i64) -> i32 {
    let narrow = wide as i32;
    if i64::from(narrow) == wide {
        narrow
    } else if wide < 0 {
        i32::MIN
    } else {
        i32::MAX
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fixed::types::I16F16;

    #[test]
    fn a_weighted_sum_saturates_once_at_its_end() {
        let number = |x: f64| Saturating(I16F16::from_num(x));
        let [large, minus] = [I16F16::from_num(20_000), I16F16::from_num(-20_000)];
        assert_eq!(Scalar::weighted_sum(number(1.0), &[number(2.0); 2], &[large, minus]), number(1.0));
        assert_eq!(Scalar::weighted_sum(number(1.0), &[number(2.0); 2], &[large; 2]), Q16_16::MAX);
        assert_eq!(Scalar::weighted_sum(Q16_16::MIN, &[Q16_16::MIN; 4], &[I16F16::MAX; 4]), Q16_16::MIN);
    }
}
