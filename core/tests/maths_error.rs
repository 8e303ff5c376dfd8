//! Checks the error bounds stated in `mindgap_core::maths` against libm in f64.

use mindgap_core::maths::{cos, cos_pi, exp2, log2, sin, sin_pi};

const STEPS: i32 = 2_000_000;

/// Evenly spaced values over a range.
fn spread(from: f32, to: f32) -> impl Iterator<Item = f32> {
    (0..=STEPS).map(move |i| (f64::from(from) + f64::from(to - from) * f64::from(i) / f64::from(STEPS)) as f32)
}

/// One unit in the last place of an f32 near `value`.
fn ulp(value: f64) -> f64 {
    let near = (value.abs() as f32).max(f32::MIN_POSITIVE);
    f64::from(near.next_up()) - f64::from(near)
}

#[test]
fn exp2_is_within_3_ulp() {
    let worst = spread(-125.9, 125.9).chain(spread(-2.0, 2.0)).map(|x| {
        let exact = libm::exp2(f64::from(x));
        (f64::from(exp2(x)) - exact).abs() / ulp(exact)
    });
    let worst = worst.fold(0.0, f64::max);
    assert!(worst <= 3.0, "{worst} ulp");
}

#[test]
fn log2_is_within_3_ulp_or_absolutely_small_near_one() {
    let bits = (f32::MIN_POSITIVE.to_bits()..f32::MAX.to_bits()).step_by(997).map(f32::from_bits);
    for x in bits.chain(spread(0.5, 2.0)) {
        let exact = libm::log2(f64::from(x));
        let error = (f64::from(log2(x)) - exact).abs();
        assert!(error <= (3.0 * ulp(exact)).max(1.0 / f64::from(1 << 24)), "log2({x}) has an error of {error}");
    }
}

#[test]
fn sines_and_cosines_are_within_their_bounds() {
    let half_turns = spread(-1000.0, 1000.0).chain(spread(-2.0, 2.0));
    for x in half_turns {
        let angle = std::f64::consts::PI * (f64::from(x) - 2.0 * libm::round(f64::from(x) / 2.0));
        assert!((f64::from(sin_pi(x)) - libm::sin(angle)).abs() <= 1.0 / f64::from(1 << 22), "sin_pi({x})");
        assert!((f64::from(cos_pi(x)) - libm::cos(angle)).abs() <= 1.0 / f64::from(1 << 22), "cos_pi({x})");
    }
    for x in spread(-1000.0, 1000.0).chain(spread(-4.0, 4.0)) {
        let bound = 1.0 / f64::from(1 << 22) + f64::from(x.abs()) / f64::from(1 << 23);
        assert!((f64::from(sin(x)) - libm::sin(f64::from(x))).abs() <= bound, "sin({x})");
        assert!((f64::from(cos(x)) - libm::cos(f64::from(x))).abs() <= bound, "cos({x})");
    }
}

#[test]
fn arguments_outside_the_domain_saturate_and_nan_stays_nan() {
    assert_eq!(exp2(1e30f32), exp2(126.0f32));
    assert_eq!(exp2(-1e30f32), exp2(-126.0f32));
    assert_eq!(log2(0.0f32), -126.0);
    assert_eq!(log2(-1.0f32), -126.0);
    assert!(exp2(f32::NAN).is_nan() && log2(f32::NAN).is_nan());
    assert_eq!((exp2(0.0f32), log2(1.0f32), sin_pi(0.0f32), cos_pi(0.0f32)), (1.0, 0.0, 0.0, 1.0));
}
