//! Errors of the functions in `mindgap_core::fixed_point`, in units of the last place.

use fixed::FixedI32;
use mindgap_core::fixed_point::{Format, cos_pi, exp2, log2};

/// Returns the error of `exp2` at the number with these bits. The true value saturates like the function.
pub fn of_exp2<F: Format>(bits: i32) -> f64 {
    let x = FixedI32::<F>::from_bits(bits);
    error_ulp(exp2(x), libm::exp2(x.to_num()))
}

/// Returns the error of `log2` at the positive number with these bits.
pub fn of_log2<F: Format>(bits: i32) -> f64 {
    let x = FixedI32::<F>::from_bits(bits);
    error_ulp(log2(x), libm::log2(x.to_num()))
}

/// Returns the error of `cos_pi` at the number with these bits.
pub fn of_cos_pi<F: Format>(bits: i32) -> f64 {
    let x = FixedI32::<F>::from_bits(bits);
    error_ulp(cos_pi(x), libm::cos(std::f64::consts::PI * x.to_num::<f64>()))
}

fn error_ulp<F: Format>(answer: FixedI32<F>, truth: f64) -> f64 {
    let one = f64::from(FixedI32::<F>::ONE.to_bits());
    (f64::from(answer.to_bits()) - (truth * one).min(f64::from(i32::MAX))).abs()
}
