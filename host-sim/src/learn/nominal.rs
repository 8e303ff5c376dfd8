//! Learns what is normal beyond the networks: the yardstick of the gap.

use nalgebra::{DMatrix, DVector};

use super::{beam, familiar, place_bound, sensor_law};
use crate::logs::{Logs, samples};
use crate::simulator::Simulator;
use crate::simulator::nominal::NominalModel;
use crate::simulator::nominal::motion_bias::{FEATURES, MotionBias, features};
use crate::sonar::{FirstEchoLaw, SensorLaw};

/// Pulls the weights of the motion's correction towards zero, in squared features: commands are in hundreds, so that a
/// thousand samples of a product of three half-power commands weigh five thousand times as much.
const RIDGE: f64 = 0.003;
/// Fewer samples than this, about as many as there are features, tell nothing.
const FEWEST: usize = 100;

/// The reference of a simulator whose networks are trained, from its training logs; `first_echo` is the law of its sensor
/// with poses as logged.
pub fn learn(simulator: &Simulator, first_echo: Option<FirstEchoLaw>, logs: &Logs) -> NominalModel {
    let sonar = beam::learn(simulator.constant_reading, logs);
    let seed = simulator.origin.seed;
    let first_echo =
        first_echo.filter(|law| sonar.as_ref().is_some_and(|beam| sensor_law::is_first_echo(law, beam, logs, seed)));
    let law = first_echo.clone().map(SensorLaw::FirstEcho).or_else(|| sonar.clone().map(SensorLaw::Beam));
    let seen = law.as_ref().map(|law| place_bound::seen(law, logs)).unwrap_or_default();
    let familiar = law.as_ref().and_then(|law| familiar::learn(law, &seen, &logs.scene));
    let place_bound = place_bound::learn(&seen);
    NominalModel { motion: motion(simulator, logs), sonar, first_echo, place_bound, familiar }
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
