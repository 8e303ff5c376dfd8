//! Checks the error bounds stated in `mindgap_core::fixed_point` at evenly spaced inputs. The binary
//! `exhaustive-fixed-point` checks every input.

use fixed::types::extra::{U16, U26};
use mindgap_core::fixed_point::Format;
use mindgap_tests::fixed_point_error::{cos_pi_error_ulp, exp2_error_ulp, log2_error_ulp};

/// Returns about a million evenly spaced bit patterns from `from` on, and the first and last thousand.
fn spread(from: i32) -> impl Iterator<Item = i32> {
    let step = (i64::from(i32::MAX) - i64::from(from)) / 1_000_003;
    let even = (i64::from(from)..=i64::from(i32::MAX)).step_by(step as usize).map(|bits| bits as i32);
    even.chain(from..=from + 1000).chain(i32::MAX - 1000..=i32::MAX)
}

fn worst(inputs: impl Iterator<Item = i32>, error_ulp: fn(i32) -> f64) -> f64 {
    inputs.map(error_ulp).fold(0.0, f64::max)
}

fn assert_within_1_ulp<F: Format>() {
    let near_zero = -100_000..=100_000;
    assert!(worst(spread(i32::MIN).chain(near_zero.clone()), exp2_error_ulp::<F>) <= 1.0);
    assert!(worst(spread(1), log2_error_ulp::<F>) <= 1.0);
    assert!(worst(spread(i32::MIN).chain(near_zero), cos_pi_error_ulp::<F>) <= 1.0);
}

#[test]
fn q16_16_is_within_1_ulp() {
    assert_within_1_ulp::<U16>();
    // Few evenly spaced inputs are in the range where exp2 neither vanishes nor saturates.
    assert!(worst((-18 << 16..16 << 16).step_by(5), exp2_error_ulp::<U16>) <= 1.0);
}

#[test]
fn q6_26_is_within_1_ulp() {
    assert_within_1_ulp::<U26>();
}
