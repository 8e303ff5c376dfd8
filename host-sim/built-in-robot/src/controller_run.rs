//! Runs a controller on the built-in robot.

use mindgap_core::controller::{Controller, Machine, Motors, Status};

use super::BuiltInRobot;
use mindgap_foundations::geometry::Pose;
use mindgap_foundations::random::Generator;
use mindgap_logs::{Row, Run, Termination};

/// The trajectory of a controller's run.
#[derive(Clone, Debug, PartialEq)]
pub struct Trajectory {
    /// One point per step from the start on; the last is one step after the motors stopped, when the robot is at rest.
    pub points: Vec<TrajectoryPoint>,
    /// How the run ended; a crash is one with the motors on or while the robot coasts to a halt.
    pub termination: Termination,
}

/// One point of a trajectory.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrajectoryPoint {
    /// The true pose.
    pub true_pose: Pose,
    /// The row of the log: commands from here on, tracked pose, and reading.
    pub row: Row,
}

/// Runs a controller from the pose `start` until it stops the motors or the robot crashes.
pub fn run_controller(robot: &BuiltInRobot, controller: &Controller, start: Pose, rng: &mut Generator) -> Trajectory {
    let mut body = robot.start(start, rng);
    let mut machine = Machine::start(controller);
    let mut points: Vec<TrajectoryPoint> = Vec::new();
    // Every row has a reading, but the controller only uses those after its first step and while it runs. The others
    // must not change the run, so they draw from a copy of the generator.
    while machine.status() == Status::Running && !body.crashed() {
        let echo_cm = if points.is_empty() {
            body.read_sonar(&mut rng.clone())
        } else {
            let echo_cm = body.read_sonar(rng);
            machine.step(echo_cm);
            echo_cm
        };
        let command = speeds(machine.motors());
        points.push(TrajectoryPoint { true_pose: body.true_pose(), row: body.row(command, echo_cm, rng) });
        body.drive(command, robot.step_length_ms(f64::from(controller.step_ms), rng), rng);
    }
    let echo_cm = body.read_sonar(&mut rng.clone());
    points.push(TrajectoryPoint { true_pose: body.true_pose(), row: body.row([0.0, 0.0], echo_cm, rng) });
    let termination = match machine.status() {
        _ if body.crashed() => Termination::Crashed,
        Status::Finished => Termination::Finished,
        Status::Running | Status::TimedOut => Termination::TimedOut,
    };
    Trajectory { points, termination }
}

impl Trajectory {
    /// Returns the number of the controller's steps: the first point is its start, and the motors stop after the last step.
    pub fn steps(&self) -> usize {
        self.points.len() - 2
    }

    /// Returns the true pose at which the robot came to rest.
    pub fn end(&self) -> Pose {
        self.points[self.points.len() - 1].true_pose
    }

    /// Converts the run to a log.
    pub fn to_run(&self, name: impl Into<String>) -> Run {
        Run { name: name.into(), rows: self.points.iter().map(|point| point.row).collect() }
    }
}

fn speeds(motors: Motors) -> [f64; 2] {
    [f64::from(motors.left), f64::from(motors.right)]
}
