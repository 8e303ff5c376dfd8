//! Robots that take more than a step to respond: the simulator knows their lag, and what changes beside it is found.

use mindgap_diagnosis::verdict::Verdict;
use mindgap_diagnosis::{Diagnosis, diagnose};
use mindgap_foundations::executor::Serial;
use mindgap_learning::learn::train::{TABLE_ONE, Trainer, train};
use mindgap_logs::Logs;
use mindgap_models::effects::drive_filter::MostChange;
use mindgap_models::simulator::baseline::Baseline;
use mindgap_models::simulator::{Simulator, kinematic};

use crate::made_up::MadeUp;
use crate::{HEALTHY, SIMULATOR};

const SLOW: MadeUp = MadeUp { dead_time_s: 0.3, lag_s: 0.3, ..MadeUp::TEXTBOOK };

fn learned(logs: &Logs) -> Simulator {
    train(&Serial, logs, &Trainer::Fast, &TABLE_ONE, 1, &|_| {}).expect("the logs train the motion networks")
}

fn against(simulator: &Simulator, logs: &Logs) -> Diagnosis {
    diagnose(Baseline::at_posterior_mean(simulator).expect("a reference"), logs).expect("poses")
}

/// Asserts that the left motor is the only cause.
fn assert_weak_left(diagnosis: &Diagnosis) {
    let [found] = diagnosis.effects.as_slice() else { panic!("{:?}", diagnosis.effects) };
    let factor = found.parameters["factor"].as_f64().expect("a number");
    assert_eq!((found.id, found.parameters["side"].as_str()), ("motor_asymmetry", Some("left")));
    assert!((factor - 0.88).abs() < 0.01, "{found:?}");
}

#[test]
fn a_slow_robot_agrees_with_its_own_simulator() {
    let simulator = learned(&SLOW.logs(40, 31));
    let (dead_time_s, lag_s) = (0.4 * simulator.filter.dead_time_steps, 0.4 * simulator.filter.lag_steps);
    assert!((dead_time_s - 0.3).abs() < 0.02 && (lag_s - 0.3).abs() < 0.02, "{:?}", simulator.filter);
    let again = against(&simulator, &SLOW.logs(14, 32));
    assert_eq!(again.verdict, Verdict::NoGap, "{:?}", again.effects);
    assert_weak_left(&against(&simulator, &MadeUp { left: 0.88, ..SLOW }.logs(14, 33)));
}

#[test]
fn a_slower_or_faster_robot_differs_by_its_times() {
    let simulator = learned(&SLOW.logs(40, 31));
    for (dead_time_s, lag_s, cause, ms) in [(0.2, 0.3, "latency", -100.0), (0.3, 0.45, "inertia", 150.0)] {
        let diagnosis = against(&simulator, &MadeUp { dead_time_s, lag_s, ..SLOW }.logs(14, 34));
        let first = diagnosis.effects.first().unwrap_or_else(|| panic!("{cause}: {:?}", diagnosis.verdict));
        assert_eq!(first.id, cause, "{:?}", diagnosis.effects);
        let found = first.parameters["ms"].as_f64().expect("a number");
        assert!((found - ms).abs() < 20.0, "{cause} {found} for {ms}");
    }
}

#[test]
fn a_ramp_is_learned_and_is_found_where_only_the_robot_has_one() {
    let ramped = MadeUp { ramp_cm_s2: 60.0, ..MadeUp::TEXTBOOK };
    let simulator = learned(&ramped.logs(40, 35));
    let per_step = match simulator.filter.most_change {
        Some(MostChange::Wheel(share)) => share,
        other => panic!("{other:?}"),
    };
    // 60 cm/s² over a step of 0.4 s, of a reference speed of 41 cm/s.
    assert!((per_step * 41.0 / 0.4 - 60.0).abs() < 4.0, "{:?}", simulator.filter);
    let again = against(&simulator, &ramped.logs(14, 36));
    assert!(again.effects.is_empty(), "{:?}", again.effects);

    let logs = ramped.logs(14, 37);
    let without = diagnose(kinematic::baseline(&logs), &logs).expect("poses");
    assert_eq!(without.effects.first().map(|effect| effect.id), Some("rate_limit"), "{:?}", without.effects);
}

#[test]
fn a_robot_that_answers_within_a_step_needs_no_filter() {
    assert!(SIMULATOR.filter.is_none(), "{:?} of {} runs", SIMULATOR.filter, HEALTHY.runs.len());
}
