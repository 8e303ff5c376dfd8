//! One run of a controller in an environment: what is asked for, what is watched, and what comes of it.

use glam::DVec2;
use mindgap_core::controller::Controller;

use super::motion::MotionTable;
use mindgap_foundations::geometry::Pose;

/// One run to be simulated.
#[derive(Clone, Copy)]
pub struct RolloutRequest<'c> {
    /// The controller.
    pub controller: &'c Controller,
    /// Its motions in this environment.
    pub motions: &'c MotionTable,
    /// Fixes every draw of the run.
    pub seed: u64,
}

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Termination {
    /// The sixth tuple's test held.
    Finished,
    /// The step limit was reached.
    TimedOut,
    /// The body touched a wall or an obstacle.
    Crashed,
}

/// The outcome of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RolloutOutcome {
    /// How it ended.
    pub termination: Termination,
    /// Final position; after a crash, the position of the first contact.
    pub end_cm: DVec2,
    /// Number of steps taken.
    pub steps: u16,
}

/// A run reaches the target when it ends within this distance of it, without a crash.
pub const REACHED_CM: f64 = 15.0;

impl RolloutOutcome {
    /// Whether the run reached the target.
    pub fn reached(&self, target_cm: DVec2) -> bool {
        self.termination != Termination::Crashed && self.end_cm.distance(target_cm) <= REACHED_CM
    }
}

/// The state after one step of a traced run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrajectoryPoint {
    /// The pose after the step.
    pub pose: Pose,
    /// The reading after it.
    pub echo_cm: Option<f32>,
    /// Index of the tuple held from then on; six once finished.
    pub tuple: usize,
}
