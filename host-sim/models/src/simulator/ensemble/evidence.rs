//! What logs say of a robot's motion.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::Held;
use super::basis::{Weights, weights, weights_in_training};
use super::command_scale::{CommandScale, Percent};
use super::noise::MotionNoise;

/// Commands as far apart as this, in percent of full speed, are one: finer than friction bends.
const CELL: f64 = 4.0;

/// What logs say of the motion under one command.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Evidence {
    /// Left and right command.
    pub command: [f32; 2],
    /// Logged minus what the networks say of the command when it is held, a step.
    pub bias: [f32; 3],
    /// Variance of that, from the robot's chance and the tracker's error.
    pub variance: [f32; 3],
    /// Whether the run was driven after training: the robot may have changed by then.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub after_training: bool,
}

impl Evidence {
    /// The motion that was logged: relative to what networks say, which is `held`, it would not be a robot's own.
    pub fn motion(&self, held: Held) -> [f64; 3] {
        let said = held.motion(self.command.map(f64::from));
        [0, 1, 2].map(|channel| f64::from(self.bias[channel]) + said[channel])
    }

    /// The nodes of the smooth process that it tells of.
    pub fn weights(&self, scale: CommandScale) -> Weights {
        let command = self.percent(scale);
        if self.after_training { weights(command) } else { weights_in_training(command) }
    }

    /// The variance of its motion about the smooth process.
    pub fn variance_about_process(&self, noise: &MotionNoise, held: Held, channel: usize) -> f64 {
        let command = self.command.map(f64::from);
        f64::from(self.variance[channel])
            + noise.nugget_variance(self.percent(held.scale()), held.motion(command), channel)
    }

    /// Its command.
    pub fn percent(&self, scale: CommandScale) -> Percent {
        scale.percent(self.command.map(f64::from))
    }

    /// What is left of it beside the mean of its [cell](by_cell), as squares of standard deviations.
    pub fn squares_about(&self, mean: &Evidence) -> f64 {
        let square = |channel: usize| {
            let off = f64::from(self.bias[channel] - mean.bias[channel]);
            off * off / f64::from(self.variance[channel])
        };
        (0..3).map(square).sum()
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
    let weighted = |channel: usize| {
        let (sum, weights) = together.iter().fold((0.0, 0.0), |(sum, weights), e| {
            let weight = 1.0 / f64::from(e.variance[channel]);
            (sum + weight * f64::from(e.bias[channel]), weights + weight)
        });
        (sum / weights, 1.0 / weights)
    };
    let bias = [0, 1, 2].map(weighted);
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
