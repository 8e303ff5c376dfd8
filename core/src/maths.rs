//! Powers, logarithms and sines in f32, put together from additions, multiplications and bit patterns alone.
//!
//! Each function is written once over [`Binary32`], which one `f32` answers and so does a lane of them. None uses a
//! fused multiply-add and all keep one order of operations, so the scalar and every vector path give the same bits.
//!
//! | function | domain | largest error (tested in `tests/maths_error.rs`) |
//! | --- | --- | --- |
//! | [`exp2`] | clamped to -126..=126 | 3 ulp |
//! | [`log2`] | normal positive numbers; smaller ones count as 2^-126 | 3 ulp, or 2^-24 absolute near 1 |
//! | [`sin_pi`], [`cos_pi`] | ±2^20 | 2^-22 absolute |
//! | [`sin`], [`cos`] | ±1000 rad | 2^-22 + 2^-23 times the angle, absolute |

use core::f32::consts::{FRAC_1_PI, LN_2, LOG2_E, PI};

use crate::scalar::Scalar;

/// 1.5·2^23: an f32 near it has no room for a fraction, and holds a small whole summand in its lowest bits.
pub const WHOLE: f32 = 12_582_912.0;
/// Bit pattern of √½.
pub const SQRT_HALF_BITS: u32 = 0x3f35_04f3;
/// Bit pattern of 1.
pub const ONE_BITS: u32 = 0x3f80_0000;

/// An f32 or several, with the operations on bit patterns that the functions of this module are put together from.
///
/// An implementation over a lane applies each to every member; the scalar and the lane have to agree to the bit.
pub trait Binary32: Scalar<Weight = f32> {
    /// The absolute value.
    fn abs(self) -> Self;
    /// `self` times two to the power n, where `shifted` is [`WHOLE`] + n: exact while `self` and the result are normal
    /// numbers.
    fn ldexp(self, shifted: Self) -> Self;
    /// Mantissa in [√½, √2) and whole exponent of a normal positive number.
    fn frexp(self) -> (Self, Self);
}

/// Two to the power of `x`.
#[inline(always)]
pub fn exp2<T: Binary32>(x: T) -> T {
    let x = x.clamp(x.constant(-126.0), x.constant(126.0));
    // A bit pattern forgets that it was NaN; zero times the number does not.
    exp2_within(x) + x * x.constant(0.0)
}

/// The same, bit for bit, for an `x` that is known to be in -126..=126; beyond, and for NaN, the result means nothing.
#[inline(always)]
pub fn exp2_within<T: Binary32>(x: T) -> T {
    let shifted = x + x.constant(WHOLE);
    let rest = x - (shifted - x.constant(WHOLE));
    // A polynomial in three independent halves, which a processor works out side by side.
    let square = rest * rest;
    let high = horner(rest, [0.001_330_060_5, 0.009_669_691]);
    let middle = horner(rest, [0.055_505_585, 0.240_222_83]);
    let power = (high * square + middle) * square + horner(rest, [LN_2, 1.0]);
    power.ldexp(shifted)
}

/// The logarithm of `x` to base two.
#[inline(always)]
pub fn log2<T: Binary32>(x: T) -> T {
    let x = x.clamp(x.constant(f32::MIN_POSITIVE), x.constant(f32::MAX));
    // As above.
    log2_normal(x) + x * x.constant(0.0)
}

/// The same, bit for bit, for an `x` that is known to be a normal positive number; for others the result means nothing.
#[inline(always)]
pub fn log2_normal<T: Binary32>(x: T) -> T {
    let (mantissa, exponent) = x.frexp();
    let t = mantissa - x.constant(1.0);
    let slope = horner(
        t,
        [
            0.125_837_03,
            -0.207_269_76,
            0.215_715_6,
            -0.238_944_81,
            0.287_916_24,
            -0.360_703_68,
            0.480_910_63,
            -0.721_347_33,
            LOG2_E,
        ],
    );
    exponent + t * slope
}

/// sin(π `x`).
#[inline(always)]
pub fn sin_pi<T: Binary32>(x: T) -> T {
    let half_turns = round(x);
    alternating_sign(half_turns) * sin_pi_near_zero(x - half_turns)
}

/// cos(π `x`).
#[inline(always)]
pub fn cos_pi<T: Binary32>(x: T) -> T {
    // cos(π r) = sin(π(½ - |r|)), where the difference is exact.
    let half_turns = round(x);
    let rest = (x - half_turns).abs();
    alternating_sign(half_turns) * sin_pi_near_zero(x.constant(0.5) - rest)
}

/// The sine of `angle_rad`.
#[inline(always)]
pub fn sin<T: Binary32>(angle_rad: T) -> T {
    sin_pi(angle_rad * angle_rad.constant(FRAC_1_PI))
}

/// The cosine of `angle_rad`.
#[inline(always)]
pub fn cos<T: Binary32>(angle_rad: T) -> T {
    cos_pi(angle_rad * angle_rad.constant(FRAC_1_PI))
}

/// The nearest whole number, ties to even, for magnitudes below 2^22: beside [`WHOLE`] there is no room for a fraction.
#[inline(always)]
pub fn round<T: Binary32>(x: T) -> T {
    let whole = x.constant(WHOLE);
    (x + whole) - whole
}

/// sin(π `x`) for `x` in [-½, ½].
#[inline(always)]
fn sin_pi_near_zero<T: Binary32>(x: T) -> T {
    x * horner(x * x, [0.077_560_39, -0.598_242_1, 2.550_069_8, -5.167_71, PI])
}

/// 1 for an even whole number and -1 for an odd one: half of an odd one lies half way between two whole numbers.
#[inline(always)]
fn alternating_sign<T: Binary32>(whole: T) -> T {
    let half = whole * whole.constant(0.5);
    whole.constant(1.0) - (half - round(half)).abs() * whole.constant(4.0)
}

/// A polynomial by Horner's rule, highest power first.
#[inline(always)]
fn horner<T: Binary32, const N: usize>(x: T, coefficients: [f32; N]) -> T {
    let mut sum = x.constant(0.0);
    let mut first = true;
    for coefficient in coefficients {
        let coefficient = x.constant(coefficient);
        sum = if first { coefficient } else { sum * x + coefficient };
        first = false;
    }
    sum
}

impl Binary32 for f32 {
    #[inline(always)]
    fn abs(self) -> f32 {
        f32::from_bits(self.to_bits() & 0x7fff_ffff)
    }

    #[inline(always)]
    fn ldexp(self, shifted: f32) -> f32 {
        // WHOLE + n holds n in its lowest bits, and nothing else that the shift leaves there: what is added is n
        // exponents.
        f32::from_bits(self.to_bits().wrapping_add(shifted.to_bits() << 23))
    }

    #[inline(always)]
    fn frexp(self) -> (f32, f32) {
        // Counting from √½ puts the mantissa into [√½, √2).
        let above = self.to_bits().wrapping_sub(SQRT_HALF_BITS);
        let exponent = (above as i32) >> 23;
        let mantissa = f32::from_bits((above & 0x007f_ffff).wrapping_add(SQRT_HALF_BITS));
        (mantissa, exponent as f32)
    }
}
