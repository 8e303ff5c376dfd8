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
use powers::exp2_of_sum;
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

    /// The sum is exact. Not to be inlined: in a loop over product units the compiler would widen the logarithms once,
    /// ahead of the loop, and then multiply 64 bits by 64.
    #[inline(never)]
    fn product_of_powers<const N: usize>(start: Self, logarithms: &[Self; N], exponents: &[FixedI32<F>; N]) -> Self {
        // A logarithm is between -10 and 15, so a product has at most 61 bits.
        const { assert!(N <= 4, "more products might not fit 64 bits") };
        let mut sum = i64::from(start.0.to_bits()) << F::U32;
        for (logarithm, exponent) in logarithms.iter().zip(exponents) {
            sum = sum.wrapping_add(product(logarithm.0.to_bits(), exponent.to_bits()));
        }
        Saturating(exp2_of_sum(sum))
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
    use crate::network::{Network, ProductForm, ProductUnit, Scaling};
    use fixed::types::I16F16;

    #[test]
    fn a_network_of_either_form_runs_in_q16_16() {
        let number = I16F16::from_num::<f32>;
        // 0.5 + 3 x^2 of x = input / 128, in the signed form on either side of zero.
        let scaling = Scaling { gain: number(1.0 / 128.0), offset: number(0.0), low: number(-2.0), high: number(2.0) };
        let mut network = Network::constant([scaling], number(0.5));
        network.product.push(ProductUnit { exponents: [number(2.0)], output: number(3.0) }).unwrap();
        network.product_form = ProductForm::Signed;
        let at = |network: &Network<I16F16, 1>, input: f32| network.evaluate([Saturating(number(input))]).0;
        assert_eq!([-128.0, -64.0, 128.0, 1e4].map(|x| at(&network, x)), [3.5, 1.25, 3.5, 12.5].map(number));
        // An odd power keeps the sign.
        network.product[0].exponents = [number(3.0)];
        assert_eq!([-128.0, 64.0].map(|x| at(&network, x)), [-2.5, 0.875].map(number));
    }

    #[test]
    fn a_weighted_sum_saturates_once_at_its_end() {
        let number = |x: f64| Saturating(I16F16::from_num(x));
        let [large, minus] = [I16F16::from_num(20_000), I16F16::from_num(-20_000)];
        assert_eq!(Scalar::weighted_sum(number(1.0), &[number(2.0); 2], &[large, minus]), number(1.0));
        assert_eq!(Scalar::weighted_sum(number(1.0), &[number(2.0); 2], &[large; 2]), Q16_16::MAX);
        assert_eq!(Scalar::weighted_sum(Q16_16::MIN, &[Q16_16::MIN; 4], &[I16F16::MAX; 4]), Q16_16::MIN);
    }
}
