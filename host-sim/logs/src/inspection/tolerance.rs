//! What a step may do: anything between standing still and what the commands ask for, and somewhat more.

use std::f64::consts::TAU;

use nalgebra::{Matrix3, Vector3};

use super::ways::{Drive, Gains, LARGE, asked, is_broken, one_in, ways};
use crate::{Logs, Run};
use mindgap_foundations::geometry::wrap_rad;
use mindgap_foundations::statistics::summary::median;

/// Commands that are this old still act, ms: brick, link, camera and inertia together take no second.
const AGES_MS: [f64; 3] = [0.0, 400.0, 800.0];
/// A step may exceed what is asked for by this share of the log's fastest step: the drive of a real robot is not linear,
const BEYOND: f64 = 0.4;
/// and by so many times the median deviation, which is noise: ten are beyond any heavy tail.
const NOISE: f64 = 10.0;
/// A turn may exceed what is asked for by at least this, rad: a compass that is off by 20° here and by -20° there.
const LEAST_TURN_RAD: f64 = 0.7;
/// Rounds of reweighting, after which gains stand to three digits.
const ROUNDS: usize = 20;

/// What steps of given logs may do.
pub struct Tolerance {
    /// How much of what commands of [`AGES_MS`] ask for a step covers, forward
    pub forward: [f64; 3],
    /// and in turns.
    pub turn: [f64; 3],
    /// Farther than expected by more than this is a jump, cm.
    length_cm: f64,
    /// More than expected by more than this is a jump, rad.
    turn_rad: f64,
    /// The longest step that is asked for, cm, and the largest turn, rad.
    pub fastest: Drive,
}

impl Tolerance {
    /// Learned from logs, of which nearly half may be wrong; none where too little was driven to tell.
    pub fn of(logs: &Logs) -> Option<Self> {
        Gains::of(&ways(logs), &logs.robot).length?;
        let mut steps: [Vec<([f64; 3], f64)>; 2] = [Vec::new(), Vec::new()];
        let mut aside_cm = Vec::new();
        let one_in = one_in(logs.rows());
        for run in &logs.runs {
            for (k, pair) in run.rows.pairs().enumerate().step_by(one_in) {
                let (Some(a), Some(b)) = (pair[0].pose, pair[1].pose) else { continue };
                if is_broken(&logs.robot, pair[0].t_ms, pair[1].t_ms) {
                    continue;
                }
                let of_age = of_ages(logs, run, k);
                let change = a.relative(&b);
                steps[0].push((of_age.map(|drive| drive.forward_cm), change.position_cm.x));
                steps[1].push((of_age.map(|drive| drive.turn_rad), change.heading_rad));
                aside_cm.push(change.position_cm.y.abs());
            }
        }
        let [forward, turn] = [0, 1].map(|i| gains(&steps[i]));
        let fastest = |i: usize| {
            let gain = [forward, turn][i].iter().sum::<f64>().abs();
            gain * steps[i].iter().map(|(asked, _)| asked[0].abs()).fold(0.0, f64::max)
        };
        let fastest = Drive { forward_cm: fastest(0), turn_rad: fastest(1) };
        let noise = |i: usize| {
            let deviation = |(asked, done): &([f64; 3], f64)| (done - sum(&[forward, turn][i], asked)).abs();
            NOISE * median(steps[i].iter().map(deviation))
        };
        Some(Tolerance {
            forward,
            turn,
            length_cm: BEYOND * fastest.forward_cm + noise(0) + NOISE * median(aside_cm.into_iter()),
            turn_rad: LEAST_TURN_RAD.max(noise(1)),
            fastest,
        })
    }

    /// What the step from row `k` comes to.
    pub fn expected(&self, logs: &Logs, run: &Run, k: usize) -> Drive {
        let of_age = of_ages(logs, run, k);
        Drive {
            forward_cm: sum(&self.forward, &of_age.map(|drive| drive.forward_cm)),
            turn_rad: sum(&self.turn, &of_age.map(|drive| drive.turn_rad)),
        }
    }

    /// What the steps between two rows come to together; none where rows or poses are missing between them, over which no
    /// step is compared.
    pub fn expected_between(&self, logs: &Logs, run: &Run, from: usize, to: usize) -> Option<Drive> {
        let mut all = Drive::default();
        for k in from..to {
            let is_unseen = k > from && run.rows.at(k).pose.is_none();
            if is_unseen || is_broken(&logs.robot, run.rows.at(k).t_ms, run.rows.at(k + 1).t_ms) {
                return None;
            }
            all = all.and(&self.expected(logs, run, k));
        }
        Some(all)
    }

    /// Whether a turn is no jump where so much is expected.
    pub fn admits_turn(&self, turn_rad: f64, expected: &Drive) -> bool {
        let turns = [-TAU, 0.0, TAU].map(|whole| wrap_rad(turn_rad) + whole);
        turns.into_iter().any(|turn_rad| excess(turn_rad, expected.turn_rad) <= self.turn_rad)
    }

    /// Whether the robot can turn so far in a step, whatever it is asked for.
    pub fn is_within_reach(&self, turn_rad: f64) -> bool {
        wrap_rad(turn_rad).abs() <= self.fastest.turn_rad + self.turn_rad
    }

    /// Whether a way is no jump where so much is expected: forward and to the left of the heading halfway, cm.
    pub fn admits_way(&self, [forward_cm, left_cm]: [f64; 2], expected: &Drive) -> bool {
        libm::hypot(excess(forward_cm, expected.forward_cm), left_cm) <= self.length_cm
    }

    /// Whether a drive is large enough that a robot cannot fail to make it without being held.
    pub fn is_large(&self, drive: &Drive) -> bool {
        let Drive { forward_cm, turn_rad } = self.fastest;
        drive.forward_cm.abs() > LARGE * forward_cm || drive.turn_rad.abs() > LARGE * turn_rad
    }
}

/// How far a number lies beyond everything from zero, as a robot may be held, to what is expected.
fn excess(value: f64, expected: f64) -> f64 {
    (expected.min(0.0) - value).max(value - expected.max(0.0)).max(0.0)
}

/// What the commands of [`AGES_MS`] ask for in the step from row `k`.
fn of_ages(logs: &Logs, run: &Run, k: usize) -> [Drive; 3] {
    let ms = run.rows.get(k + 1).map_or(0.0, |next| next.t_ms - run.rows.at(k).t_ms);
    let mut row = k;
    let mut begun = true;
    AGES_MS.map(|age_ms| {
        // Half a step of jitter does not make a command another one's age.
        while begun && run.rows.at(k).t_ms - run.rows.at(row).t_ms < age_ms - logs.robot.step_ms / 2.0 {
            if row == 0 {
                begun = false;
            } else {
                row -= 1;
            }
        }
        if begun { asked(&logs.robot, run.rows.at(row).command(), ms) } else { Drive::default() }
    })
}

fn sum(gains: &[f64; 3], asked: &[f64; 3]) -> f64 {
    gains.iter().zip(asked).map(|(gain, asked)| gain * asked).sum()
}

/// The gains of least absolute deviations, by weighted least squares; of what is never asked for, none.
fn gains(steps: &[([f64; 3], f64)]) -> [f64; 3] {
    let scale = median(steps.iter().map(|(_, done)| done.abs()));
    // A ridge that counts as a thousandth of a step keeps commands that never change from being told apart.
    let ridge = 1e-3 * steps.iter().flat_map(|(asked, _)| asked).map(|a| a * a).sum::<f64>().max(f64::MIN_POSITIVE);
    let mut gains = [0.0; 3];
    for _ in 0..ROUNDS {
        let mut squares = Matrix3::from_diagonal_element(ridge);
        let mut products = Vector3::zeros();
        for (asked, done) in steps {
            // Deviations below a hundredth of a usual step count as that.
            let weight = scale / (done - sum(&gains, asked)).abs().max(0.01 * scale).max(f64::MIN_POSITIVE);
            let asked = Vector3::from(*asked);
            squares += asked * asked.transpose() * weight;
            products += asked * (*done * weight);
        }
        match squares.cholesky() {
            Some(decomposed) => gains = decomposed.solve(&products).into(),
            None => break,
        }
    }
    gains
}
