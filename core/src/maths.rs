//! Powers, logarithms and sines in `f32`, built from additions, multiplications and bit patterns only.
//!
//! Each function is written once, generic over [`Binary32`], which is one `f32` or a vector of them. None uses a fused
//! multiply-add and each has one order of operations, so the scalar and every vector path give the same bits.
//!
//! | function | domain | largest error (tested in `tests/maths_error.rs`) |
//! | --- | --- | --- |
//! | [`exp2`] | clamped to -126..=126 | 3 ulp |
//! | [`log2`] | normal positive numbers; smaller ones count as 2^-126 | 3 ulp, or 2^-24 absolute near 1 |
//! | [`sin_pi`], [`cos_pi`] | ±2^20 half turns | 2^-22 absolute |
//! | [`sin`], [`cos`] | ±1000 rad | 2^-22 + 2^-23 times the angle, absolute |
//!
//! NaN gives NaN.

use core::f32::consts::{FRAC_1_PI, FRAC_1_SQRT_2, LN_2, LOG2_E, PI};

use crate::scalar::Scalar;

/// 1.5·2^23: an f32 near it has no room for a fraction, and holds a small whole summand in its lowest bits.
const WHOLE: f32 = 12_582_912.0;
/// Bit pattern of √½.
const SQRT_HALF_BITS: u32 = FRAC_1_SQRT_2.to_bits();

/// One `f32` or a vector of them, with the operations on bit patterns that the functions of this module need.
///
/// An implementation for a vector applies each operation to every member, and has to agree with `f32` to the bit.
///
/// ```
/// use mindgap_core::maths::Binary32;
///
/// assert_eq!(12.0f32.frexp(), (0.75, 4.0));
/// ```
pub trait Binary32: Scalar<Weight = f32> {
    /// Returns the absolute value.
    fn abs(self) -> Self;
    /// Returns `self` · 2^n, where `shifted` is 1.5·2^23 + n. Exact while `self` and the result are normal numbers.
    fn ldexp(self, shifted: Self) -> Self;
    /// Returns the mantissa, in [√½, √2), and the whole exponent of a normal positive number.
    fn frexp(self) -> (Self, Self);
}

/// Returns 2^`x`.
///
/// ```
/// use mindgap_core::maths::exp2;
///
/// assert_eq!(exp2(-3.0f32), 0.125);
/// assert_eq!(exp2(1000.0f32), exp2(126.0f32));
/// ```
#[inline(always)]
pub fn exp2<T: Binary32>(x: T) -> T {
    let x = x.clamp(x.constant(-126.0), x.constant(126.0));
    // The bit operations lose a NaN; zero times the number restores it.
    exp2_within(x) + x * x.constant(0.0)
}

/// Equals [`exp2`] to the bit for `x` in -126..=126. Outside that range and for NaN the result is meaningless.
#[inline(always)]
pub fn exp2_within<T: Binary32>(x: T) -> T {
    let shifted = x + x.constant(WHOLE);
    let fraction = x - (shifted - x.constant(WHOLE));
    // The polynomial is split into three independent parts, which a processor computes in parallel.
    let square = fraction * fraction;
    let high = horner(fraction, [0.001_330_060_5, 0.009_669_691]);
    let middle = horner(fraction, [0.055_505_585, 0.240_222_83]);
    let power = (high * square + middle) * square + horner(fraction, [LN_2, 1.0]);
    power.ldexp(shifted)
}

/// Returns the logarithm of `x` to base two.
///
/// ```
/// use mindgap_core::maths::log2;
///
/// assert_eq!(log2(8.0f32), 3.0);
/// assert_eq!(log2(-1.0f32), -126.0);
/// ```
#[inline(always)]
pub fn log2<T: Binary32>(x: T) -> T {
    let x = x.clamp(x.constant(f32::MIN_POSITIVE), x.constant(f32::MAX));
    // As in `exp2`.
    log2_normal(x) + x * x.constant(0.0)
}

/// Equals [`log2`] to the bit for a normal positive `x`. For any other number the result is meaningless.
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

/// Returns sin(π `x`), for `x` in half turns.
#[inline(always)]
pub fn sin_pi<T: Binary32>(x: T) -> T {
    let half_turns = round(x);
    alternating_sign(half_turns) * sin_pi_near_zero(x - half_turns)
}

/// Returns cos(π `x`), for `x` in half turns.
#[inline(always)]
pub fn cos_pi<T: Binary32>(x: T) -> T {
    // cos(π r) = sin(π(½ - |r|)), where the difference is exact.
    let half_turns = round(x);
    let remainder = (x - half_turns).abs();
    alternating_sign(half_turns) * sin_pi_near_zero(x.constant(0.5) - remainder)
}

/// Returns the sine of an angle in radians.
#[inline(always)]
pub fn sin<T: Binary32>(angle_rad: T) -> T {
    sin_pi(angle_rad * angle_rad.constant(FRAC_1_PI))
}

/// Returns the cosine of an angle in radians.
#[inline(always)]
pub fn cos<T: Binary32>(angle_rad: T) -> T {
    cos_pi(angle_rad * angle_rad.constant(FRAC_1_PI))
}

/// Returns the nearest whole number, ties to even, for magnitudes below 2^22.
#[inline(always)]
pub fn round<T: Binary32>(x: T) -> T {
    let whole = x.constant(WHOLE);
    (x + whole) - whole
}

/// Returns sin(π `x`) for `x` in [-½, ½].
#[inline(always)]
fn sin_pi_near_zero<T: Binary32>(x: T) -> T {
    x * horner(x * x, [0.077_560_39, -0.598_242_1, 2.550_069_8, -5.167_71, PI])
}

/// Returns 1 for an even whole number and -1 for an odd one: half of an odd one lies halfway between two whole numbers.
#[inline(always)]
fn alternating_sign<T: Binary32>(whole: T) -> T {
    let half = whole * whole.constant(0.5);
    whole.constant(1.0) - (half - round(half)).abs() * whole.constant(4.0)
}

/// Evaluates a polynomial by Horner's rule; the coefficient of the highest power comes first.
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
        // WHOLE + n holds n in its lowest bits, and the shift drops everything else, so n is added to the exponent.
        f32::from_bits(self.to_bits().wrapping_add(shifted.to_bits() << 23))
    }

    #[inline(always)]
    fn frexp(self) -> (f32, f32) {
        // Counting from √½ puts the mantissa in [√½, √2).
        let above = self.to_bits().wrapping_sub(SQRT_HALF_BITS);
        let exponent = (above as i32) >> 23;
        let mantissa = f32::from_bits((above & 0x007f_ffff).wrapping_add(SQRT_HALF_BITS));
        (mantissa, exponent as f32)
    }
}
