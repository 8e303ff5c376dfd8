//! Plausible steps: anything between rest and the commanded motion, with some margin.

use std::f64::consts::TAU;

use nalgebra::{Matrix3, Vector3};

use super::segments::{Displacement, Gains, LARGE, commanded, is_gap, segments, stride};
use crate::{Logs, Run};
use mindgap_foundations::geometry::wrap_rad;
use mindgap_foundations::statistics::summary::median;

/// Ages of commands that still act, ms: brick, radio link, camera and inertia together take less than a second.
const AGES_MS: [f64; 3] = [0.0, 400.0, 800.0];
/// A step may exceed the commanded one by this fraction of the log's fastest step, since real drives are not linear.
const NONLINEARITY: f64 = 0.4;
/// A step may also exceed the commanded one by this multiple of the median deviation, which is noise: ten cover any heavy
/// tail.
const NOISE: f64 = 10.0;
/// Minimum margin for turns, rad: a compass may be off by 20° in one place and by -20° in another.
const MIN_TURN_MARGIN_RAD: f64 = 0.7;
/// Iterations of reweighting, enough for three digits of the gains.
const ITERATIONS: usize = 20;

/// Bounds on plausible steps of given logs.
pub struct Tolerance {
    /// Gains of a step's length on the commands of [`AGES_MS`].
    pub forward: [f64; 3],
    /// Gains of a step's turn on the commands of [`AGES_MS`].
    pub turn: [f64; 3],
    /// Larger deviations from the expected length are jumps, cm.
    length_cm: f64,
    /// Larger deviations from the expected turn are jumps, rad.
    turn_rad: f64,
    /// The longest expected step, cm, and the largest expected turn, rad.
    pub fastest: Displacement,
}

impl Tolerance {
    /// Fits the bounds to logs, of which nearly half may be wrong; `None` if too little was driven.
    pub fn of(logs: &Logs) -> Option<Self> {
        Gains::of(&segments(logs), &logs.robot).length?;
        let mut steps: [Vec<([f64; 3], f64)>; 2] = [Vec::new(), Vec::new()];
        let mut lateral_cm = Vec::new();
        let stride = stride(logs.rows());
        for run in &logs.runs {
            for (k, pair) in run.rows.pairs().enumerate().step_by(stride) {
                let (Some(a), Some(b)) = (pair[0].pose, pair[1].pose) else { continue };
                if is_gap(&logs.robot, pair[0].t_ms, pair[1].t_ms) {
                    continue;
                }
                let by_age = commands_by_age(logs, run, k);
                let change = a.relative(&b);
                steps[0].push((by_age.map(|displacement| displacement.forward_cm), change.position_cm.x));
                steps[1].push((by_age.map(|displacement| displacement.turn_rad), change.heading_rad));
                lateral_cm.push(change.position_cm.y.abs());
            }
        }
        let [forward, turn] = [0, 1].map(|i| gains(&steps[i]));
        let fastest = |i: usize| {
            let gain = [forward, turn][i].iter().sum::<f64>().abs();
            gain * steps[i].iter().map(|(commanded, _)| commanded[0].abs()).fold(0.0, f64::max)
        };
        let fastest = Displacement { forward_cm: fastest(0), turn_rad: fastest(1) };
        let noise = |i: usize| {
            let deviation =
                |(commanded, observed): &([f64; 3], f64)| (observed - sum(&[forward, turn][i], commanded)).abs();
            NOISE * median(steps[i].iter().map(deviation))
        };
        Some(Tolerance {
            forward,
            turn,
            length_cm: NONLINEARITY * fastest.forward_cm + noise(0) + NOISE * median(lateral_cm.into_iter()),
            turn_rad: MIN_TURN_MARGIN_RAD.max(noise(1)),
            fastest,
        })
    }

    /// Returns the expected step from row `k`.
    pub fn expected(&self, logs: &Logs, run: &Run, k: usize) -> Displacement {
        let by_age = commands_by_age(logs, run, k);
        Displacement {
            forward_cm: sum(&self.forward, &by_age.map(|displacement| displacement.forward_cm)),
            turn_rad: sum(&self.turn, &by_age.map(|displacement| displacement.turn_rad)),
        }
    }

    /// Returns the sum of the expected steps between two rows; `None` if rows or poses are missing between them, since steps over
    /// gaps are not compared.
    pub fn expected_between(&self, logs: &Logs, run: &Run, from: usize, to: usize) -> Option<Displacement> {
        let mut total = Displacement::default();
        for k in from..to {
            let is_unseen = k > from && run.rows.at(k).pose.is_none();
            if is_unseen || is_gap(&logs.robot, run.rows.at(k).t_ms, run.rows.at(k + 1).t_ms) {
                return None;
            }
            total = total.and(&self.expected(logs, run, k));
        }
        Some(total)
    }

    /// Returns whether a turn is plausible given the expected one.
    pub fn admits_turn(&self, turn_rad: f64, expected: &Displacement) -> bool {
        let turns = [-TAU, 0.0, TAU].map(|whole| wrap_rad(turn_rad) + whole);
        turns.into_iter().any(|turn_rad| excess(turn_rad, expected.turn_rad) <= self.turn_rad)
    }

    /// Returns whether the robot can turn this far in a step, whatever the command.
    pub fn is_within_reach(&self, turn_rad: f64) -> bool {
        wrap_rad(turn_rad).abs() <= self.fastest.turn_rad + self.turn_rad
    }

    /// Returns whether a displacement, forward and to the left of the mean heading, cm, is plausible given the expected one.
    pub fn admits_length(&self, [forward_cm, left_cm]: [f64; 2], expected: &Displacement) -> bool {
        libm::hypot(excess(forward_cm, expected.forward_cm), left_cm) <= self.length_cm
    }

    /// Returns whether a displacement is so large that the robot must have moved unless it was held.
    pub fn is_large(&self, displacement: &Displacement) -> bool {
        let Displacement { forward_cm, turn_rad } = self.fastest;
        displacement.forward_cm.abs() > LARGE * forward_cm || displacement.turn_rad.abs() > LARGE * turn_rad
    }
}

/// Returns how far a number lies outside the range from zero (a robot may be held) to the expected value.
fn excess(value: f64, expected: f64) -> f64 {
    (expected.min(0.0) - value).max(value - expected.max(0.0)).max(0.0)
}

/// Returns the displacements in the step from row `k` that the commands of [`AGES_MS`] would cause.
fn commands_by_age(logs: &Logs, run: &Run, k: usize) -> [Displacement; 3] {
    let ms = run.rows.get(k + 1).map_or(0.0, |next| next.t_ms - run.rows.at(k).t_ms);
    let mut row = k;
    let mut has_started = true;
    AGES_MS.map(|age_ms| {
        // Half a step of jitter does not change the age of a command.
        while has_started && run.rows.at(k).t_ms - run.rows.at(row).t_ms < age_ms - logs.robot.step_ms / 2.0 {
            if row == 0 {
                has_started = false;
            } else {
                row -= 1;
            }
        }
        if has_started { commanded(&logs.robot, run.rows.at(row).command(), ms) } else { Displacement::default() }
    })
}

fn sum(gains: &[f64; 3], commanded: &[f64; 3]) -> f64 {
    gains.iter().zip(commanded).map(|(gain, commanded)| gain * commanded).sum()
}

/// Fits gains by least absolute deviations with iteratively reweighted least squares; zero for commands that never occur.
fn gains(steps: &[([f64; 3], f64)]) -> [f64; 3] {
    let scale = median(steps.iter().map(|(_, observed)| observed.abs()));
    // A small ridge keeps the equations solvable if the commands never change.
    let ridge =
        1e-3 * steps.iter().flat_map(|(commanded, _)| commanded).map(|a| a * a).sum::<f64>().max(f64::MIN_POSITIVE);
    let mut gains = [0.0; 3];
    for _ in 0..ITERATIONS {
        let mut squares = Matrix3::from_diagonal_element(ridge);
        let mut products = Vector3::zeros();
        for (commanded, observed) in steps {
            // Deviations are floored at a hundredth of a typical step.
            let weight = scale / (observed - sum(&gains, commanded)).abs().max(0.01 * scale).max(f64::MIN_POSITIVE);
            let commanded = Vector3::from(*commanded);
            squares += commanded * commanded.transpose() * weight;
            products += commanded * (*observed * weight);
        }
        match squares.cholesky() {
            Some(decomposed) => gains = decomposed.solve(&products).into(),
            None => break,
        }
    }
    gains
}
