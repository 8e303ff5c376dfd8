//! A simulator, a scene and a start, ready for runs of controllers.

use glam::DVec2;
use mindgap_core::controller::Controller;
use mindgap_core::folded::FoldedNetwork;
use pulp::Arch;

use super::batch::Batch;
use super::beam::Beam;
use super::motion::{MotionNetworks, MotionTable};
use super::room::Room;
use super::scatter::{ConstantReading, Scatter, Spread};
use super::wrapped::Wrapped;
use super::{Noise, Simulator};
use crate::geometry::Pose;
use crate::logs::{Robot, Scene};
use crate::problem::{Problem, Result};

/// Where and how runs are simulated.
pub struct Course<'s> {
    pub(super) robot: Robot,
    pub(super) start: Pose,
    /// Unit vector along the sensor's axis on the robot.
    pub(super) yaw_direction: [f32; 2],
    pub(super) room: Room,
    pub(super) motion: MotionNetworks<'s>,
    /// Whether they are asked in every step and not once for all that a controller does: the same bits, slower.
    pub(super) asks_every_step: bool,
    /// Of the forward, lateral and turn networks.
    pub(super) motion_scatter: [Scatter; 3],
    /// Probability and value of an echo.
    pub(super) sonar: [FoldedNetwork<f32, 2>; 2],
    pub(super) echo_spread: &'s Spread,
    pub(super) constant_reading: Option<ConstantReading>,
    pub(super) noise: Noise,
    /// There when effects were added to the simulator.
    pub(super) wrapped: Option<Wrapped<'s>>,
    /// There when some runs meet it.
    pub(super) beam: Option<Beam>,
}

/// One run to be simulated.
#[derive(Clone, Copy)]
pub struct Job<'c> {
    /// The controller.
    pub controller: &'c Controller,
    /// Its motions on this course.
    pub motions: &'c MotionTable,
    /// Which sensor the robot has.
    pub sensor: Sensor,
    /// Fixes every draw of the run.
    pub seed: u64,
}

/// What makes the readings of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sensor {
    /// The two sonar networks.
    Networks,
    /// The beam that the training logs show, on a course that has one; else the networks.
    Beam,
}

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// The sixth tuple's test held.
    Finished,
    /// The step limit was reached.
    TimedOut,
    /// The body touched a wall or an obstacle.
    Crashed,
}

/// What a run came to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outcome {
    /// How it ended.
    pub ending: Ending,
    /// Where it ended; after a crash, the place of the first touch.
    pub end_cm: DVec2,
    /// Steps that were taken.
    pub steps: u16,
}

/// A run reaches the target when it ends within this of it, without a crash.
pub const REACHED_CM: f64 = 15.0;

impl Outcome {
    /// Whether the run reached the target.
    pub fn reached(&self, target_cm: DVec2) -> bool {
        self.ending != Ending::Crashed && self.end_cm.distance(target_cm) <= REACHED_CM
    }
}

/// One moment of a run that is watched.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// The pose after the step.
    pub pose: Pose,
    /// The reading after it.
    pub echo_cm: Option<f32>,
    /// The tuple that is held from then on; six once finished.
    pub tuple: usize,
}

impl<'s> Course<'s> {
    /// A course for runs from `start`.
    ///
    /// # Errors
    /// When the simulator lacks a network or the robot does not fit at the start.
    pub fn new(simulator: &'s Simulator, scene: &Scene, start: Pose, noise: Noise) -> Result<Self> {
        let robot = simulator.robot;
        if !scene.has_room_for(start.position_cm, robot.body_radius_cm) {
            return Err(Problem::new(format!(
                "the start at ({}, {}) leaves no room for a robot of radius {} cm",
                start.position_cm.x, start.position_cm.y, robot.body_radius_cm
            )));
        }
        let echo_probability = simulator.need(&simulator.echo_probability, "echo_probability")?;
        let echo_value = simulator.need(&simulator.echo_value, "echo_value")?;
        let yaw_rad = robot.ultrasonic.yaw_deg.to_radians();
        let beyond = simulator.reference.as_ref().filter(|_| noise == Noise::Learned);
        let motion = MotionNetworks::of(simulator)?.corrected(beyond.and_then(|r| r.motion.as_ref()));
        Ok(Course {
            robot,
            start,
            yaw_direction: [libm::cos(yaw_rad) as f32, libm::sin(yaw_rad) as f32],
            room: Room::new(scene),
            motion_scatter: motion.scatters(),
            motion,
            asks_every_step: false,
            sonar: [echo_probability, echo_value].map(|l| FoldedNetwork::fold(&l.network)),
            echo_spread: &echo_value.spread,
            constant_reading: simulator.constant_reading,
            noise,
            wrapped: Wrapped::of(simulator, scene, noise)?,
            beam: None,
        })
    }

    /// The course with the beam that the training logs of its simulator show, for the runs that ask for it.
    pub fn with_beam(self, simulator: &Simulator) -> Self {
        let reference = simulator.reference.as_ref().and_then(|r| r.sonar.as_ref());
        Course { beam: reference.map(Beam::new), ..self }
    }

    /// The course with the motion networks asked in every step. Outcomes stay the same to the bit; it is there to show
    /// that, and what it would cost.
    pub fn asking_every_step(self) -> Self {
        Course { asks_every_step: true, ..self }
    }

    /// The motions of a controller on this course.
    pub fn motions(&self, controller: &Controller) -> MotionTable {
        self.motion.table(controller)
    }

    /// Simulates runs side by side; the outcomes are in the order of the jobs.
    pub fn run(&self, jobs: &[Job]) -> Vec<Outcome> {
        let mut outcomes = vec![None; jobs.len()];
        for sensor in [Sensor::Networks, Sensor::Beam] {
            let jobs: Vec<(usize, Job)> =
                jobs.iter().copied().enumerate().filter(|(_, job)| job.sensor == sensor).collect();
            let finish = |job: usize, outcome| outcomes[job] = Some(outcome);
            Arch::new().dispatch(Batch { course: self, sensor, jobs: &jobs, watch: |_| {}, finish });
        }
        outcomes.into_iter().flatten().collect()
    }

    /// Simulates one run and keeps every moment of it.
    pub fn trace(&self, job: Job) -> (Outcome, Vec<Moment>) {
        let (mut moments, mut outcome) = (Vec::new(), None);
        let watch = |moment| moments.push(moment);
        let finish = |_, ended| outcome = Some(ended);
        Arch::new().dispatch(Batch { course: self, sensor: job.sensor, jobs: &[(0, job)], watch, finish });
        (outcome.expect("every run ends"), moments)
    }
}
