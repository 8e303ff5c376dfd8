//! Noise of a robot beyond a smooth process over commands. The variance of a step grows with the squares of the distance
//! and of the turn (Thrun, Burgard and Fox 2005, Probabilistic Robotics, section 5.3).

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::command_scale::Percent;
use mindgap_foundations::motion::{Axis, Motion};

/// Number of terms of a step's variance: a constant, the square of the distance, and the square of the turn.
pub const TERMS: usize = 3;
/// Lower bound of variances, a resolution that no tracker has: nothing is ever certain.
const LEAST: f64 = 1e-6;
/// A wheel at less than this command, in percent of full speed, is slow: twice what [`basis`](super::basis) takes for its
/// breaking away.
const SLOW: f64 = 16.0;

/// Noise of the motion of a step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MotionNoise {
    /// Weights of the terms of a step's variance, which is drawn independently; motions are in cm and degrees.
    pub step: Motion<[f64; TERMS]>,
    /// Standard deviation of what a command does beyond the smooth process, the same in every run, as a share of a step's: of
    /// commands that drive both wheels, and of those that leave one slow.
    pub nugget: Motion<[f64; 2]>,
    /// Standard deviation of what the first step of a command does beyond later ones, the same whenever one command follows
    /// the other.
    pub first_step: Motion<f64>,
    /// Variance of the tracker's error in one pose, which no simulated robot has.
    pub tracker: Motion<f64>,
}

impl MotionNoise {
    /// Returns the variance of a step with this motion.
    pub fn step_variance(&self, motion: Motion<f64>, axis: Axis) -> f64 {
        weighed(&self.step[axis], &terms(motion)).max(LEAST)
    }

    /// Returns the variance beyond the smooth process of a command with this motion.
    pub fn nugget_variance(&self, command: Percent, motion: Motion<f64>, axis: Axis) -> f64 {
        let nugget = self.nugget[axis][usize::from(is_slow(command))];
        nugget * nugget * self.step_variance(motion, axis)
    }

    /// Returns the variance of the mean of `steps` steps of a held command, as they are tracked.
    pub fn mean_variance(&self, motion: Motion<f64>, axis: Axis, steps: usize) -> f64 {
        let steps = steps as f64;
        let own = self.step_variance(motion, axis) + self.misheading_variance(motion, axis);
        own / steps + 2.0 * self.tracker[axis] / (steps * steps)
    }

    /// Returns the variance that the tracker's heading error adds to a step: it takes forward motion for lateral.
    pub fn misheading_variance(&self, motion: Motion<f64>, axis: Axis) -> f64 {
        let way_cm = if axis == Axis::Lateral { motion.forward } else { 0.0 };
        way_cm * way_cm * self.tracker.turn * 1f64.to_radians() * 1f64.to_radians()
    }

    /// Returns whether all numbers are possible.
    pub fn is_sound(&self) -> bool {
        let all = self
            .step
            .iter()
            .flatten()
            .chain(self.nugget.iter().flatten())
            .chain(self.first_step.iter())
            .chain(self.tracker.iter());
        all.copied().all(|value| value.is_finite() && value >= 0.0)
    }
}

/// Returns whether friction dominates a wheel at this command, which no smooth process models: whether it moves depends on the
/// other wheel.
pub fn is_slow(Percent(command): Percent) -> bool {
    command.iter().any(|c| c.abs() < SLOW)
}

/// Returns the terms of a step's variance.
pub fn terms(motion: Motion<f64>) -> [f64; TERMS] {
    [1.0, motion.forward * motion.forward, motion.turn * motion.turn]
}

/// Returns the weighted sum of terms.
pub fn weighed(weights: &[f64; TERMS], terms: &[f64; TERMS]) -> f64 {
    (0..TERMS).map(|term| weights[term] * terms[term]).sum()
}
