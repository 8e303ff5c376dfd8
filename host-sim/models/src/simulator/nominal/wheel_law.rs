//! How far commands turn the wheels, by their rotation counters: the drive of a simulator up to the rims.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::motion_bias::{FEATURES, features};
use crate::simulator::ensemble::CommandScale;

/// The law of both wheels.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct WheelLaw {
    /// The scale of the robot's commands.
    pub scale: CommandScale,
    /// For the left and the right wheel, one weight per feature of the commands, cm per step.
    pub weights: [Vec<f64>; 2],
    /// Standard deviations of the left and the right counter about it, cm per step.
    pub scatter_cm: [f64; 2],
}

impl WheelLaw {
    /// Returns how far the rims of the left and the right wheel turn in a step, cm, for the speeds now and before as they come
    /// out of the simulator's filter.
    pub fn wheels_cm(&self, now: [f64; 2], before: [f64; 2]) -> [f64; 2] {
        let features = features([now[0], now[1], before[0], before[1]], self.scale.share());
        self.weights.each_ref().map(|weights| weights.iter().zip(&features).map(|(w, f)| w * f).sum())
    }

    /// Returns whether its numbers are possible.
    pub fn is_sound(&self) -> bool {
        let is_law = |weights: &Vec<f64>| weights.len() == FEATURES && weights.iter().all(|w| w.is_finite());
        self.weights.iter().all(is_law) && self.scatter_cm.iter().all(|scatter| *scatter >= 0.0 && scatter.is_finite())
    }
}
