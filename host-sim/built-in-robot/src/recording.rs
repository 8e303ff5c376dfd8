//! Records logs of random commands, each held for a few steps (paper, section VI), as if somebody stood by who prevents
//! collisions.

use std::f64::consts::{FRAC_PI_4, PI};

use glam::DVec2;
use rand::RngExt;
use rayon::prelude::*;

use super::{ActiveEffect, Body, BuiltInRobot, Driving};
use mindgap_foundations::chance::{Generator, generator};
use mindgap_foundations::error::{Error, Result};
use mindgap_foundations::geometry::{Pose, Rectangle, cast, direction};
use mindgap_logs::{Logs, Robot, Row, Run, Scene};

/// Least clearance of the robot's body, cm.
const KEPT_CLEAR_CM: f64 = 2.0;
/// Least clearance of the body at the start of a run, cm.
const START_ROOM_CM: f64 = 5.0;
/// Number of random places tried before a room counts as too small.
const PLACES_TRIED: usize = 10_000;
/// Number of random commands tried before the robot is stopped.
const COMMANDS_TRIED: usize = 40;
/// Number of steps in which the robot comes to rest.
const STEPS_TO_STAND: usize = 2;
/// Number of attempts at a run without a collision.
const ATTEMPTS: u64 = 20;
/// Stream keys of the generators: the purpose, and within it for each run one for the drive and one for the predictions
/// that keep it safe.
const RECORDING: u64 = u64::from_be_bytes(*b"record  ");
const DRIVING: u64 = 0;
const FORESIGHT: u64 = 1;

/// Logs of `runs` runs of `steps` steps each, the same for the same seed on any number of threads.
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
                let start = free_place(spec, scene, &mut rng)?;
                let about = Recorder { robot: &robot, driving, step_ms: spec.step_ms, steps };
                about.drive(start, &mut rng, &mut foresight)
            });
            Ok(Run { name: format!("run-{run:03}"), rows: rows.ok_or_else(|| no_room(spec))?.into_iter().collect() })
        })
        .collect::<Result<Vec<Run>>>()?;
    Ok(Logs { robot: *spec, scene: scene.clone(), runs })
}

fn no_room(spec: &Robot) -> Error {
    let radius_cm = spec.body_radius_cm;
    Error::new(format!(
        "the scene has no room between its walls for the robot to drive in, a disc of radius {radius_cm} cm"
    ))
}

/// A random start pose with enough clearance.
fn free_place(spec: &Robot, scene: &Scene, rng: &mut Generator) -> Option<Pose> {
    let Rectangle { low_cm, high_cm } = scene.bounding_box()?;
    let heading_rad = rng.random_range(-PI..PI);
    (0..PLACES_TRIED)
        .map(|_| low_cm + (high_cm - low_cm) * DVec2::new(rng.random(), rng.random()))
        .find(|at_cm| is_enclosed(scene, *at_cm) && scene.has_room_for(*at_cm, spec.body_radius_cm + START_ROOM_CM))
        .map(|at_cm| Pose::new(at_cm.x, at_cm.y, heading_rad))
}

/// Whether there is a wall or obstacle in all of eight directions, so that the robot cannot leave.
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
    /// The rows of one run, one more than steps; `None` if the robot hit something.
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

    /// A random command after which the robot can still be stopped without a collision; else the command to stop.
    fn safe_command(&self, body: &Body, rng: &mut Generator, foresight: &mut Generator) -> Held {
        (0..COMMANDS_TRIED)
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
    let then_stopped = [[0.0, 0.0]; STEPS_TO_STAND];
    std::iter::repeat_n(held.command, held.steps).chain(then_stopped).all(|command| {
        body.drive(command, step_ms, foresight);
        !body.crashed() && body.clearance_cm() > KEPT_CLEAR_CM
    })
}
