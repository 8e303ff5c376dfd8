//! The numbers that a network can be evaluated on.
//!
//! Floats implement [`Scalar`] here, pairs of numbers in [`pair`](crate::pair), and fixed-point numbers in
//! [`fixed_point`](crate::fixed_point). Vectors of a host processor can implement it too.

use core::ops::{Add, Mul, Sub};

/// A number, or several side by side, on which the affine part of a network can be evaluated.
///
/// ```
/// use mindgap_core::scalar::Scalar;
///
/// fn line<S: Scalar>(x: S, slope: S::Weight, bias: S::Weight) -> S {
///     x * x.constant(slope) + x.constant(bias)
/// }
/// assert_eq!(line(2.0f32, 3.0, 1.0), 7.0);
/// ```
pub trait Scalar: Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> {
    /// The type in which weights are stored. Several types of number may share it.
    type Weight: Copy;
    /// The weight zero.
    const ZERO: Self::Weight;
    /// The weight one.
    const ONE: Self::Weight;

    /// Returns `value` as a number of the same kind as `self`, which gives a vector its width.
    fn constant(self, value: Self::Weight) -> Self;
    /// Returns `low` where `self` is below it, `high` where `self` is above it, and otherwise `self`. NaN stays NaN.
    fn clamp(self, low: Self, high: Self) -> Self;

    /// Returns zero as a number of the same kind as `self`.
    #[inline(always)]
    fn zero(self) -> Self {
        self.constant(Self::ZERO)
    }

    /// Returns one as a number of the same kind as `self`.
    #[inline(always)]
    fn one(self) -> Self {
        self.constant(Self::ONE)
    }

    /// Returns `start` + Σ `terms` · `weights`, added from the first term to the last.
    #[inline(always)]
    fn weighted_sum<const N: usize>(start: Self, terms: &[Self; N], weights: &[Self::Weight; N]) -> Self {
        let mut sum = start;
        for (term, weight) in terms.iter().zip(weights) {
            sum = sum + *term * term.constant(*weight);
        }
        sum
    }
}

/// Implements [`Scalar`] for a primitive float.
macro_rules! scalar {
    ($float:ty) => {
        impl Scalar for $float {
            type Weight = $float;
            const ZERO: $float = 0.0;
            const ONE: $float = 1.0;

            #[inline(always)]
            fn constant(self, value: $float) -> $float {
                value
            }

            #[inline(always)]
            fn clamp(self, low: $float, high: $float) -> $float {
                let raised = if self < low { low } else { self };
                if raised > high { high } else { raised }
            }
        }
    };
}

scalar!(f32);
scalar!(f64);
