//! Records logs of random commands, each held for a few steps (paper, section VI), as if an attendant prevented collisions.

use std::f64::consts::{FRAC_PI_4, PI};

use glam::DVec2;
use rand::RngExt;
use rayon::prelude::*;

use super::{ActiveEffect, Body, BuiltInRobot, Driving};
use mindgap_foundations::error::{Error, Result};
use mindgap_foundations::geometry::{Pose, Rectangle, cast, direction};
use mindgap_foundations::random::{Generator, generator};
use mindgap_logs::{Logs, Robot, Row, Run, Scene};

/// Minimum clearance of the robot's body, cm.
const MIN_CLEARANCE_CM: f64 = 2.0;
/// Minimum clearance of the body at the start of a run, cm.
const START_CLEARANCE_CM: f64 = 5.0;
/// Number of random positions tried before a room counts as too small.
const MAX_POSITIONS: usize = 10_000;
/// Number of random commands tried before the robot is stopped.
const MAX_COMMANDS: usize = 40;
/// Number of steps in which the robot comes to rest.
const STEPS_TO_STOP: usize = 2;
/// Number of attempts at a run without a collision.
const ATTEMPTS: u64 = 20;
/// Stream key of the generators.
const RECORDING: u64 = u64::from_be_bytes(*b"record  ");
/// Key of a run's generator for the drive.
const DRIVING: u64 = 0;
/// Key of a run's generator for the predictions that prevent collisions.
const FORESIGHT: u64 = 1;

/// Records `runs` runs of `steps` steps each; the same seed gives the same logs on any number of threads.
///
/// # Errors
/// When the scene has no room for the robot, or when `runs` or `steps` is 0.
pub fn record(
    spec: &Robot,
    scene: &Scene,
    runs: usize,
    steps: usize,
    effects: &[ActiveEffect],
    seed: u64,
) -> Result<Logs> {
    record_driving(&Driving::MIXED, spec, scene, [runs, steps], effects, seed)
}

/// As [`record`], with any kind of driving; `amount` is the number of runs and of steps in each.
///
/// # Errors
/// As [`record`].
pub fn record_driving(
    driving: &Driving,
    spec: &Robot,
    scene: &Scene,
    amount: [usize; 2],
    effects: &[ActiveEffect],
    seed: u64,
) -> Result<Logs> {
    let [runs, steps] = amount;
    if runs == 0 || steps == 0 {
        return Err(Error::new(format!("{runs} runs of {steps} steps: there must be at least one of each")));
    }
    let robot = BuiltInRobot::new(spec, scene, effects);
    let runs = (0..runs as u64)
        .into_par_iter()
        .map(|run| {
            let driving = &driving.of_run(run);
            let rows = (0..ATTEMPTS).find_map(|attempt| {
                let mut rng = generator(seed, &[RECORDING, run, attempt, DRIVING]);
                let mut foresight = generator(seed, &[RECORDING, run, attempt, FORESIGHT]);
                let start = free_pose(spec, scene, &mut rng)?;
                let recorder = Recorder { robot: &robot, driving, step_ms: spec.step_ms, steps };
                recorder.drive(start, &mut rng, &mut foresight)
            });
            Ok(Run {
                name: format!("run-{run:03}"),
                rows: rows.ok_or_else(|| room_too_small(spec))?.into_iter().collect(),
            })
        })
        .collect::<Result<Vec<Run>>>()?;
    Ok(Logs { robot: *spec, scene: scene.clone(), runs })
}

/// Returns the error of a scene in which no place is free.
pub(super) fn room_too_small(spec: &Robot) -> Error {
    let radius_cm = spec.body_radius_cm;
    Error::new(format!(
        "the scene has no room between its walls for the robot to drive in, a disc of radius {radius_cm} cm"
    ))
}

/// Draws a start pose with enough clearance.
pub(super) fn free_pose(spec: &Robot, scene: &Scene, rng: &mut Generator) -> Option<Pose> {
    let Rectangle { low_cm, high_cm } = scene.bounding_box()?;
    let heading_rad = rng.random_range(-PI..PI);
    (0..MAX_POSITIONS)
        .map(|_| low_cm + (high_cm - low_cm) * DVec2::new(rng.random(), rng.random()))
        .find(|at_cm| {
            is_enclosed(scene, *at_cm) && scene.has_room_for(*at_cm, spec.body_radius_cm + START_CLEARANCE_CM)
        })
        .map(|at_cm| Pose::new(at_cm.x, at_cm.y, heading_rad))
}

/// Returns whether there is a wall or obstacle in all of eight directions, so that the robot cannot leave.
fn is_enclosed(scene: &Scene, at_cm: DVec2) -> bool {
    let sides = scene.sides();
    (0..8).all(|eighth| cast(&sides, at_cm, direction(f64::from(eighth) * FRAC_PI_4)).is_some())
}

/// Records the runs of one robot.
struct Recorder<'a> {
    robot: &'a BuiltInRobot,
    driving: &'a Driving,
    step_ms: f64,
    steps: usize,
}

impl Recorder<'_> {
    /// Records the rows of one run, one more than steps; `None` if the robot hit something.
    fn drive(&self, start: Pose, rng: &mut Generator, foresight: &mut Generator) -> Option<Vec<Row>> {
        let mut body = self.robot.start(start, rng);
        let mut rows = Vec::with_capacity(self.steps + 1);
        let mut held = Held { command: [0.0, 0.0], steps: 0 };
        while !body.crashed() {
            if held.steps == 0 {
                held = self.safe_command(&body, rng, foresight);
            }
            held.steps -= 1;
            let echo_cm = body.read_sonar(rng);
            rows.push(body.row(held.command, echo_cm, rng));
            if rows.len() > self.steps {
                return Some(rows);
            }
            body.drive(held.command, self.robot.step_length_ms(self.step_ms, rng), rng);
        }
        None
    }

    /// Draws a command after which the robot can still be stopped without a collision; otherwise returns the command to stop.
    fn safe_command(&self, body: &Body, rng: &mut Generator, foresight: &mut Generator) -> Held {
        (0..MAX_COMMANDS)
            .map(|_| Held { command: self.driving.command(rng), steps: self.driving.steps(rng) })
            .find(|held| stays_clear(body, held, self.step_ms, foresight))
            .unwrap_or(Held { command: [0.0, 0.0], steps: 1 })
    }
}

/// A command and the number of steps for which it is held.
#[derive(Clone, Copy)]
struct Held {
    command: [f64; 2],
    steps: usize,
}

fn stays_clear(body: &Body, held: &Held, step_ms: f64, foresight: &mut Generator) -> bool {
    let mut body = body.clone();
    let stop = [[0.0, 0.0]; STEPS_TO_STOP];
    std::iter::repeat_n(held.command, held.steps).chain(stop).all(|command| {
        body.drive(command, step_ms, foresight);
        !body.crashed() && body.clearance_cm() > MIN_CLEARANCE_CM
    })
}
