//! What moves a robot beyond what a smooth process over commands says. The variance of a step grows with the squares of the
//! way and of the turn (Thrun, Burgard and Fox 2005, Probabilistic Robotics, section 5.3).

use serde::{Deserialize, Serialize};

use super::command_scale::Percent;
use mindgap_foundations::motion::{Axis, Motion};

/// What a step's variance is a weighted sum of: a constant, the square of the way, and the square of the turn.
pub const TERMS: usize = 3;
/// Variances are at least this, of a resolution that no tracker has: nothing is ever certain.
const LEAST: f64 = 1e-6;
/// A wheel at less than this command, in percent of full speed, is slow: twice what [`basis`](super::basis) takes for its
/// breaking away.
const SLOW: f64 = 16.0;

/// Noise of the motion of a step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MotionNoise {
    /// Weights of the terms of a step's variance, which is drawn anew in each; motions are in cm and degrees.
    pub step: Motion<[f64; TERMS]>,
    /// Standard deviation of what a command does beyond the smooth process, the same in every run, as a share of a step's: of
    /// commands that drive both wheels, and of those that leave one [slow](is_slow).
    pub nugget: Motion<[f64; 2]>,
    /// Standard deviation of what the first step of a command does beyond later ones, the same whenever one command follows
    /// the other.
    pub first_step: Motion<f64>,
    /// Variance of the tracker's error in one pose, which no simulated robot has.
    pub tracker: Motion<f64>,
}

impl MotionNoise {
    /// The variance of what a robot adds in a step that moves it so.
    pub fn step_variance(&self, motion: Motion<f64>, axis: Axis) -> f64 {
        weighed(&self.step[axis], &terms(motion)).max(LEAST)
    }

    /// The variance of what a command that moves it so does beyond the smooth process.
    pub fn nugget_variance(&self, command: Percent, motion: Motion<f64>, axis: Axis) -> f64 {
        let nugget = self.nugget[axis][usize::from(is_slow(command))];
        nugget * nugget * self.step_variance(motion, axis)
    }

    /// The variance of the mean of so many steps of a command that is held, as it is tracked.
    pub fn mean_variance(&self, motion: Motion<f64>, axis: Axis, steps: usize) -> f64 {
        let steps = steps as f64;
        let own = self.step_variance(motion, axis) + self.aslant_variance(motion, axis);
        own / steps + 2.0 * self.tracker[axis] / (steps * steps)
    }

    /// The variance that the tracker's error in heading adds to a step: what it takes for lateral is way.
    pub fn aslant_variance(&self, motion: Motion<f64>, axis: Axis) -> f64 {
        let way_cm = if axis == Axis::Lateral { motion.forward } else { 0.0 };
        way_cm * way_cm * self.tracker.turn * 1f64.to_radians() * 1f64.to_radians()
    }

    /// Whether a file could have held this.
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

/// Whether a command leaves a wheel to friction, which no smooth process knows: whether that moves depends on the other one.
pub fn is_slow(Percent(command): Percent) -> bool {
    command.iter().any(|c| c.abs() < SLOW)
}

/// What a step's variance is a sum of.
pub fn terms(motion: Motion<f64>) -> [f64; TERMS] {
    [1.0, motion.forward * motion.forward, motion.turn * motion.turn]
}

/// The sum of terms by their weights.
pub fn weighed(weights: &[f64; TERMS], terms: &[f64; TERMS]) -> f64 {
    (0..TERMS).map(|term| weights[term] * terms[term]).sum()
}
