//! What a network asks of a number. Floats answer here, pairs of them in [`pair`](crate::pair), fixed point in
//! [`fixed_point`](crate::fixed_point), vectors in the host's `lanes`.

use core::ops::{Add, Mul, Sub};

/// A number that the affine part of a network can be evaluated in.
pub trait Scalar: Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> {
    /// The form in which a weight is stored; several kinds of number may share it.
    type Weight: Copy;
    /// Zero as a weight.
    const ZERO: Self::Weight;
    /// One as a weight.
    const ONE: Self::Weight;

    /// `value` as a number beside `self`: a lane of numbers takes its width from `self`.
    fn constant(self, value: Self::Weight) -> Self;
    /// `low` where `self` is below it, `high` where above it; NaN stays NaN.
    fn clamp(self, low: Self, high: Self) -> Self;

    /// Zero beside `self`.
    #[inline(always)]
    fn zero(self) -> Self {
        self.constant(Self::ZERO)
    }

    /// One beside `self`.
    #[inline(always)]
    fn one(self) -> Self {
        self.constant(Self::ONE)
    }

    /// `start` + Σ `terms` · `weights`, from the first term to the last.
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
