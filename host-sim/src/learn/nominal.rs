//! Learns what is normal beyond the networks: the yardstick of the gap.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use crate::geometry::{Pose, cast};
use crate::learn::scans::{Heard, Scans, UNCHANGED};
use crate::learn::{familiar, place_bound, scatter};
use crate::logs::{Logs, samples};
use crate::simulator::Simulator;
use crate::simulator::nominal::NominalModel;
use crate::simulator::nominal::motion_bias::{FEATURES, MotionBias, features};
use crate::sonar::echo_law::Surfaces;
use crate::sonar::model::STRENGTHS;
use crate::sonar::{Perturbation, SensorLaw, SonarModel, fan_at};
use crate::statistics::maximise::{Bounds, climb};
use crate::statistics::summary::mean;

/// Pulls the weights of the motion's correction towards zero, in squared features: commands are in hundreds, so that a
/// thousand samples of a product of three half-power commands weigh five thousand times as much.
const RIDGE: f64 = 0.003;
/// Fewer samples than this, about as many as there are features, tell nothing.
const FEWEST: usize = 100;

/// The reference of a simulator whose networks are trained, from its training logs.
pub fn learn(simulator: &Simulator, logs: &Logs) -> NominalModel {
    let sonar = sonar(simulator, logs);
    let beam = sonar.clone().map(SensorLaw::Beam);
    let first_echo = simulator.first_echo.clone().map(SensorLaw::FirstEcho);
    let is_first_echo = match (&beam, &first_echo) {
        (Some(beam), Some(first_echo)) => is_likelier(first_echo, beam, logs),
        _ => false,
    };
    let law = if is_first_echo { first_echo } else { beam };
    let seen = law.as_ref().map(|law| place_bound::seen(law, logs)).unwrap_or_default();
    let familiar = law.as_ref().and_then(|law| familiar::learn(law, &seen, &logs.scene));
    let place_bound = place_bound::learn(&seen);
    NominalModel { motion: motion(simulator, logs), sonar, is_first_echo, place_bound, familiar }
}

/// Where runs differ by more than a third of what a law gains, its gain may be that of a few places.
const STANDARD_ERRORS: f64 = 3.0;

/// Whether a law makes the readings of logs more probable than another with as many parameters, by more than their runs differ
/// in that.
fn is_likelier(law: &SensorLaw, other: &SensorLaw, logs: &Logs) -> bool {
    let scans = Scans::of(logs);
    let surfaces = Surfaces::new(logs.scene.sides());
    let term = |row: &Heard| {
        let sensor = scans.sensor(&row.robot, &UNCHANGED);
        let [law, other] = [law, other].map(|law| law.outcomes_at(&surfaces, &sensor).log_likelihood(row.echo_cm));
        law - other
    };
    let gains: Vec<f64> = scans.runs.par_iter().map(|run| run.iter().map(term).sum()).collect();
    let gained: f64 = gains.iter().sum();
    let middle = mean(gains.iter().copied());
    let error = (gains.iter().map(|gain| (gain - middle) * (gain - middle)).sum::<f64>()).sqrt();
    log::info!("the first-echo law gains {gained:.1} nats on the beam, with a standard error of {error:.1}");
    gained > STANDARD_ERRORS * error
}

fn motion(simulator: &Simulator, logs: &Logs) -> Option<MotionBias> {
    let networks = simulator.motion_networks()?;
    let steps = samples::motion(logs);
    if steps.len() < FEWEST {
        return None;
    }
    let rows: Vec<[f64; FEATURES]> = steps.iter().map(|s| features(s.speeds)).collect();
    let width = FEATURES;
    let mut normal = DMatrix::from_diagonal_element(width, width, RIDGE);
    for row in &rows {
        for a in 0..width {
            for b in 0..width {
                normal[(a, b)] += row[a] * row[b];
            }
        }
    }
    let normal = normal.cholesky()?;
    let residuals: Vec<[f64; 3]> = steps
        .iter()
        .map(|s| {
            let m = networks.step(s.speeds.map(|v| v as f32));
            let predicted = [m.forward_cm, m.lateral_cm, m.turn_rad].map(f64::from);
            [s.forward_cm - predicted[0], s.lateral_cm - predicted[1], s.turn_rad - predicted[2]]
        })
        .collect();
    let mut reference = MotionBias { weights: [const { Vec::new() }; 3], scatter: [0.0; 3] };
    for c in 0..3 {
        let mut pull = DVector::zeros(width);
        for (row, r) in rows.iter().zip(&residuals) {
            row.iter().enumerate().for_each(|(i, f)| pull[i] += f * r[c]);
        }
        reference.weights[c] = normal.solve(&pull).iter().copied().collect();
        let left: f64 =
            steps.iter().zip(&residuals).map(|(s, r)| r[c] - reference.correction(&s.speeds)[c]).map(|r| r * r).sum();
        reference.scatter[c] = (left / (steps.len() - width).max(1) as f64).sqrt();
    }
    Some(reference)
}

/// Bounds of the sonar's numbers: strengths (log-odds, far beyond the ten that make a certainty), bias (20 cm, 30 %), the
/// logarithm of the scatter (0.2 to 20 cm), three probabilities (a sensor that errs more often is broken), the width of the
/// beam (4 to 50 degrees to either side), a fourth probability, and what a mirrored ray loses (log-odds: at six one in four hundred is left,
/// which is less than logs show).
const SONAR_BOUNDS: [Bounds; STRENGTHS + 12] = {
    let mut bounds = [Bounds::new(-60.0, 60.0); STRENGTHS + 12];
    bounds[STRENGTHS] = Bounds::new(-20.0, 20.0);
    bounds[STRENGTHS + 1] = Bounds::new(-0.3, 0.3);
    bounds[STRENGTHS + 2] = Bounds::new(-10.0, 10.0);
    bounds[STRENGTHS + 3] = Bounds::new(-1.5, 3.0);
    bounds[STRENGTHS + 4] = Bounds::new(-1.0, 1.5);
    bounds[STRENGTHS + 5] = Bounds::new(-1.0, 1.5);
    bounds[STRENGTHS + 6] = Bounds::new(0.0, 0.3);
    bounds[STRENGTHS + 7] = Bounds::new(0.0, 0.3);
    bounds[STRENGTHS + 8] = Bounds::new(0.0, 0.3);
    bounds[STRENGTHS + 9] = Bounds::new(0.2, 2.5);
    bounds[STRENGTHS + 10] = Bounds::new(0.0, 0.3);
    bounds[STRENGTHS + 11] = Bounds::new(-3.0, 6.0);
    bounds
};
/// Where the search begins: a beam that sees what is near and faces it.
const SONAR_START: [f64; STRENGTHS + 12] = [
    3.0, -2.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, -1.0, -1.0, // strengths
    0.0, 0.0, 0.0, // bias
    0.5, 0.1, 0.1, // scatter
    0.01, 0.01, 0.01, // constant, short, lost
    1.0,  // width
    0.01, // constant where no echo comes back
    2.0,  // loss where a wall mirrors
];
/// The search ends after this many iterations, or when one gains less than half a nat, a sixth of what is strong evidence.
const SONAR_ROUNDS: usize = 40;
const SONAR_ENOUGH: f64 = 0.5;

fn sonar(simulator: &Simulator, logs: &Logs) -> Option<SonarModel> {
    let sides = logs.scene.sides();
    let mount = &logs.robot.ultrasonic;
    let mut seen: Vec<(Pose, Option<f64>)> = Vec::new();
    let (mut echoes, mut distances) = (Vec::new(), Vec::new());
    for row in logs.runs.iter().flat_map(|run| &run.rows) {
        let Some(pose) = row.pose else { continue };
        let sensor = mount.pose_on(&pose);
        seen.push((sensor, row.echo_cm));
        if let (Some(echo), Some(hit)) = (row.echo_cm, cast(&sides, sensor.position_cm, sensor.direction())) {
            echoes.push(echo as f32);
            distances.push(hit.distance_cm as f32);
        }
    }
    if echoes.len() < FEWEST {
        return None;
    }
    let constant = simulator.constant_reading.or_else(|| scatter::constant_reading(&echoes, &distances));
    let value_cm = constant.map_or(mount.min_cm, |c| f64::from(c.value_cm));
    let range_cm = [mount.min_cm, mount.max_cm];
    let terms = |at: &[f64]| {
        let reference = sonar_from(at, value_cm, range_cm);
        let term = |(sensor, echo): &(Pose, Option<f64>)| {
            let fan = fan_at(&sides, sensor, reference.fan_width);
            reference.outcomes(&fan, &Perturbation::NONE).log_likelihood(*echo)
        };
        seen.par_iter().map(term).collect()
    };
    let best = climb(&SONAR_BOUNDS, &SONAR_START, SONAR_ROUNDS, SONAR_ENOUGH, terms);
    Some(sonar_from(&best.at, value_cm, range_cm))
}

fn sonar_from(at: &[f64], value_cm: f64, range_cm: [f64; 2]) -> SonarModel {
    let rest = &at[STRENGTHS..];
    SonarModel {
        strength: std::array::from_fn(|i| at[i]),
        bias: [rest[0], rest[1], rest[2]],
        log_scatter: [rest[3], rest[4], rest[5]],
        constant: [rest[6], value_cm],
        p_short: rest[7],
        p_dropout: rest[8],
        fan_width: rest[9],
        p_constant_given_none: rest[10],
        mirror_loss: Some(rest[11]),
        range_cm,
    }
}

#[cfg(test)]
mod tests {
    use crate::built_in_robot::{default_robot, record, training_room};
    use crate::learn::echo_law::tests::{MIXED_UP_DEG, scans};
    use crate::learn::train::{TABLE_ONE, Trainer, train};
    use crate::logs::Logs;
    use crate::sonar::SensorLaw;

    fn law_of(logs: &Logs) -> SensorLaw {
        let simulator = train(logs, &Trainer::Fast, &TABLE_ONE, 1, &|_| {}).expect("networks");
        simulator.sensor_law().expect("enough readings")
    }

    /// The built-in robot's sensor follows neither, so that the beam, which lanes of robots can draw, is as good.
    #[test]
    fn a_sensor_is_judged_by_the_law_that_it_follows() {
        assert!(matches!(law_of(&scans(1, MIXED_UP_DEG)), SensorLaw::FirstEcho(_)));
        let driven = record(&default_robot(), &training_room(), 40, 60, &[], 3).expect("room to drive");
        assert!(matches!(law_of(&driven), SensorLaw::Beam(_)));
    }
}
