//! The motion networks' own misfit: what is added to their outputs, and how reality scatters about the sum.

use serde::{Deserialize, Serialize};

/// Corrections and scatter of forward (cm), lateral (cm) and turn (rad).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MotionReference {
    /// One weight a feature (see [`features`]), for each of the three outputs.
    pub weights: [Vec<f64>; 3],
    /// Standard deviations about the corrected outputs.
    pub scatter: [f64; 3],
}

/// Magnitudes of commands at which a correction may bend: friction holds back what is small.
const KNOTS: [f64; 3] = [0.1, 0.3, 0.6];
/// The same for the difference of right and left command.
const TURN_KNOTS: [f64; 5] = [0.03, 0.06, 0.12, 0.25, 0.5];

impl MotionReference {
    /// What is added to the networks' outputs for left, right, previous left and previous right command.
    pub fn correction(&self, speeds: &[f64; 4]) -> [f64; 3] {
        let features = features(speeds);
        [0, 1, 2].map(|c| self.weights[c].iter().zip(&features).map(|(w, f)| w * f).sum())
    }
}

/// All products of up to three commands, and bends where the magnitude of a command, or of the difference of right and
/// left one, passes a knot.
pub fn features(speeds: &[f64; 4]) -> Vec<f64> {
    let u = speeds.map(|s| s / 100.0);
    let mut features = Vec::with_capacity(85);
    features.push(1.0);
    for a in 0..4 {
        features.push(u[a]);
        for b in a..4 {
            features.push(u[a] * u[b]);
            for c in b..4 {
                features.push(u[a] * u[b] * u[c]);
            }
        }
    }
    let [left, right, left_before, right_before] = u;
    u.iter().for_each(|command| bend(&mut features, *command, &KNOTS));
    [right - left, right_before - left_before].iter().for_each(|turn| bend(&mut features, *turn, &TURN_KNOTS));
    features
}

fn bend(features: &mut Vec<f64>, x: f64, knots: &[f64]) {
    features.push(x.abs());
    for knot in knots {
        let beyond = (x.abs() - knot).max(0.0);
        features.extend([beyond, beyond * x.signum()]);
    }
}
