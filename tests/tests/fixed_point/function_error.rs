//! The error bounds that `mindgap_core::fixed_point` states, at even spaces. The binary `exhaustive-fixed-point` checks
//! every input.

use fixed::types::extra::{U16, U26};
use mindgap_core::fixed_point::Format;
use mindgap_tests::fixed_point_error::{of_cos_pi, of_exp2, of_log2};

/// About a million numbers over all bit patterns from `from` on, and all of the first and last thousand.
fn spread(from: i32) -> impl Iterator<Item = i32> {
    let step = (i64::from(i32::MAX) - i64::from(from)) / 1_000_003;
    let even = (i64::from(from)..=i64::from(i32::MAX)).step_by(step as usize).map(|bits| bits as i32);
    even.chain(from..=from + 1000).chain(i32::MAX - 1000..=i32::MAX)
}

fn worst(inputs: impl Iterator<Item = i32>, error_ulp: fn(i32) -> f64) -> f64 {
    inputs.map(error_ulp).fold(0.0, f64::max)
}

fn is_within_1_ulp<F: Format>() {
    let near_zero = -100_000..=100_000;
    assert!(worst(spread(i32::MIN).chain(near_zero.clone()), of_exp2::<F>) <= 1.0);
    assert!(worst(spread(1), of_log2::<F>) <= 1.0);
    assert!(worst(spread(i32::MIN).chain(near_zero), of_cos_pi::<F>) <= 1.0);
}

#[test]
fn q16_16_is_within_1_ulp() {
    is_within_1_ulp::<U16>();
    // Even spaces over all inputs leave few where exp2 neither vanishes nor saturates.
    assert!(worst((-18 << 16..16 << 16).step_by(5), of_exp2::<U16>) <= 1.0);
}

#[test]
fn q6_26_is_within_1_ulp() {
    is_within_1_ulp::<U26>();
}
