//! The built-in robot: a physical model that stands in for reality, so that everything can be tried without a robot.
//!
//! It integrates forces, voltages and torques in small time steps, with echo strengths and camera optics, and shares no formula
//! with the simulators learned from its logs or with the effects that a diagnosis tries. Its logs have the format of any
//! robot's.
//!
//! [`BuiltInRobot`] is the robot in its room with its active [`effects`]; [`Body`] is its state during a run; [`record`] makes
//! logs of random commands for a kind of [`Driving`]; [`run_controller`] runs a controller, and [`run_script`] a script. Internally, `hardware` holds the
//! parameters of all parts, `drivetrain` and `wheel` the dynamics, `sonar` the sensor, `tracker` camera and compass.

mod acoustics;
mod body;
mod controller_run;
mod drivetrain;
mod driving;
pub mod effects;
mod hardware;
mod noise;
mod recording;
mod rooms;
mod script_run;
mod sonar;
mod tracker;
mod wheel;

pub use body::Body;
pub use controller_run::{Trajectory, TrajectoryPoint, run_controller};
pub use driving::Driving;
pub use effects::{ActiveEffect, Effect, HeldOut};
pub use recording::{record, record_driving};
pub use rooms::{default_robot, four_obstacles, training_room};
pub use script_run::run_script;

use effects::fitting;
use hardware::Hardware;
use mindgap_foundations::geometry::{Pose, Wall};
use mindgap_foundations::random::Generator;
use mindgap_logs::{Robot, Scene};
use noise::normal;

/// A robot in a room.
#[derive(Clone, Debug)]
pub struct BuiltInRobot {
    body_radius_cm: f64,
    hardware: Hardware,
    sides: Vec<Wall>,
}

impl BuiltInRobot {
    /// Returns the robot that matches `spec` in `scene`, with these effects active.
    pub fn new(spec: &Robot, scene: &Scene, effects: &[ActiveEffect]) -> Self {
        let mut hardware = Hardware::new(spec, scene);
        effects.iter().for_each(|active| fitting::fit(&mut hardware, active));
        BuiltInRobot { body_radius_cm: spec.body_radius_cm, hardware, sides: scene.sides() }
    }

    /// Starts a run: the robot is at rest at pose `at` with a fresh battery.
    pub fn start(&self, at: Pose, rng: &mut Generator) -> Body<'_> {
        Body::at_rest(self, at, rng)
    }

    /// Draws the duration of a step of nominally `step_ms`, in whole milliseconds.
    fn step_length_ms(&self, step_ms: f64, rng: &mut Generator) -> f64 {
        (step_ms + self.hardware.link.step_jitter_ms * normal(rng)).round().max(1.0)
    }

    /// Returns the distance between the robot's body at `pose` and the nearest wall or obstacle, cm; negative if they overlap.
    fn clearance_cm(&self, pose: &Pose) -> f64 {
        let at_cm = pose.position_cm;
        let nearest = self.sides.iter().map(|side| side.nearest(at_cm).distance(at_cm)).fold(f64::INFINITY, f64::min);
        nearest - self.body_radius_cm
    }
}
