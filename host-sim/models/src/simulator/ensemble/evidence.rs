//! The evidence of logs about a robot's motion.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Held;
use super::basis::{Weights, weights, weights_in_training};
use super::command_scale::{CommandScale, Percent};
use super::noise::MotionNoise;
use mindgap_foundations::motion::{Axis, Motion};

/// Commands as far apart as this, in percent of full speed, are one: finer than friction bends.
const CELL: f64 = 4.0;

/// The evidence about the motion under one command.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Evidence {
    /// Left and right command.
    pub command: [f32; 2],
    /// Logged minus predicted motion per step, where the command is held.
    pub bias: Motion<f32>,
    /// Variance of that, from process noise and the tracker's error.
    pub variance: Motion<f32>,
    /// Whether the run was driven after training: the robot may have changed by then.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub after_training: bool,
}

impl Evidence {
    /// Returns the logged motion, which unlike the bias does not depend on the networks' prediction, `held`.
    pub fn motion(&self, held: Held) -> Motion<f64> {
        self.bias.map(f64::from) + held.motion(self.command.map(f64::from))
    }

    /// Returns the weights of the smooth process's nodes.
    pub fn weights(&self, scale: CommandScale) -> Weights {
        let command = self.percent(scale);
        if self.after_training { weights(command) } else { weights_in_training(command) }
    }

    /// Returns the variance of its motion about the smooth process.
    pub fn variance_about_process(&self, noise: &MotionNoise, held: Held, axis: Axis) -> f64 {
        let command = self.command.map(f64::from);
        f64::from(self.variance[axis]) + noise.nugget_variance(self.percent(held.scale()), held.motion(command), axis)
    }

    /// Its command.
    pub fn percent(&self, scale: CommandScale) -> Percent {
        scale.percent(self.command.map(f64::from))
    }

    /// Returns its squared deviation from the mean of its [cell](by_cell), in units of its variance.
    pub fn squares_about(&self, mean: &Evidence) -> f64 {
        let square = |(off, variance): (f32, f32)| f64::from(off) * f64::from(off) / f64::from(variance);
        (self.bias - mean.bias).into_iter().zip(self.variance).map(square).sum()
    }
}

/// The cell of a command: all of one are taken for the same command.
pub fn cell(Percent(command): Percent) -> [i32; 2] {
    command.map(|c| (c / CELL).round() as i32)
}

/// Evidence of one cell as one, that of the training logs apart and before what came after.
pub fn by_cell(evidence: impl IntoIterator<Item = Evidence>, scale: CommandScale) -> Vec<Evidence> {
    cells(evidence, scale).iter().map(|together| one(together)).collect()
}

/// The cells of evidence, in the order of [`by_cell`].
pub fn cells(evidence: impl IntoIterator<Item = Evidence>, scale: CommandScale) -> Vec<Vec<Evidence>> {
    let mut cells: BTreeMap<(bool, [i32; 2]), Vec<Evidence>> = BTreeMap::new();
    for e in evidence {
        cells.entry((e.after_training, cell(e.percent(scale)))).or_default().push(e);
    }
    cells.into_values().collect()
}

/// The mean of evidence of one cell.
pub fn one(together: &[Evidence]) -> Evidence {
    let weighted = |axis: Axis| {
        let (sum, weights) = together.iter().fold((0.0, 0.0), |(sum, weights), e| {
            let weight = 1.0 / f64::from(e.variance[axis]);
            (sum + weight * f64::from(e.bias[axis]), weights + weight)
        });
        (sum / weights, 1.0 / weights)
    };
    let bias = Motion::from_fn(weighted);
    Evidence {
        command: [0, 1].map(|side| {
            let sum: f32 = together.iter().map(|e| e.command[side]).sum();
            sum / together.len() as f32
        }),
        bias: bias.map(|(mean, _)| mean as f32),
        variance: bias.map(|(_, variance)| variance as f32),
        after_training: together.iter().any(|e| e.after_training),
    }
}
