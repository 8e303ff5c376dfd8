//! What moves a robot beyond what a smooth process over commands says. The variance of a step grows with the squares of the
//! way and of the turn (Thrun, Burgard and Fox 2005, Probabilistic Robotics, section 5.3).

use serde::{Deserialize, Serialize};

use super::command_scale::Percent;

/// Channel of the way forward, cm.
pub const FORWARD: usize = 0;
/// Channel of the way to the left, cm.
pub const LATERAL: usize = 1;
/// Channel of the turn, degrees.
pub const TURN: usize = 2;
/// What a step's variance is a weighted sum of: a constant, the square of the way, and the square of the turn.
pub const TERMS: usize = 3;
/// Variances are at least this, of a resolution that no tracker has: nothing is ever certain.
const LEAST: f64 = 1e-6;
/// A wheel at less than this command, in percent of full speed, is slow: twice what [`basis`](super::basis) takes for its
/// breaking away.
const SLOW: f64 = 16.0;

/// Noise of forward (cm), lateral (cm) and turn (degrees).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MotionNoise {
    /// Weights of the terms of a step's variance, which is drawn anew in each; motions are in cm and degrees.
    pub step: [[f64; TERMS]; 3],
    /// Standard deviation of what a command does beyond the smooth process, the same in every run, as a share of a step's: of
    /// commands that drive both wheels, and of those that leave one [slow](is_slow).
    pub nugget: [[f64; 2]; 3],
    /// Standard deviation of what the first step of a command does beyond later ones, the same whenever one command follows
    /// the other.
    pub first_step: [f64; 3],
    /// Variance of the tracker's error in one pose, which no simulated robot has.
    pub tracker: [f64; 3],
}

impl MotionNoise {
    /// The variance of what a robot adds in a step that moves it so: forward (cm), lateral (cm), turn (degrees).
    pub fn step_variance(&self, motion: [f64; 3], channel: usize) -> f64 {
        weighed(&self.step[channel], &terms(motion)).max(LEAST)
    }

    /// The variance of what a command that moves it so does beyond the smooth process.
    pub fn nugget_variance(&self, command: Percent, motion: [f64; 3], channel: usize) -> f64 {
        let nugget = self.nugget[channel][usize::from(is_slow(command))];
        nugget * nugget * self.step_variance(motion, channel)
    }

    /// The variance of the mean of so many steps of a command that is held, as it is tracked.
    pub fn mean_variance(&self, motion: [f64; 3], channel: usize, steps: usize) -> f64 {
        let steps = steps as f64;
        let own = self.step_variance(motion, channel) + self.aslant_variance(motion, channel);
        own / steps + 2.0 * self.tracker[channel] / (steps * steps)
    }

    /// The variance that the tracker's error in heading adds to a step: what it takes for lateral is way.
    pub fn aslant_variance(&self, motion: [f64; 3], channel: usize) -> f64 {
        let way_cm = if channel == LATERAL { motion[FORWARD] } else { 0.0 };
        way_cm * way_cm * self.tracker[TURN] * 1f64.to_radians() * 1f64.to_radians()
    }

    /// Whether a file could have held this.
    pub fn is_sound(&self) -> bool {
        let all =
            self.step.iter().flatten().chain(self.nugget.iter().flatten()).chain(&self.first_step).chain(&self.tracker);
        all.copied().all(|value| value.is_finite() && value >= 0.0)
    }
}

/// Whether a command leaves a wheel to friction, which no smooth process knows: whether that moves depends on the other one.
pub fn is_slow(Percent(command): Percent) -> bool {
    command.iter().any(|c| c.abs() < SLOW)
}

/// What a step's variance is a sum of.
pub fn terms([forward_cm, _, turn_deg]: [f64; 3]) -> [f64; TERMS] {
    [1.0, forward_cm * forward_cm, turn_deg * turn_deg]
}

/// The sum of terms by their weights.
pub fn weighed(weights: &[f64; TERMS], terms: &[f64; TERMS]) -> f64 {
    (0..TERMS).map(|term| weights[term] * terms[term]).sum()
}
