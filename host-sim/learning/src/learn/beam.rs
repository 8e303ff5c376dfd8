//! Fits the sonar model of a beam to logs: the most probable parameters.

use std::collections::BTreeSet;

use rayon::prelude::*;

use mindgap_foundations::geometry::{Pose, cast};
use mindgap_foundations::statistics::maximise::{Bounds, climb};
use mindgap_foundations::statistics::student;
use mindgap_logs::Logs;
use mindgap_models::simulator::residuals::ConstantReading;
use mindgap_models::sonar::model::{CONSTANT_SCATTER_CM, STRENGTHS};
use mindgap_models::sonar::{Perturbation, SonarModel, fan_at};

/// Fits the beam of the sensor that made these logs. Its constant reading is `constant` if given, else one that makes the
/// logs likely. Returns `None` if they hold too few readings.
pub fn learn(constant: Option<ConstantReading>, logs: &Logs) -> Option<SonarModel> {
    let sides = logs.scene.sides();
    let mount = logs.robot.ultrasonic?;
    let meets_a_wall = |sensor: &Pose| cast(&sides, sensor.position_cm, sensor.direction()).is_some();
    let readings = seen(logs).iter().filter(|(sensor, echo_cm)| echo_cm.is_some() && meets_a_wall(sensor)).count();
    if readings < FEWEST {
        return None;
    }
    let value_cm = constant.map_or(mount.min_cm, |c| f64::from(c.value_cm));
    let found = learn_from(&model(&START, value_cm, mount.range_cm()), logs);
    let likely_cm = if constant.is_none() { likely_constant_cm(&found, logs) } else { None };
    Some(match likely_cm {
        Some(value_cm) => learn_from(&with_constant(&found, CONSTANT_AT_START, value_cm), logs),
        None => found,
    })
}

/// Fits a beam to logs, starting the search at another beam.
pub fn learn_from(start: &SonarModel, logs: &Logs) -> SonarModel {
    let sides = logs.scene.sides();
    let seen = seen(logs);
    let model = |at: &[f64]| model(at, start.constant[1], start.range_cm);
    let terms = |at: &[f64]| {
        let model = model(at);
        let term = |(sensor, echo): &(Pose, Option<f64>)| {
            let fan = fan_at(&sides, sensor, model.fan_width);
            model.outcomes(&fan, &Perturbation::NONE).log_likelihood(*echo)
        };
        seen.par_iter().map(term).collect()
    };
    model(&climb(&BOUNDS, &numbers(start), ROUNDS, ENOUGH, terms).at)
}

/// Returns the constant reading, in whole cm, that makes the logs most likely; `None` if it gains no more than the logarithm
/// of the number of candidate values. Small logs hold too few readings for
/// [`scatter::constant_reading`](super::scatter::constant_reading), which needs a peak among the readings that are far off.
fn likely_constant_cm(beam: &SonarModel, logs: &Logs) -> Option<f64> {
    let sides = logs.scene.sides();
    let outcomes = |sensor: &Pose| beam.outcomes(&fan_at(&sides, sensor, beam.fan_width), &Perturbation::NONE);
    let rows: Vec<(Option<f64>, f64)> = seen(logs)
        .par_iter()
        .map(|(sensor, echo_cm)| (*echo_cm, echo_cm.map_or(1.0, |cm| outcomes(sensor).density(cm))))
        .collect();
    let [low, high] = beam.range_cm.map(|cm| cm.ceil() as i64);
    let gain = |value_cm: f64| -> f64 {
        let density = |cm: f64| student::density(cm - value_cm, CONSTANT_SCATTER_CM);
        let gain = |(echo_cm, other): &(Option<f64>, f64)| {
            libm::log1p(CONSTANT_AT_START * (echo_cm.map_or(0.0, density) / other - 1.0))
        };
        rows.iter().map(gain).sum()
    };
    // Only values that were read are candidates, since the range may be absurdly long.
    let read = rows.iter().filter_map(|(echo_cm, _)| Some(echo_cm.as_ref()?.round() as i64));
    let read: BTreeSet<i64> = read.filter(|cm| (low..=high).contains(cm)).collect();
    let gains = read.into_iter().map(|cm| (cm as f64, gain(cm as f64)));
    let (value_cm, gained) = gains.max_by(|a, b| a.1.total_cmp(&b.1))?;
    (gained > libm::log((high - low + 1) as f64)).then_some(value_cm)
}

/// Returns the beam with a constant reading of this probability, in place of an echo and of none.
fn with_constant(beam: &SonarModel, probability: f64, value_cm: f64) -> SonarModel {
    SonarModel { constant: [probability, value_cm], p_constant_given_none: probability, ..beam.clone() }
}

/// Returns the sensor pose and the reading, cm, of every row with a pose.
fn seen(logs: &Logs) -> Vec<(Pose, Option<f64>)> {
    let rows = logs.runs.iter().flat_map(|run| &run.rows);
    rows.filter_map(|row| Some((logs.robot.sensor_pose(&row.pose?), row.echo_cm))).collect()
}

/// Minimum number of readings: fewer do not determine some twenty parameters.
const FEWEST: usize = 100;
/// Bounds of the model's numbers: strengths (log-odds, far beyond the ten that are a certainty), bias (20 cm, 30 %), the
/// logarithm of the scatter (0.2 to 20 cm), three probabilities (a sensor that errs more often is broken), the width of the
/// beam (4 to 50 degrees to either side), a fourth probability, and the loss of a mirrored ray (log-odds: six leaves
/// one in four hundred, less than logs show).
const BOUNDS: [Bounds; STRENGTHS + 12] = {
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
/// Start of the search: a beam that detects near surfaces that face it.
const START: [f64; STRENGTHS + 12] = [
    3.0, -2.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, -1.0, -1.0, // strengths
    0.0, 0.0, 0.0, // bias
    0.5, 0.1, 0.1, // scatter
    0.01, 0.01, 0.01, // constant, short, lost
    1.0,  // width
    0.01, // constant where no echo comes back
    2.0,  // loss where a wall mirrors
];
const CONSTANT_AT_START: f64 = START[STRENGTHS + 6];
/// The search ends after this many iterations, or when one gains less than half a nat, a sixth of strong evidence.
const ROUNDS: usize = 40;
const ENOUGH: f64 = 0.5;

fn model(at: &[f64], value_cm: f64, range_cm: [f64; 2]) -> SonarModel {
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

/// Returns the parameters of a model, the inverse of [`model`].
fn numbers(model: &SonarModel) -> [f64; STRENGTHS + 12] {
    let mut at = START;
    at[..STRENGTHS].copy_from_slice(&model.strength);
    at[STRENGTHS..STRENGTHS + 3].copy_from_slice(&model.bias);
    at[STRENGTHS + 3..STRENGTHS + 6].copy_from_slice(&model.log_scatter);
    at[STRENGTHS + 6] = model.constant[0];
    at[STRENGTHS + 7] = model.p_short;
    at[STRENGTHS + 8] = model.p_dropout;
    at[STRENGTHS + 9] = model.fan_width;
    at[STRENGTHS + 10] = model.p_constant_given_none;
    if let Some(mirror_loss) = model.mirror_loss {
        at[STRENGTHS + 11] = mirror_loss;
    }
    at
}

#[cfg(test)]
mod tests {
    use rand::RngExt;

    use super::*;
    use mindgap_built_in_robot::{default_robot, record, training_room};
    use mindgap_foundations::random::generator;

    /// Returns twelve runs of a sensor like the built-in robot's with this constant reading, and its beam without it.
    fn drawn(p_constant: f64, value_cm: f64) -> (SonarModel, Logs) {
        let mut logs = record(&default_robot(), &training_room(), 12, 40, &[], 1).expect("room to drive");
        let beam = with_constant(&learn(None, &logs).expect("readings"), 0.0, 4.0);
        let sensor = with_constant(&beam, p_constant, value_cm);
        let (sides, mut rng) = (logs.scene.sides(), generator(2, &[]));
        let robot = logs.robot;
        let read = |pose: &Pose| {
            sensor.outcomes(&fan_at(&sides, &robot.sensor_pose(pose), sensor.fan_width), &Perturbation::NONE)
        };
        for run in &mut logs.runs {
            run.rows.edit_each(|row| {
                if let Some(pose) = &row.pose {
                    row.echo_cm = read(pose).draw(true, || rng.random()).map(f64::round);
                }
            });
        }
        (beam, logs)
    }

    #[test]
    fn constant_reading_is_found_in_a_few_runs() {
        let (beam, logs) = drawn(0.025, 57.0);
        let near = |value_cm: f64| (value_cm - 57.0).abs() <= 1.0;
        assert!(likely_constant_cm(&beam, &logs).is_some_and(near));
        let [probability, value_cm] = learn(None, &logs).expect("readings").constant;
        assert!(near(value_cm) && (0.01..0.05).contains(&probability), "{probability} at {value_cm}");
        let (beam, logs) = drawn(0.0, 57.0);
        assert_eq!(likely_constant_cm(&beam, &logs), None);
    }

    #[test]
    fn search_starts_at_the_given_model() {
        let at: [f64; STRENGTHS + 12] = std::array::from_fn(|i| i as f64 + 0.5);
        let made_up = model(&at, 20.0, [4.0, 240.0]);
        assert_eq!(model(&numbers(&made_up), 20.0, [4.0, 240.0]), made_up);
    }
}
