//! Runs a controller on the built-in robot.

use mindgap_core::controller::{Controller, Machine, Motors, Status};

use super::BuiltInRobot;
use mindgap_foundations::chance::Generator;
use mindgap_foundations::geometry::Pose;
use mindgap_logs::{Row, Run};

/// The trajectory of a controller's run.
#[derive(Clone, Debug, PartialEq)]
pub struct Trajectory {
    /// One point a step, beginning at the start; the last one step after the motors stopped, when the robot is at rest.
    pub points: Vec<TrajectoryPoint>,
    /// How the run ended.
    pub termination: Termination,
}

/// One point of a trajectory.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrajectoryPoint {
    /// The true pose.
    pub true_pose: Pose,
    /// The row of the log: the commands from here on, the tracked pose, and the reading here.
    pub row: Row,
}

/// How a controller's run on the robot ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Termination {
    /// The sixth tuple's test held.
    Finished,
    /// The step limit was reached.
    TimedOut,
    /// The robot touched a wall or an obstacle, with its motors on or while it coasted to a halt.
    Crashed,
}

/// Runs a controller from the pose `start` until it stops the motors or the robot crashes.
pub fn run_controller(robot: &BuiltInRobot, controller: &Controller, start: Pose, rng: &mut Generator) -> Trajectory {
    let mut body = robot.start(start, rng);
    let mut machine = Machine::start();
    let mut points: Vec<TrajectoryPoint> = Vec::new();
    // Every row is read, but a controller looks only once it has driven a step and while it does. Where it does not look, the
    // reading moves no robot: it draws from a copy.
    while machine.status() == Status::Running && !body.crashed() {
        let echo_cm = if points.is_empty() {
            body.read_sonar(&mut rng.clone())
        } else {
            let echo_cm = body.read_sonar(rng);
            machine.step(controller, echo_cm);
            echo_cm
        };
        let command = speeds(machine.motors(controller));
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
    /// Steps that the controller took: the first point is its start, and after the last step the motors stop.
    pub fn steps(&self) -> usize {
        self.points.len() - 2
    }

    /// The true pose at which the robot came to rest.
    pub fn end(&self) -> Pose {
        self.points[self.points.len() - 1].true_pose
    }

    /// The run as a log.
    pub fn to_run(&self, name: impl Into<String>) -> Run {
        Run { name: name.into(), rows: self.points.iter().map(|point| point.row).collect() }
    }
}

fn speeds(motors: Motors) -> [f64; 2] {
    [f64::from(motors.left), f64::from(motors.right)]
}
