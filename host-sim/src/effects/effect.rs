//! What a hypothesis is: a wrapper round one simulator step with a few bounded parameters.
//!
//! It may change the commands that reach the motors, the motion that comes out, or the sensor: where it is, which way
//! it looks, and what becomes of its echoes. At its neutral values it changes nothing.

use glam::DVec2;
use serde_json::Value;

use crate::geometry::{Pose, Wall};
use crate::sonar::Perturbation;
use crate::statistics::maximise::Bounds;

/// So many commands are kept, the present one first: an effect may look back so far.
pub const HISTORY: usize = 7;
/// Left and right command, the present one first.
pub type CommandHistory = [[f64; 2]; HISTORY];

/// One functional form of an effect.
pub struct Variant {
    /// The effect's name in the table of effects.
    pub id: &'static str,
    /// What tells this form from its siblings.
    pub name: &'static str,
    /// What is fitted.
    pub parameters: &'static [Parameter],
    /// Values to start the fit from.
    pub starts: &'static [&'static [f64]],
    /// What it does.
    pub acts: &'static [Hook],
    /// The parameters as the table names them, from their values and the step in ms.
    pub report: fn(&[f64], f64) -> Reported,
}

/// Parameters as they are reported: name and value.
pub type Reported = Vec<(&'static str, Value)>;

/// A number that is fitted.
#[derive(Clone, Copy, Debug)]
pub struct Parameter {
    /// What is physically possible.
    pub bounds: Bounds,
    /// With this value the parameter changes nothing, or has no say once the others change nothing.
    pub neutral: f64,
}

/// A change to one stage of a step.
pub enum Hook {
    /// To the commands that reach the motors, at each place of the window.
    Commands(fn(&[f64], &StepContext, &mut CommandHistory)),
    /// To the motion that the tracker sees.
    Motion(fn(&[f64], &StepContext, &mut PoseIncrement)),
    /// To the sensor.
    Sensor(fn(&[f64], &StepContext, &mut Sensor)),
}

/// What a step does as seen from the robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoseIncrement {
    /// Way forward, cm.
    pub forward_cm: f64,
    /// Way to the left, cm.
    pub lateral_cm: f64,
    /// Turn to the left.
    pub turn_rad: f64,
}

/// The sensor at a row, as an effect leaves it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensor {
    /// Where the robot is when the reading is made.
    pub robot: Pose,
    /// The axis is turned by this to the left of where it should be.
    pub yaw_rad: f64,
    /// The beam is so many times as wide.
    pub width: f64,
    /// What becomes of the echoes.
    pub change: Perturbation,
}

/// Where an effect finds itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepContext {
    /// Time since the run began, minutes.
    pub elapsed_min: f64,
    /// Commands as logged.
    pub commands: CommandHistory,
    /// Logged pose at the step's begin.
    pub pose: Pose,
    /// The same one and two rows earlier, where it is known.
    pub earlier: [Option<Pose>; 2],
    /// What the sensor's axis meets: distance in cm and signed incidence in radians.
    pub faced: Option<[f64; 2]>,
    /// What it met at the row before.
    pub faced_before: Option<[f64; 2]>,
    /// Whether the row before had a reading.
    pub echo_before: Option<bool>,
    /// Middle of the scene, where a camera hangs, cm.
    pub middle_cm: DVec2,
    /// Distance between the wheels, cm.
    pub track_cm: f64,
}

impl Parameter {
    /// A parameter with its bounds and neutral value.
    pub const fn new(low: f64, high: f64, neutral: f64) -> Self {
        Parameter { bounds: Bounds { low, high }, neutral }
    }
}

impl Variant {
    /// The values with which it changes nothing.
    pub fn neutral(&self) -> Vec<f64> {
        self.parameters.iter().map(|p| p.neutral).collect()
    }

    /// Whether it changes what the robot does or how that is seen.
    pub fn moves(&self) -> bool {
        self.acts.iter().any(|act| matches!(act, Hook::Commands(_) | Hook::Motion(_)))
    }

    /// Whether it changes what the sensor says.
    pub fn senses(&self) -> bool {
        self.acts.iter().any(|act| matches!(act, Hook::Sensor(_)))
    }
}

impl PoseIncrement {
    /// The way from one pose to another, as seen from the first.
    pub fn between(from: &Pose, to: &Pose) -> Self {
        let Pose { position_cm, heading_rad } = from.relative(to);
        PoseIncrement { forward_cm: position_cm.x, lateral_cm: position_cm.y, turn_rad: heading_rad }
    }

    /// Where it leads.
    pub fn from(&self, pose: &Pose) -> Pose {
        pose.compose(&Pose::new(self.forward_cm, self.lateral_cm, self.turn_rad))
    }

    /// Turns the way, not the turn.
    pub fn rotate_way(&mut self, angle_rad: f64) {
        let way = crate::geometry::direction(angle_rad).rotate(DVec2::new(self.forward_cm, self.lateral_cm));
        (self.forward_cm, self.lateral_cm) = (way.x, way.y);
    }

    /// Ways of the left and right wheel on a track.
    pub fn wheels_cm(&self, track_cm: f64) -> [f64; 2] {
        let half = 0.5 * track_cm * self.turn_rad;
        [self.forward_cm - half, self.forward_cm + half]
    }

    /// Sets forward and turn from the ways of the wheels.
    pub fn set_wheels(&mut self, [left, right]: [f64; 2], track_cm: f64) {
        self.forward_cm = 0.5 * (left + right);
        self.turn_rad = (right - left) / track_cm;
    }
}

/// The middle of what walls enclose.
pub fn middle(sides: &[Wall]) -> DVec2 {
    let ends = || sides.iter().flat_map(|s| [s.from_cm, s.to_cm]);
    let low = ends().fold(DVec2::INFINITY, DVec2::min);
    let high = ends().fold(DVec2::NEG_INFINITY, DVec2::max);
    0.5 * (low + high)
}
