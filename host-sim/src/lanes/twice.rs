//! Two numbers that go through the same operations one right after the other.

use std::ops::{Add, Mul, Sub};

use mindgap_core::maths::Binary32;
use mindgap_core::scalar::Scalar;

/// Two numbers or two lanes. A processor that waits for the result of one has the other to work on, and both share what
/// an operation needs beside them; as two calls in a row they would come too far apart for it to see.
#[derive(Clone, Copy, Debug)]
pub struct Twice<T>(pub T, pub T);

impl<T: Binary32> Binary32 for Twice<T> {
    #[inline(always)]
    fn constant(self, value: f32) -> Self {
        let constant = self.0.constant(value);
        Twice(constant, constant)
    }

    #[inline(always)]
    fn limit(self, low: f32, high: f32) -> Self {
        Twice(self.0.limit(low, high), self.1.limit(low, high))
    }

    #[inline(always)]
    fn magnitude(self) -> Self {
        Twice(self.0.magnitude(), self.1.magnitude())
    }

    #[inline(always)]
    fn times_two_to(self, shifted: Self) -> Self {
        Twice(self.0.times_two_to(shifted.0), self.1.times_two_to(shifted.1))
    }

    #[inline(always)]
    fn split_exponent(self) -> (Self, Self) {
        let ((m, n), (e, f)) = (self.0.split_exponent(), self.1.split_exponent());
        (Twice(m, e), Twice(n, f))
    }
}

impl<T: Scalar> Scalar for Twice<T> {
    type Weight = T::Weight;

    #[inline(always)]
    fn weight(self, weight: T::Weight) -> Self {
        let weight = self.0.weight(weight);
        Twice(weight, weight)
    }

    #[inline(always)]
    fn clamp(self, low: Self, high: Self) -> Self {
        Twice(self.0.clamp(low.0, high.0), self.1.clamp(low.1, high.1))
    }

    #[inline(always)]
    fn zero(self) -> Self {
        Twice(self.0.zero(), self.1.zero())
    }

    #[inline(always)]
    fn one(self) -> Self {
        Twice(self.0.one(), self.1.one())
    }

    #[inline(always)]
    fn exp2(self) -> Self {
        Twice(self.0.exp2(), self.1.exp2())
    }

    #[inline(always)]
    fn log2_magnitude(self) -> Self {
        Twice(self.0.log2_magnitude(), self.1.log2_magnitude())
    }

    #[inline(always)]
    fn negative(self) -> Self {
        Twice(self.0.negative(), self.1.negative())
    }

    #[inline(always)]
    fn cos_pi(self) -> Self {
        Twice(self.0.cos_pi(), self.1.cos_pi())
    }
}

/// Implements an operator of [`Twice`] by that of its numbers.
macro_rules! operator {
    ($operator:ident, $method:ident) => {
        impl<T: $operator<Output = T>> $operator for Twice<T> {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Twice(self.0.$method(other.0), self.1.$method(other.1))
            }
        }
    };
}

operator!(Add, add);
operator!(Sub, sub);
operator!(Mul, mul);
