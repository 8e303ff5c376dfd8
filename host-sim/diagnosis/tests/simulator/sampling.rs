//! One drive in rows of several steps: what is found does not depend on when somebody looked.

use std::collections::BTreeMap;

use mindgap_diagnosis::diagnose;
use mindgap_logs::Logs;
use mindgap_models::simulator::kinematic;

use crate::made_up::MadeUp;

/// Steps of which the first is the shortest, ms.
const STEPS_MS: [usize; 3] = [200, 400, 800];
/// Relative difference of the size of a cause.
const SAME: f64 = 0.05;

/// Returns the causes against the textbook, each with its size as the factor, or the time in ms.
fn causes(logs: &Logs) -> BTreeMap<&'static str, f64> {
    let found = diagnose(kinematic::baseline(logs), logs).expect("poses").effects;
    let size = |key: &str| {
        found.iter().filter_map(|effect| Some((effect.id, effect.parameters.get(key)?.as_f64()?))).collect()
    };
    let (factors, times): (BTreeMap<_, _>, BTreeMap<_, _>) = (size("factor"), size("ms"));
    factors.into_iter().chain(times).collect()
}

fn assert_alike(robot: MadeUp, expected: &[(&'static str, f64)]) {
    let by_step = robot.sampled(STEPS_MS, 16, 51).map(|logs| causes(&logs));
    for (found, step_ms) in by_step.iter().zip(STEPS_MS) {
        let names: Vec<_> = found.keys().copied().collect();
        assert_eq!(names, expected.iter().map(|(id, _)| *id).collect::<Vec<_>>(), "{step_ms} ms: {by_step:?}");
        for (id, size) in expected {
            assert!((found[id] / size - 1.0).abs() < SAME, "{step_ms} ms: {by_step:?}");
        }
    }
}

#[test]
fn a_weak_motor_behind_dead_time_is_the_same_in_steps_of_any_length() {
    let robot = MadeUp { left: 0.88, dead_time_s: 0.15, ..MadeUp::TEXTBOOK };
    assert_alike(robot, &[("latency", 150.0), ("motor_asymmetry", 0.88)]);
}

#[test]
fn a_wide_track_is_the_same_in_steps_of_any_length() {
    assert_alike(MadeUp { stretch: 1.25, ..MadeUp::TEXTBOOK }, &[("track_width", 0.8)]);
}
