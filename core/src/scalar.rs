//! What a network asks of a number. `f32` and `f64` answer here, Q16.16 in [`fixed_point`](crate::fixed_point).

use core::ops::{Add, Mul, Sub};

use crate::maths;

/// A number that a [`Network`](crate::network::Network) can be evaluated in.
pub trait Scalar: Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> {
    /// The form in which a weight is stored; several kinds of number may share it.
    type Weight: Copy;

    /// `weight` as a number beside `self`: a lane of numbers takes its width from `self`.
    fn weight(self, weight: Self::Weight) -> Self;
    /// `low` where `self` is below it, `high` where above it; NaN stays NaN.
    fn clamp(self, low: Self, high: Self) -> Self;
    /// Zero beside `self`.
    fn zero(self) -> Self;
    /// One beside `self`.
    fn one(self) -> Self;
    /// Two to the power of `self`.
    fn exp2(self) -> Self;
    /// The logarithm to base two of the magnitude of `self`, a magnitude under 2^-10 counting as 2^-10.
    fn log2_magnitude(self) -> Self;
    /// One where `self` is below zero, else zero.
    fn negative(self) -> Self;
    /// cos(π `self`).
    fn cos_pi(self) -> Self;

    /// `start` + Σ `terms` · `weights`, from the first term to the last.
    #[inline(always)]
    fn weighted_sum<const N: usize>(start: Self, terms: &[Self; N], weights: &[Self::Weight; N]) -> Self {
        let mut sum = start;
        for (term, weight) in terms.iter().zip(weights) {
            sum = sum + *term * term.weight(*weight);
        }
        sum
    }

    /// Two to the power of `start` + Σ `logarithms` · `exponents`: a product of powers. The logarithms come from
    /// [`log2_magnitude`](Scalar::log2_magnitude).
    #[inline(always)]
    fn product_of_powers<const N: usize>(start: Self, logarithms: &[Self; N], exponents: &[Self::Weight; N]) -> Self {
        Self::weighted_sum(start, logarithms, exponents).exp2()
    }
}

/// The least magnitude that [`Scalar::log2_magnitude`] tells from zero: the policy for zero in the signed form.
pub const LEAST_MAGNITUDE: f32 = 1.0 / 1024.0;

impl Scalar for f32 {
    type Weight = f32;

    #[inline(always)]
    fn weight(self, weight: f32) -> f32 {
        weight
    }

    #[inline(always)]
    fn clamp(self, low: f32, high: f32) -> f32 {
        maths::Binary32::limit(self, low, high)
    }

    #[inline(always)]
    fn zero(self) -> f32 {
        0.0
    }

    #[inline(always)]
    fn one(self) -> f32 {
        1.0
    }

    #[inline(always)]
    fn exp2(self) -> f32 {
        maths::exp2(self)
    }

    #[inline(always)]
    fn log2_magnitude(self) -> f32 {
        maths::log2(maths::Binary32::limit(maths::Binary32::magnitude(self), LEAST_MAGNITUDE, f32::MAX))
    }

    #[inline(always)]
    fn negative(self) -> f32 {
        if self < 0.0 { 1.0 } else { 0.0 }
    }

    #[inline(always)]
    fn cos_pi(self) -> f32 {
        maths::cos_pi(self)
    }
}

impl Scalar for f64 {
    type Weight = f64;

    fn weight(self, weight: f64) -> f64 {
        weight
    }

    fn clamp(self, low: f64, high: f64) -> f64 {
        if self < low {
            low
        } else if self > high {
            high
        } else {
            self
        }
    }

    fn zero(self) -> f64 {
        0.0
    }

    fn one(self) -> f64 {
        1.0
    }

    fn exp2(self) -> f64 {
        libm::exp2(self)
    }

    fn log2_magnitude(self) -> f64 {
        libm::log2(libm::fabs(self).clamp(f64::from(LEAST_MAGNITUDE), f64::MAX))
    }

    fn negative(self) -> f64 {
        if self < 0.0 { 1.0 } else { 0.0 }
    }

    fn cos_pi(self) -> f64 {
        // Reduced first, so that large sums of exponents stay exact.
        libm::cos(core::f64::consts::PI * (self - 2.0 * libm::round(self / 2.0)))
    }
}
