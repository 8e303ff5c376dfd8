//! SIMD lanes: numbers that undergo the same operations side by side, one per robot or one per sample.
//!
//! The instruction set is chosen at run time. Results are bit-identical on all of them: no operation is fused or reordered,
//! and [`mindgap_core::maths`] is the only source of powers, logarithms and sines.

#[cfg(test)]
mod tests;

use std::f32::consts::FRAC_1_SQRT_2;
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

use mindgap_core::maths::Binary32;
use mindgap_core::scalar::Scalar;
use pulp::Simd;

/// Width of the widest vector of any instruction set, in f32 numbers. Sums over samples are always kept in this many parts,
/// so that they group alike on every machine.
pub const WIDEST: usize = 16;
/// Bit pattern of 1.
const ONE_BITS: u32 = 1.0f32.to_bits();

/// A vector of f32, as wide as the instruction set `S` allows.
#[derive(Clone, Copy, Debug)]
pub struct Lanes<S: Simd> {
    simd: S,
    values: S::f32s,
}

/// One boolean per lane of a vector.
#[derive(Clone, Copy, Debug)]
pub struct Mask<S: Simd> {
    simd: S,
    bits: S::m32s,
}

impl<S: Simd> Lanes<S> {
    /// Number of lanes.
    pub const WIDTH: usize = S::F32_LANES;

    /// Wraps a vector.
    #[inline(always)]
    pub fn new(simd: S, values: S::f32s) -> Self {
        Lanes { simd, values }
    }

    /// Returns `value` in every lane.
    #[inline(always)]
    pub fn splat(simd: S, value: f32) -> Self {
        Lanes { simd, values: simd.splat_f32s(value) }
    }

    /// Loads the first [`WIDTH`](Self::WIDTH) numbers of `source`, padded with zeros.
    #[inline(always)]
    pub fn load(simd: S, source: &[f32]) -> Self {
        match S::as_simd_f32s(source).0.first() {
            Some(values) => Lanes { simd, values: *values },
            None => Lanes { simd, values: simd.partial_load_f32s(source) },
        }
    }

    /// Stores the lanes at the start of `target`, as many as it holds.
    #[inline(always)]
    pub fn store(self, target: &mut [f32]) {
        match S::as_mut_simd_f32s(target).0.first_mut() {
            Some(first) => *first = self.values,
            None => self.simd.partial_store_f32s(target, self.values),
        }
    }

    /// Compares lane by lane: `self < other`.
    #[inline(always)]
    pub fn less(self, other: Self) -> Mask<S> {
        Mask { simd: self.simd, bits: self.simd.less_than_f32s(self.values, other.values) }
    }

    /// Returns the smaller number per lane; `other` if either is NaN.
    #[inline(always)]
    pub fn min(self, other: Self) -> Self {
        self.less(other).select(self, other)
    }

    /// Returns the larger number per lane; `other` if either is NaN.
    #[inline(always)]
    pub fn max(self, other: Self) -> Self {
        other.less(self).select(self, other)
    }

    /// Returns the square root per lane.
    #[inline(always)]
    pub fn sqrt(self) -> Self {
        Lanes { simd: self.simd, values: self.simd.sqrt_f32s(self.values) }
    }
}

impl<S: Simd> Mask<S> {
    /// Returns `yes` in lanes where the mask is set, `no` in the others.
    #[inline(always)]
    pub fn select(self, yes: Lanes<S>, no: Lanes<S>) -> Lanes<S> {
        Lanes { simd: self.simd, values: self.simd.select_f32s(self.bits, yes.values, no.values) }
    }

    /// Returns whether any lane is set.
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
        // As for f32, but with a biased exponent, since vectors have no cheap conversion from integers to f32: placed in
        // the low bits of 2^23 it is a whole number.
        let above = s.add_u32s(bits, s.splat_u32s(ONE_BITS.wrapping_sub(FRAC_1_SQRT_2.to_bits())));
        let biased = s.wrapping_dyn_shr_u32s(above, s.splat_u32s(23));
        let whole = s.transmute_f32s_u32s(s.or_u32s(biased, s.splat_u32s(0x4b00_0000)));
        let exponent = Lanes { simd: s, values: s.sub_f32s(whole, s.splat_f32s(8_388_608.0 + 127.0)) };
        let scale = s.wrapping_dyn_shl_u32s(biased, s.splat_u32s(23));
        let mantissa = s.sub_u32s(s.add_u32s(bits, s.splat_u32s(ONE_BITS)), scale);
        (Lanes { simd: s, values: s.transmute_f32s_u32s(mantissa) }, exponent)
    }
}

/// Implements an operator of [`Lanes`] with the [`Simd`] function `$function`.
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
