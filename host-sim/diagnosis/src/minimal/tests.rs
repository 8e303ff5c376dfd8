use super::*;
use crate::test_support::CALIBRATION;

const NOISE_CM: f64 = 0.4;

/// Sixteen runs of forty steps at changing speeds and headings, with noise of this size and a change by `effect_cm`.
fn steps(effect_cm: fn(&Step) -> f64) -> Vec<Step> {
    let of_run = |run: usize| {
        (0..40).map(move |at| {
            let mut step = Step {
                run,
                predicted_cm: [8.0, -3.0, 5.0, 2.0][(run + at / 4) % 4],
                logged_cm: 0.0,
                heading_rad: (run * 7 + at / 2) as f64,
                reference_cm: 8.0,
            };
            let noise_cm = NOISE_CM * [1.0, -1.3, -0.6, 0.9][(run + at) % 4];
            step.logged_cm = step.predicted_cm + effect_cm(&step) + noise_cm;
            step
        })
    };
    (0..16).flat_map(of_run).collect()
}

fn diagnosed(effect_cm: fn(&Step) -> f64) -> Diagnosis {
    diagnose(&steps(effect_cm), NOISE_CM, &CALIBRATION)
}

fn size_of(diagnosis: &Diagnosis, id: &str) -> f64 {
    let found = diagnosis.effects.iter().find(|found| found.id == id).unwrap_or_else(|| panic!("{diagnosis:?}"));
    let [low, high] = found.interval;
    assert!(low <= found.size && found.size <= high, "{found:?}");
    found.size
}

#[test]
fn noise_is_no_gap() {
    let diagnosis = diagnosed(|_| 0.0);
    assert!(diagnosis.verdict == Verdict::NoGap && diagnosis.effects.is_empty(), "{diagnosis:?}");
}

#[test]
fn single_effects_are_named_with_their_size() {
    let scale = diagnosed(|step| -0.1 * step.predicted_cm);
    assert!(scale.effects.len() == 1 && (size_of(&scale, "drive_scale") - 0.9).abs() < 0.01, "{scale:?}");
    let nap = diagnosed(|step| {
        let against = libm::cos(step.heading_rad - 2.0) * step.predicted_cm.signum();
        -0.1 * 0.5 * (1.0 + against) * step.reference_cm * step.predicted_cm.signum()
    });
    assert!(nap.effects.len() == 1 && (size_of(&nap, "carpet_nap") - 0.1).abs() < 0.02, "{nap:?}");
    let slope = diagnosed(|step| 0.05 * step.reference_cm * libm::cos(step.heading_rad - 1.0));
    assert!(slope.effects.len() == 1 && (size_of(&slope, "slope") - 0.05).abs() < 0.01, "{slope:?}");
}

#[test]
fn two_effects_are_both_named() {
    // The larger one is the one that no other law imitates: forward selection keeps its first choice.
    let both =
        diagnosed(|step| -0.3 * step.predicted_cm + 0.05 * step.reference_cm * libm::cos(step.heading_rad - 1.0));
    assert!(both.effects.len() == 2, "{both:?}");
    assert!((size_of(&both, "drive_scale") - 0.7).abs() < 0.01, "{both:?}");
    assert!((size_of(&both, "slope") - 0.05).abs() < 0.01, "{both:?}");
}

/// Held-out runs are every fourth; there the effect has the opposite sign.
#[test]
fn effect_that_held_out_runs_refute_is_no_gap() {
    let diagnosis = diagnosed(|step| if step.run % EVERY == EVERY - 1 { 0.3 } else { -0.1 } * step.predicted_cm);
    assert_eq!(diagnosis.verdict, Verdict::NoGap, "{diagnosis:?}");
}
