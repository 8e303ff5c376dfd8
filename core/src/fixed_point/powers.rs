//! Powers of two and logarithms to base two.
//!
//! Both divide their range into the same 32 steps of 2^(1/32) and use a cubic within a step, so they share one table of
//! 128 bytes.

use fixed::FixedI32;

use super::product::{upper_product, upper_product_of_halves};
use super::{Format, saturate};

/// 2^(i/32) - 1 with 32 fractional bits. Evaluators in other languages need this table too.
pub const STEPS: [u32; 32] = [
    0x0000_0000,
    0x059b_0d31,
    0x0b55_86d0,
    0x1130_1d01,
    0x172b_83c8,
    0x1d48_7317,
    0x2387_a6e7,
    0x29e9_df52,
    0x306f_e0a3,
    0x371a_7374,
    0x3dea_64c1,
    0x44e0_8606,
    0x4bfd_ad53,
    0x5342_b56a,
    0x5ab0_7dd5,
    0x6247_eb04,
    0x6a09_e668,
    0x71f7_5e8f,
    0x7a11_473f,
    0x8258_9995,
    0x8ace_5423,
    0x9373_7b0d,
    0x9c49_182a,
    0xa550_3b24,
    0xae89_f996,
    0xb7f7_6f30,
    0xc199_bdd8,
    0xcb72_0dcf,
    0xd581_8dd0,
    0xdfc9_7338,
    0xea4a_fa2a,
    0xf507_65b7,
];

/// The lower and upper halves of [`STEPS`].
static STEP_HALVES: [[u16; 2]; 32] = halves(STEPS);

const fn halves(words: [u32; 32]) -> [[u16; 2]; 32] {
    let mut halves = [[0; 2]; 32];
    let mut i = 0;
    while i < words.len() {
        halves[i] = [words[i] as u16, (words[i] >> 16) as u16];
        i += 1;
    }
    halves
}

/// Returns 2^`x`: the largest number where the result does not fit, zero where it is under half an ulp.
///
/// ```
/// use mindgap_core::fixed::types::I16F16;
/// use mindgap_core::fixed_point::exp2;
///
/// assert_eq!(exp2(I16F16::from_num(-3)), I16F16::from_num(0.125));
/// assert_eq!(exp2(I16F16::from_num(15)), I16F16::MAX);
/// ```
pub fn exp2<F: Format>(x: FixedI32<F>) -> FixedI32<F> {
    exp2_of_sum(i64::from(x.to_bits()) << F::U32)
}

/// Returns 2^`x` for `x` with twice as many fractional bits, as products and their sums have.
#[inline(always)]
pub fn exp2_of_sum<F: Format>(x: i64) -> FixedI32<F> {
    let whole = (x >> (2 * F::U32)) as i32;
    let fraction = ((x << (64 - 2 * F::U32)) as u64 >> 32) as u32;
    // Right shift of the mantissa, which has 31 fractional bits, less one for the bit that decides the rounding.
    let shift = 30 - F::I32 - whole;
    FixedI32::from_bits(match shift {
        0..32 => {
            let bits = mantissa(exp2_of_fraction(fraction)) >> shift;
            ((bits >> 1) as i32).saturating_add((bits & 1) as i32)
        }
        32.. => 0,
        _ => i32::MAX,
    })
}

/// Returns the logarithm of `x` to base two. Zero and negative numbers count as the smallest positive number.
///
/// ```
/// use mindgap_core::fixed::types::I16F16;
/// use mindgap_core::fixed_point::log2;
///
/// assert_eq!(log2(I16F16::from_num(0.125)), I16F16::from_num(-3));
/// ```
pub fn log2<F: Format>(x: FixedI32<F>) -> FixedI32<F> {
    let bits = x.to_bits().max(1) as u32;
    let leading_zeros = bits.leading_zeros();
    let whole = i64::from(31 - F::I32) - i64::from(leading_zeros);
    let logarithm = (whole << 32) + log2_of_one_more(bits << leading_zeros << 1);
    let half_ulp = 1 << (31 - F::U32);
    FixedI32::from_bits(saturate((logarithm + half_ulp) >> (32 - F::U32)))
}

/// Returns 2^`fraction` - 1, for `fraction` in [0, 1); both have 32 fractional bits. The error is below 2^-31.
fn exp2_of_fraction(fraction: u32) -> u32 {
    // 2^(t/32) - 1 = t (C1 + t (C2 + t C3)) for t in [0, 1) with 36 fractional bits, within 8.5e-11.
    const C1: u32 = 1_488_522_352;
    const C2: u32 = 16_120_621;
    const C3: u32 = 117_619;
    let halves = STEP_HALVES[(fraction >> 27) as usize];
    let step = (u32::from(halves[1]) << 16) | u32::from(halves[0]);
    let t = fraction << 5;
    let growth = upper_product(t, C1 + upper_product(t, C2 + upper_product(t, C3)));
    // (1 + step) · growth, from 36 down to 32 fractional bits. The sum stays below 2^32.
    step + ((growth + upper_product_of_halves(halves, growth) + 8) >> 4)
}

/// Returns log2(1 + `fraction`), for `fraction` in [0, 1); both have 32 fractional bits. The error is below 2^-29.
fn log2_of_one_more(fraction: u32) -> i64 {
    // log2(1 + u) = u (C1 - u (C2 - u C3)) for u in [0, 2^(1/32) - 1], within 7.3e-10; 31, 32 and 27 fractional bits.
    const C1: u32 = 3_098_162_573;
    const C2: u32 = 3_097_363_789;
    const C3: u32 = 62_557_795;
    let above = STEPS.partition_point(|step| *step <= fraction);
    // To divide by 2^((above - 1)/32) is to multiply by half of 2^((33 - above)/32). The first step needs no division.
    let whole = mantissa(fraction);
    let ratio = STEPS.get(33 - above).map_or(whole, |inverse| upper_product(whole, mantissa(*inverse)));
    let u = ratio.saturating_sub(mantissa(0)) << 6;
    let slope = C1 - (upper_product(u, C2 - upper_product(u, C3)) >> 6);
    (((above as i64) - 1) << 27) + i64::from(upper_product(u, slope) >> 4)
}

/// Returns 1 + `fraction` with 31 fractional bits, for `fraction` in [0, 1) with 32 of them.
fn mantissa(fraction: u32) -> u32 {
    (1 << 31) | (fraction >> 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use fixed::types::{I6F26, I16F16};

    #[test]
    fn table_is_rounded_to_nearest() {
        for (i, step) in STEPS.iter().enumerate() {
            let exact = libm::exp2(32.0 + i as f64 / 32.0) - libm::exp2(32.0);
            assert!((f64::from(*step) - exact).abs() <= 0.5, "step {i}");
        }
    }

    #[test]
    fn last_step_ends_below_the_next_power() {
        for fraction in u32::MAX - 1000..=u32::MAX {
            let exact = libm::exp2(32.0 + f64::from(fraction) / libm::exp2(32.0)) - libm::exp2(32.0);
            assert!((f64::from(exp2_of_fraction(fraction)) - exact).abs() < 2.0, "{fraction}");
        }
    }

    #[test]
    fn whole_powers_are_exact() {
        for n in -16..15 {
            let power = I16F16::from_bits(1 << (n + 16));
            assert_eq!(exp2(I16F16::from_num(n)), power);
            assert_eq!(log2(power), I16F16::from_num(n));
        }
    }

    #[test]
    fn power_that_does_not_fit_saturates() {
        assert_eq!(exp2(I16F16::from_num(15)), I16F16::MAX);
        assert_eq!(exp2(I16F16::MAX), I16F16::MAX);
        assert_eq!(exp2(I16F16::from_num(-17.1)), I16F16::ZERO);
        assert_eq!(exp2(I16F16::MIN), I16F16::ZERO);
        assert_eq!(exp2(I6F26::MAX), I6F26::MAX);
        assert_eq!(exp2(I6F26::MIN), I6F26::ZERO);
    }

    #[test]
    fn logarithm_of_zero_or_less_is_that_of_the_smallest_positive_number() {
        for x in [I16F16::ZERO, I16F16::NEG_ONE, I16F16::MIN] {
            assert_eq!(log2(x), I16F16::from_num(-16));
        }
        assert_eq!(log2(I6F26::MIN), I6F26::from_num(-26));
    }
}
