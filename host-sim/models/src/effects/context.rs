//! The context of a step, which is all that an effect depends on: for logs, simulated runs and planned runs.

use glam::DVec2;

use super::pieces::Pieces;
pub use super::pieces::{CommandHistory, HISTORY};
use super::scales::{self, reference_cm_s};
use crate::sonar::echo_law::Surfaces;
use mindgap_foundations::geometry::{Pose, Wall, bounding_box, cast};
use mindgap_logs::{Robot, Rows, Scene};

/// Number of earlier poses visible to an effect: the oldest reading that is thought of, 1.6 s, at 10 steps a second.
pub const EARLIER: usize = 16;

/// The context of a step, or of the reading at its start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepContext {
    /// Time since the run began, minutes.
    pub elapsed_min: f64,
    /// Commands as they were sent.
    pub commands: CommandHistory,
    /// The same at their own times, where a log knows these.
    pub pieces: Pieces,
    /// Tracked pose at the start of the step.
    pub pose: Pose,
    /// The same one row earlier, two rows earlier and so on, where it is known.
    pub earlier: [Option<Pose>; EARLIER],
    /// Distance in cm and signed incidence in radians at which the sensor's axis meets a wall.
    pub faced: Option<[f64; 2]>,
    /// Whether the row before had a reading.
    pub echo_before: Option<bool>,
    /// Middle of the scene, above which a camera hangs, cm.
    pub middle_cm: DVec2,
    /// The robot's measures.
    pub robot: Robot,
}

/// What stays the same from step to step: the robot and its environment.
#[derive(Clone, Debug)]
pub struct Surroundings {
    /// The robot's measures.
    pub robot: Robot,
    /// Everything that can return an echo.
    pub surfaces: Surfaces,
    middle_cm: DVec2,
}

/// The history of a run before a step.
#[derive(Clone, Debug, Default)]
pub struct RunHistory {
    commands: CommandHistory,
    pieces: Pieces,
    poses: [Option<Pose>; EARLIER],
    echo_cm: Option<Option<f64>>,
}

impl StepContext {
    /// Returns the rim speed of a wheel at a command, cm/s.
    pub fn wheel_speed_cm_s(&self, command: f64) -> f64 {
        command / 100.0 * self.robot.full_speed_cm_s
    }

    /// Returns the share of the [reference speed](reference_cm_s) that a command asks for.
    pub fn share_of(&self, command: f64) -> f64 {
        scales::share_of(command, &self.robot)
    }

    /// Returns the command that asks for a share of the [reference speed](reference_cm_s).
    pub fn command_for(&self, share: f64) -> f64 {
        scales::command_for(share, &self.robot)
    }

    /// Returns what a wheel at the [reference speed](reference_cm_s) covers in a step, cm.
    pub fn reference_cm(&self) -> f64 {
        reference_cm_s(&self.robot) * self.step_s()
    }

    /// Returns the nominal duration of a step, s.
    pub fn step_s(&self) -> f64 {
        self.robot.step_ms / 1000.0
    }
}

impl Surroundings {
    /// Of a robot in a scene.
    pub fn new(robot: &Robot, scene: &Scene) -> Self {
        let walls = scene.sides();
        Surroundings { robot: *robot, middle_cm: middle(&walls), surfaces: Surfaces::new(walls) }
    }

    /// Returns the context of a step that starts at `pose`, `elapsed_ms` after the start of the run.
    pub fn context(&self, history: &RunHistory, elapsed_ms: f64, pose: Pose) -> StepContext {
        let sensor = self.sensor(&pose, 0.0);
        let hit = cast(self.surfaces.walls(), sensor.position_cm, sensor.direction());
        StepContext {
            faced: hit.map(|hit| [hit.distance_cm, hit.incidence_rad]),
            ..self.unseen(history, elapsed_ms, pose)
        }
    }

    /// Returns the context without what the sensor faces, which is the most expensive part.
    pub fn unseen(&self, history: &RunHistory, elapsed_ms: f64, pose: Pose) -> StepContext {
        StepContext {
            elapsed_min: elapsed_ms / 60_000.0,
            commands: history.commands,
            pieces: history.pieces,
            pose,
            earlier: history.poses,
            faced: None,
            echo_before: history.echo_cm.map(|echo| echo.is_some()),
            middle_cm: self.middle_cm,
            robot: self.robot,
        }
    }

    /// Where the sensor of a robot at `robot` is, its axis turned by `yaw_rad`.
    pub fn sensor(&self, robot: &Pose, yaw_rad: f64) -> Pose {
        let mut sensor = self.robot.sensor_pose(robot);
        sensor.heading_rad += yaw_rad;
        sensor
    }
}

impl RunHistory {
    /// Returns the commands, newest first.
    pub fn commands(&self) -> &CommandHistory {
        &self.commands
    }

    /// Returns the same at their own times, where a log knows these.
    pub fn pieces(&self) -> &Pieces {
        &self.pieces
    }

    /// The step of a logged row begins.
    pub fn command_of(&mut self, rows: &Rows, row: usize) {
        if row == 0 {
            self.commands = [rows.command_before_start(); HISTORY];
        }
        self.command(rows.at(row).command());
        self.pieces = Pieces::of(rows, row);
    }

    /// A step begins with these commands.
    pub fn command(&mut self, command: [f64; 2]) {
        self.commands.rotate_right(1);
        self.commands[0] = command;
    }

    /// Adds the row at which a step began: where the robot was, if it was tracked, and what its sensor read.
    pub fn leave(&mut self, context: Option<&StepContext>, echo_cm: Option<f64>) {
        self.was_at(context.map(|context| context.pose));
        self.sensed(echo_cm);
    }

    /// Adds where the robot was at the start of a past step, if it was tracked.
    pub fn was_at(&mut self, pose: Option<Pose>) {
        self.poses.rotate_right(1);
        self.poses[0] = pose;
    }

    /// Adds what its sensor read at a past row.
    pub fn sensed(&mut self, echo_cm: Option<f64>) {
        self.echo_cm = Some(echo_cm);
    }
}

/// The middle of what walls enclose; the origin where there are none.
fn middle(walls: &[Wall]) -> DVec2 {
    bounding_box(walls).map_or(DVec2::ZERO, |enclosed| 0.5 * (enclosed.low_cm + enclosed.high_cm))
}
