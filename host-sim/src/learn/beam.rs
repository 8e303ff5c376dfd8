//! Fits the sonar model of a beam to logs: the most probable parameters.

use rayon::prelude::*;

use super::scatter;
use crate::geometry::{Pose, cast};
use crate::logs::Logs;
use crate::simulator::residuals::ConstantReading;
use crate::sonar::model::STRENGTHS;
use crate::sonar::{Perturbation, SonarModel, fan_at};
use crate::statistics::maximise::{Bounds, climb};

/// The beam of the sensor that made these logs, with the reading that it gives where there is nothing if that is known; none
/// where they hold too few readings.
pub fn learn(constant: Option<ConstantReading>, logs: &Logs) -> Option<SonarModel> {
    let sides = logs.scene.sides();
    let mount = &logs.robot.ultrasonic;
    let (mut echoes, mut distances) = (Vec::new(), Vec::new());
    for (sensor, echo_cm) in seen(logs) {
        if let (Some(echo), Some(hit)) = (echo_cm, cast(&sides, sensor.position_cm, sensor.direction())) {
            echoes.push(echo as f32);
            distances.push(hit.distance_cm as f32);
        }
    }
    if echoes.len() < FEWEST {
        return None;
    }
    let constant = constant.or_else(|| scatter::constant_reading(&echoes, &distances));
    let value_cm = constant.map_or(mount.min_cm, |c| f64::from(c.value_cm));
    Some(learn_from(&model(&START, value_cm, [mount.min_cm, mount.max_cm]), logs))
}

/// The beam of these logs, sought from another on.
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

/// Where the sensor was at every row, and what it read.
fn seen(logs: &Logs) -> Vec<(Pose, Option<f64>)> {
    let rows = logs.runs.iter().flat_map(|run| &run.rows);
    rows.filter_map(|row| Some((logs.robot.ultrasonic.pose_on(&row.pose?), row.echo_cm))).collect()
}

/// Fewer readings than this tell nothing of some twenty parameters.
const FEWEST: usize = 100;
/// Bounds of the model's numbers: strengths (log-odds, far beyond the ten that make a certainty), bias (20 cm, 30 %), the
/// logarithm of the scatter (0.2 to 20 cm), three probabilities (a sensor that errs more often is broken), the width of the
/// beam (4 to 50 degrees to either side), a fourth probability, and what a mirrored ray loses (log-odds: at six one in four hundred is left,
/// which is less than logs show).
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
/// Where the search begins: a beam that sees what is near and faces it.
const START: [f64; STRENGTHS + 12] = [
    3.0, -2.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, -1.0, -1.0, // strengths
    0.0, 0.0, 0.0, // bias
    0.5, 0.1, 0.1, // scatter
    0.01, 0.01, 0.01, // constant, short, lost
    1.0,  // width
    0.01, // constant where no echo comes back
    2.0,  // loss where a wall mirrors
];
/// The search ends after this many iterations, or when one gains less than half a nat, a sixth of what is strong evidence.
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

/// What [`model`] makes a model of.
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
    use super::*;

    #[test]
    fn a_search_begins_at_the_model_that_it_is_given() {
        let at: [f64; STRENGTHS + 12] = std::array::from_fn(|i| i as f64 + 0.5);
        let made_up = model(&at, 20.0, [4.0, 240.0]);
        assert_eq!(model(&numbers(&made_up), 20.0, [4.0, 240.0]), made_up);
    }
}
