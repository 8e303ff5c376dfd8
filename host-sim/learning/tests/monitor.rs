//! The monitor on board, on the built-in robot: how often an unchanged robot raises an alarm, and how soon a changed one does.
//! With `MINDGAP_SLOW` set: 20 robots with 50 lifetimes each, and 10 trials of each effect; otherwise a few of each.

use mindgap_built_in_robot::{ActiveEffect, default_robot, record, training_room};
use mindgap_core::monitor::{Alternative, Monitor, Outcome};
use mindgap_foundations::executor::Serial;
use mindgap_learning::learn::train::{TABLE_ONE, Trainer, train};
use mindgap_logs::{Logs, Run};
use mindgap_models::simulator::Simulator;
use mindgap_models::simulator::monitor::directions::NAMED;
use mindgap_models::simulator::monitor::replay::Replay;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

/// Effects halfway from neutral to their default.
const EFFECTS: [(&str, f64); 8] = [
    ("battery_sag", 0.175),
    ("motor_asymmetry", 0.06),
    ("drive_scale", 0.95),
    ("track_width", 0.935),
    ("deadband", 9.0),
    ("latency", 50.0),
    ("inertia", 60.0),
    ("payload", 0.04),
];
/// Steps of a run in which a robot changes.
const RUN_STEPS: usize = 60;
/// Expected gain in nats within whose steps an alarm has to come.
const ALLOWED_NATS: f64 = 25.0;

/// Returns the first number of a slow test, and the second otherwise.
fn slowly(slow: u64, quick: u64) -> u64 {
    if std::env::var_os("MINDGAP_SLOW").is_some() { slow } else { quick }
}

fn logs(runs: usize, steps: usize, effects: &[ActiveEffect], seed: u64) -> Logs {
    record(&default_robot(), &training_room(), runs, steps, effects, seed).expect("the room has space")
}

/// Returns a simulator of logs of its own.
fn simulator(robot: u64) -> Simulator {
    let logs = logs(60, 60, &[], 1000 + robot);
    train(&Serial, &logs, &Trainer::Fast, &TABLE_ONE, robot, &|_| {}).expect("networks")
}

#[test]
fn unchanged_robots_hardly_ever_raise_an_alarm() {
    let (robots, lifetimes) = (slowly(20, 4), slowly(50, 3));
    let alarms: usize = (1..=robots)
        .into_par_iter()
        .map(|robot| {
            let replay = Replay::of(&simulator(robot)).expect("a monitor");
            let law = replay.law.law();
            let raises = |life: u64| {
                let logs = logs(40, 250, &[], 50_000 + 100 * robot + life);
                let mut monitor = Monitor::new(&law);
                logs.runs.iter().for_each(|run| replay.run(&law, &mut monitor, run, |_, _, _| {}));
                monitor.alarm().inspect(|alarm| println!("robot {robot}, life {life}: {alarm:?}")).is_some()
            };
            (0..lifetimes).filter(|life| raises(*life)).count()
        })
        .sum();
    let lives = robots * lifetimes;
    println!("{alarms} alarms in {lives} lifetimes of 10,000 steps");
    assert!(50 * alarms as u64 <= lives, "{alarms} alarms in {lives} lifetimes");
}

#[test]
fn effects_are_found_in_time_and_named() {
    let simulator = simulator(1);
    let replay = Replay::of(&simulator).expect("a monitor");
    let law = replay.law.law();
    let trials = slowly(10, 5);
    let (mut named, mut slow) = (0, Vec::new());
    for (id, strength) in EFFECTS {
        let effect: ActiveEffect = format!("{id}={strength}").parse().expect("an effect");
        let mut steps: Vec<usize> = Vec::new();
        for trial in 0..trials {
            let before = logs(3 + trial as usize, RUN_STEPS, &[], 90_000 + trial);
            let after = logs(40, RUN_STEPS, &[effect], 91_000 + trial);
            let mut monitor = Monitor::new(&law);
            before.runs.iter().for_each(|run| replay.run(&law, &mut monitor, run, |_, _, _| {}));
            let mut until = 0;
            after.runs.iter().for_each(|run| {
                replay.run(&law, &mut monitor, run, |_, outcome, _| {
                    until += usize::from(!matches!(outcome, Outcome::Changed(_)))
                });
            });
            if let Some(Alternative::Direction(direction, _)) = monitor.alarm().map(|alarm| alarm.alternative) {
                named += u64::from(NAMED[usize::from(direction)].effects.contains(&id));
            }
            steps.push(until + 1);
        }
        steps.sort_unstable();
        let (median, allowed) = (
            steps[steps.len() / 2] as f64,
            allowed_steps(&simulator, &replay, &logs(60, RUN_STEPS, &[effect], 92_000)),
        );
        println!("{id} {strength}: alarm after {median} steps (median); {ALLOWED_NATS} nats take {allowed}");
        if median > allowed {
            slow.push(id);
        }
    }
    println!("{named} of {} named", 8 * trials);
    assert!(slow.is_empty(), "{slow:?}");
    assert!(10 * named >= 8 * 8 * trials, "{named}");
}

/// Returns the number of steps from the beginning of a run in which the expected gain of an effect adds up to [`ALLOWED_NATS`]: by
/// the noise of the diagnosis, for the mean shift of forward and turn that logs of the effect show. A battery that fades gains little
/// in the first steps of a run.
fn allowed_steps(simulator: &Simulator, replay: &Replay, logs: &Logs) -> f64 {
    let reference = simulator.reference.as_ref().and_then(|reference| reference.motion.as_ref()).expect("scatter");
    let rows: Vec<Compared> = logs.runs.iter().flat_map(|run| residuals(replay, simulator, run)).collect();
    let x = DMatrix::from_fn(rows.len(), 8, |i, j| rows[i].covariates[j]);
    let products = (x.transpose() * &x).cholesky().expect("commands that differ");
    let gains = |channel: usize, scatter: f64| -> Vec<f64> {
        let y = DVector::from_fn(rows.len(), |i, _| rows[i].residuals[channel]);
        let shifts = &x * products.solve(&(x.transpose() * y));
        shifts.iter().map(|shift| expected_gain(shift / scatter)).collect()
    };
    let [forward, turn] = [gains(0, reference.scatter.forward), gains(1, reference.scatter.turn.to_degrees())];
    let mut sums = [(0.0, 0.0); RUN_STEPS];
    for (row, gain) in rows.iter().zip(forward.iter().zip(&turn).map(|(forward, turn)| forward + turn)) {
        sums[row.step].0 += gain;
        sums[row.step].1 += 1.0;
    }
    let mut gained = 0.0;
    let steps = sums.iter().cycle().take_while(|(sum, of)| {
        gained += sum / of;
        gained < ALLOWED_NATS
    });
    steps.count() as f64 + 1.0
}

/// A step of a run, by its number, with what its shift may depend on and its residuals: forward in cm, and turn in degrees.
struct Compared {
    step: usize,
    covariates: [f64; 8],
    residuals: [f64; 2],
}

fn residuals(replay: &Replay, simulator: &Simulator, run: &Run) -> Vec<Compared> {
    let reference = simulator.reference.as_ref().and_then(|reference| reference.motion.as_ref()).expect("a correction");
    let half_track_cm = 0.5 * simulator.robot.track_cm;
    let mut before = [0.0; 2];
    let steps = (0..run.rows.len() - 1).filter_map(|row| {
        let step = replay.step(run, row);
        let [forward, turn] = step.predicted.map(|p| p.to_num::<f64>());
        let wheels = [-half_track_cm, half_track_cm].map(|arm| forward + arm * turn.to_radians());
        let [left, right] = wheels;
        let changes = [left - before[0], right - before[1]];
        before = wheels;
        let sign = |x: f64| if x.abs() < 0.25 { 0.0 } else { x.signum() };
        let late = row as f64 / RUN_STEPS as f64;
        let measured =
            step.measured?.map(|m| m.to_num::<f64>() * simulator.robot.step_ms / f64::from(step.duration_ms));
        let correction = reference.correction(&step.commands.map(|c| c.to_num::<f64>())).turn_in_degrees();
        let residuals = [measured[0] - forward - correction.forward, measured[1] - turn - correction.turn];
        let covariates = [left, right, changes[0], changes[1], sign(left), sign(right), late * left, late * right];
        Some(Compared { step: row, covariates, residuals })
    });
    steps.collect()
}

/// Returns the expected log-likelihood ratio, in nats, for a shift in standard deviations: of Student's distribution with five degrees
/// of freedom.
fn expected_gain(shift: f64) -> f64 {
    const SCALE: f64 = 0.856_621;
    let log_density = |z: f64| -3.0 * libm::log(1.0 + z * z / (5.0 * SCALE * SCALE));
    let (sum, total) = (-100..=100).map(|tenths| f64::from(tenths) / 10.0).fold((0.0, 0.0), |(sum, total), z| {
        let density = libm::exp(log_density(z));
        (sum + density * (log_density(z) - log_density(z + shift)), total + density)
    });
    sum / total
}
