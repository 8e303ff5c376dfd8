//! An interleaved pair: two numbers that go through the same operations, one right after the other.

use core::ops::{Add, Mul, Sub};

use crate::maths::Binary32;
use crate::scalar::Scalar;

/// Two numbers or two vector lanes that are computed together.
///
/// While a processor waits for the result of one, it works on the other, and both share the constants of an operation. Two
/// calls in a row would be too far apart in the program for that.
///
/// ```
/// use mindgap_core::maths::exp2;
/// use mindgap_core::pair::Pair;
///
/// let Pair(a, b) = exp2(Pair(2.0f32, -1.0));
/// assert_eq!((a, b), (exp2(2.0f32), exp2(-1.0f32)));
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Pair<T>(pub T, pub T);

impl<T: Scalar> Scalar for Pair<T> {
    type Weight = T::Weight;
    const ZERO: T::Weight = T::ZERO;
    const ONE: T::Weight = T::ONE;

    #[inline(always)]
    fn constant(self, value: T::Weight) -> Self {
        let constant = self.0.constant(value);
        Pair(constant, constant)
    }

    #[inline(always)]
    fn clamp(self, low: Self, high: Self) -> Self {
        Pair(self.0.clamp(low.0, high.0), self.1.clamp(low.1, high.1))
    }
}

impl<T: Binary32> Binary32 for Pair<T> {
    #[inline(always)]
    fn abs(self) -> Self {
        Pair(self.0.abs(), self.1.abs())
    }

    #[inline(always)]
    fn ldexp(self, shifted: Self) -> Self {
        Pair(self.0.ldexp(shifted.0), self.1.ldexp(shifted.1))
    }

    #[inline(always)]
    fn frexp(self) -> (Self, Self) {
        let ((mantissa, exponent), (other_mantissa, other_exponent)) = (self.0.frexp(), self.1.frexp());
        (Pair(mantissa, other_mantissa), Pair(exponent, other_exponent))
    }
}

/// Implements an operator of [`Pair`] member by member.
macro_rules! operator {
    ($operator:ident, $method:ident) => {
        impl<T: $operator<Output = T>> $operator for Pair<T> {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Pair(self.0.$method(other.0), self.1.$method(other.1))
            }
        }
    };
}

operator!(Add, add);
operator!(Sub, sub);
operator!(Mul, mul);
