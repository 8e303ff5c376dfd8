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
//! mindgap-tests --bin exhaustive-fixed-point` goes through them all.

mod cosine;
mod powers;
mod product;

use fixed::types::extra::{IsLessOrEqual, LeEqU32, True, U16, U26, U30};
use fixed::{FixedI32, Saturating};

pub use cosine::cos_pi;
pub use powers::{exp2, log2};
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

    #[inline(always)]
    fn weight(self, weight: FixedI32<F>) -> Self {
        Saturating(weight)
    }

    #[inline(always)]
    fn clamp(self, low: Self, high: Self) -> Self {
        self.max(low).min(high)
    }

    #[inline(always)]
    fn zero(self) -> Self {
        Self::ZERO
    }

    #[inline(always)]
    fn one(self) -> Self {
        Saturating(FixedI32::ONE)
    }

    #[inline(always)]
    fn exp2(self) -> Self {
        Saturating(exp2(self.0))
    }

    #[inline(always)]
    fn log2_magnitude(self) -> Self {
        let least = FixedI32::from_bits(FixedI32::<F>::ONE.to_bits() >> 10);
        Saturating(log2(self.0.saturating_abs().max(least)))
    }

    #[inline(always)]
    fn negative(self) -> Self {
        if self < Self::ZERO { self.one() } else { Self::ZERO }
    }

    #[inline(always)]
    fn cos_pi(self) -> Self {
        Saturating(cos_pi(self.0))
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
    wide.clamp(i64::from(i32::MIN), i64::from(i32::MAX)) as i32
}
