//! Lanes: numbers that go through the same operations side by side, one a robot or one a sample.
//!
//! The instruction set is chosen when the program runs. Whichever it is, the bits are the same: no operation is fused
//! or reordered, and [`mindgap_core::maths`] is the one source of powers, logarithms and sines.

#[cfg(test)]
mod tests;

use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

use mindgap_core::maths::{self, Binary32};
use mindgap_core::scalar::Scalar;
use pulp::Simd;

/// The widest vector of any instruction set, in f32 numbers. Sums over samples are kept in so many parts whatever the
/// real width, so that they group alike everywhere.
pub const WIDEST: usize = 16;

/// A vector of f32, as wide as the instruction set `S` has it.
#[derive(Clone, Copy, Debug)]
pub struct Lanes<S: Simd> {
    simd: S,
    values: S::f32s,
}

/// A yes or no for every member of a vector.
#[derive(Clone, Copy, Debug)]
pub struct Mask<S: Simd> {
    simd: S,
    bits: S::m32s,
}

impl<S: Simd> Lanes<S> {
    /// Members of a vector.
    pub const WIDTH: usize = S::F32_LANES;

    /// Lanes of a vector.
    #[inline(always)]
    pub fn new(simd: S, values: S::f32s) -> Self {
        Lanes { simd, values }
    }

    /// The same number in every lane.
    #[inline(always)]
    pub fn splat(simd: S, value: f32) -> Self {
        Lanes { simd, values: simd.splat_f32s(value) }
    }

    /// The first [`WIDTH`](Self::WIDTH) numbers of `source`, zeros where it is shorter.
    #[inline(always)]
    pub fn load(simd: S, source: &[f32]) -> Self {
        match S::as_simd_f32s(source).0.first() {
            Some(values) => Lanes { simd, values: *values },
            None => Lanes { simd, values: simd.partial_load_f32s(source) },
        }
    }

    /// Writes the lanes to the front of `target`, as many as it holds.
    #[inline(always)]
    pub fn store(self, target: &mut [f32]) {
        match S::as_mut_simd_f32s(target).0.first_mut() {
            Some(place) => *place = self.values,
            None => self.simd.partial_store_f32s(target, self.values),
        }
    }

    /// Where `self` is less than `other`.
    #[inline(always)]
    pub fn less(self, other: Self) -> Mask<S> {
        Mask { simd: self.simd, bits: self.simd.less_than_f32s(self.values, other.values) }
    }

    /// The lesser of two numbers; `other` where either is NaN.
    #[inline(always)]
    pub fn min(self, other: Self) -> Self {
        self.less(other).select(self, other)
    }

    /// The greater of two numbers; `other` where either is NaN.
    #[inline(always)]
    pub fn max(self, other: Self) -> Self {
        other.less(self).select(self, other)
    }

    /// The square root.
    #[inline(always)]
    pub fn sqrt(self) -> Self {
        Lanes { simd: self.simd, values: self.simd.sqrt_f32s(self.values) }
    }
}

impl<S: Simd> Mask<S> {
    /// `yes` where the mask holds, else `no`.
    #[inline(always)]
    pub fn select(self, yes: Lanes<S>, no: Lanes<S>) -> Lanes<S> {
        Lanes { simd: self.simd, values: self.simd.select_f32s(self.bits, yes.values, no.values) }
    }

    /// Whether the mask holds anywhere.
    #[inline(always)]
    pub fn any(self) -> bool {
        self.simd.first_true_m32s(self.bits) < S::F32_LANES
    }
}

impl<S: Simd> Scalar for Lanes<S> {
    type Weight = f32;
    const ZERO: f32 = 0.0;
    const ONE: f32 = 1.0;

    #[inline(always)]
    fn constant(self, value: f32) -> Self {
        Lanes::splat(self.simd, value)
    }

    #[inline(always)]
    fn clamp(self, low: Self, high: Self) -> Self {
        let raised = self.less(low).select(low, self);
        high.less(raised).select(high, raised)
    }
}

impl<S: Simd> Binary32 for Lanes<S> {
    #[inline(always)]
    fn abs(self) -> Self {
        Lanes { simd: self.simd, values: self.simd.abs_f32s(self.values) }
    }

    #[inline(always)]
    fn ldexp(self, shifted: Self) -> Self {
        let s = self.simd;
        let exponents = s.wrapping_dyn_shl_u32s(s.transmute_u32s_f32s(shifted.values), s.splat_u32s(23));
        let bits = s.add_u32s(s.transmute_u32s_f32s(self.values), exponents);
        Lanes { simd: s, values: s.transmute_f32s_u32s(bits) }
    }

    #[inline(always)]
    fn frexp(self) -> (Self, Self) {
        let s = self.simd;
        let bits = s.transmute_u32s_f32s(self.values);
        // As for f32, with the exponent kept biased, since vectors have no cheap way from integers to f32: in the low
        // bits of 2^23 it is a whole number.
        let above = s.add_u32s(bits, s.splat_u32s(maths::ONE_BITS.wrapping_sub(maths::SQRT_HALF_BITS)));
        let biased = s.wrapping_dyn_shr_u32s(above, s.splat_u32s(23));
        let whole = s.transmute_f32s_u32s(s.or_u32s(biased, s.splat_u32s(0x4b00_0000)));
        let exponent = Lanes { simd: s, values: s.sub_f32s(whole, s.splat_f32s(8_388_608.0 + 127.0)) };
        let scale = s.wrapping_dyn_shl_u32s(biased, s.splat_u32s(23));
        let mantissa = s.sub_u32s(s.add_u32s(bits, s.splat_u32s(maths::ONE_BITS)), scale);
        (Lanes { simd: s, values: s.transmute_f32s_u32s(mantissa) }, exponent)
    }
}

/// Implements an operator of [`Lanes`] by the function of [`Simd`] with its name.
macro_rules! operator {
    ($operator:ident, $method:ident, $function:ident) => {
        impl<S: Simd> $operator for Lanes<S> {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Lanes { simd: self.simd, values: self.simd.$function(self.values, other.values) }
            }
        }
    };
}

operator!(Add, add, add_f32s);
operator!(Sub, sub, sub_f32s);
operator!(Mul, mul, mul_f32s);
operator!(Div, div, div_f32s);

impl<S: Simd> Neg for Lanes<S> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Lanes { simd: self.simd, values: self.simd.neg_f32s(self.values) }
    }
}

impl<S: Simd> BitAnd for Mask<S> {
    type Output = Self;

    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        Mask { simd: self.simd, bits: self.simd.and_m32s(self.bits, other.bits) }
    }
}

impl<S: Simd> BitOr for Mask<S> {
    type Output = Self;

    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        Mask { simd: self.simd, bits: self.simd.or_m32s(self.bits, other.bits) }
    }
}

impl<S: Simd> Not for Mask<S> {
    type Output = Self;

    #[inline(always)]
    fn not(self) -> Self {
        Mask { simd: self.simd, bits: self.simd.not_m32s(self.bits) }
    }
}
