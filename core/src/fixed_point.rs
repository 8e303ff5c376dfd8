//! Fixed-point numbers and functions, which need no floating-point unit and have the same bits on every machine.
//!
//! There are two formats, both 32 bits wide: [`Q16_16`] for inputs and outputs (commands, centimetres, degrees,
//! probabilities) and [`Q6_26`] for everything in between (scaled inputs, logarithms, exponents). Sums, differences and
//! products saturate. A product drops the bits that do not fit, so it rounds towards minus infinity.
//!
//! | function | zero and negative arguments | result that does not fit |
//! | --- | --- | --- |
//! | [`exp2`] | as any other | the largest number |
//! | [`log2`] | count as the smallest positive number | does not occur |
//! | [`cos_pi`] | as any other | does not occur |
//!
//! Each is within 1 unit in the last place (2^-16 or 2^-26) at every input of both formats. The project's binary
//! `exhaustive-fixed-point` checks them all.

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

/// A saturating number with 16 fractional bits, in -32768..32768.
///
/// ```
/// use mindgap_core::fixed_point::Q16_16;
///
/// assert_eq!(Q16_16::MAX + Q16_16::MAX, Q16_16::MAX);
/// ```
pub type Q16_16 = Saturating<FixedI32<U16>>;
/// A saturating number with 26 fractional bits, in -32..32.
///
/// ```
/// use mindgap_core::fixed_point::Q6_26;
///
/// assert_eq!(Q6_26::MIN - Q6_26::MAX, Q6_26::MIN);
/// ```
pub type Q6_26 = Saturating<FixedI32<U26>>;

/// A number of fractional bits that the functions of this module support: 16 or 26.
///
/// ```
/// use mindgap_core::fixed::FixedI32;
/// use mindgap_core::fixed_point::{Format, exp2, log2};
///
/// fn square_root<F: Format>(x: FixedI32<F>) -> FixedI32<F> {
///     exp2(log2(x) / 2)
/// }
/// use mindgap_core::fixed::types::I16F16;
/// assert_eq!(square_root(I16F16::from_num(16)), I16F16::from_num(4));
/// ```
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

/// Returns the nearest 32-bit number.
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
    fn weighted_sum_saturates_only_at_its_end() {
        let number = |x: f64| Saturating(I16F16::from_num(x));
        let [large, minus] = [I16F16::from_num(20_000), I16F16::from_num(-20_000)];
        assert_eq!(Scalar::weighted_sum(number(1.0), &[number(2.0); 2], &[large, minus]), number(1.0));
        assert_eq!(Scalar::weighted_sum(number(1.0), &[number(2.0); 2], &[large; 2]), Q16_16::MAX);
        assert_eq!(Scalar::weighted_sum(Q16_16::MIN, &[Q16_16::MIN; 4], &[I16F16::MAX; 4]), Q16_16::MIN);
    }
}
