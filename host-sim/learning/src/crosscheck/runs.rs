//! Whole runs of controllers in both arithmetics, side by side: from the same start, in the same room, with the same draws.
//! Poses and rays belong to the room and not to the robot; they are in double precision for both.

use mindgap_core::chance::Generator;
use mindgap_core::controller::{Controller, Machine, Motors, Status};
use rand::{RngExt, SeedableRng};
use rayon::prelude::*;
use schemars::JsonSchema;
use serde::Serialize;

use super::arithmetic::{Arithmetic, Fixed, Float};
use crate::evolve::genome::GenotypeDecoder;
use mindgap_foundations::counter::Counter;
use mindgap_foundations::error::{Error, Result};
use mindgap_foundations::geometry::{Pose, Wall, cast, wrap_rad};
use mindgap_foundations::random::{derive, generator};
use mindgap_logs::{Logs, Robot};
use mindgap_models::simulator::Simulator;
use mindgap_models::simulator::room::Room;

/// Number and seed of the runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Trials {
    /// Number of pairs of runs.
    pub runs: usize,
    /// Seed of controllers, starts and draws.
    pub seed: u64,
}

/// Summary of pairs of runs.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct Runs {
    /// Number of pairs of runs.
    pub n: usize,
    /// Number of steps of all pairs, counted while either run of a pair was under way.
    pub steps: usize,
    /// Number of steps after which both runs held the same tuple, or had ended alike.
    pub same_decisions: usize,
    /// Number of pairs that diverged at one or more steps.
    pub diverged: usize,
    /// The first divergence.
    pub first_divergence: Option<Divergence>,
    /// Largest differences within a pair before it diverged.
    pub largest_difference: Difference,
}

/// The first step after which the two runs of a pair were no longer in the same tuple.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Divergence {
    /// The pair, from 1.
    pub run: usize,
    /// The step, from 1.
    pub step: usize,
    /// State of the run in float after it.
    pub float: RunState,
    /// State of the run in fixed point after it.
    pub fixed: RunState,
}

/// The state of a run after a step.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct RunState {
    /// Position along x, cm.
    pub x_cm: f64,
    /// Position along y, cm.
    pub y_cm: f64,
    /// Heading in (-180, 180], degrees.
    pub heading_deg: f64,
    /// The reading, cm; null if there was none.
    pub echo_cm: Option<f64>,
    /// Number of the tuple held from here on, from 1; 7 once finished.
    pub tuple: usize,
    /// Whether the robot has touched something.
    pub crashed: bool,
    /// Whether the motors have been stopped.
    pub stopped: bool,
}

/// Largest differences between two runs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct Difference {
    /// Distance between the positions, cm.
    pub position_cm: f64,
    /// Difference of the headings, degrees.
    pub heading_deg: f64,
    /// Difference of the readings, cm.
    pub echo_cm: f64,
}

/// The step limit of random controllers.
const MAX_STEPS: u16 = 150;
/// Stream keys of the draws of a pair of runs, and of each of its steps.
const PAIR: u64 = 0;
const STEP: u64 = 1;

/// Runs pairs from poses of the logs.
pub(super) fn side_by_side(
    float: &Float,
    fixed: &Fixed,
    simulator: &Simulator,
    logs: &Logs,
    controller: Option<&Controller>,
    trials: Trials,
    watch: impl Fn(usize, usize) + Sync,
) -> Result<Runs> {
    let world = World { robot: simulator.robot, sides: logs.scene.sides(), room: Room::new(&logs.scene) };
    let has_room = |pose: &Pose| logs.scene.has_room_for(pose.position_cm, world.robot.body_radius_cm);
    let poses = logs.runs.iter().flat_map(|run| run.rows.iter().filter_map(|row| row.pose));
    let starts: Vec<Pose> = poses.filter(has_room).collect();
    if starts.is_empty() {
        return Err(Error::new("the robot does not fit at any pose in the logs, so no run can start"));
    }
    let decoder = GenotypeDecoder::new(simulator, MAX_STEPS);
    let counter = Counter::new(trials.runs, watch);
    let pairs = (0..trials.runs).into_par_iter().map(|run| {
        let seed = derive(trials.seed, &[run as u64]);
        let mut generator = generator(seed, &[PAIR]);
        let start = starts[generator.random_range(0..starts.len())];
        let random = decoder.controller(&decoder.random(&mut generator));
        let controller = controller.unwrap_or(&random);
        let (float, fixed) = (Walker::new(float, controller, start), Walker::new(fixed, controller, start));
        let found = pair(&world, float, fixed, run + 1, seed);
        counter.increment();
        found
    });
    Ok(pairs.collect::<Vec<Runs>>().into_iter().fold(Runs::default(), Runs::and))
}

/// Runs one pair.
fn pair(world: &World, mut float: Walker<Float>, mut fixed: Walker<Fixed>, run: usize, seed: u64) -> Runs {
    let (mut steps, mut same_decisions) = (0, 0);
    let (mut first_divergence, mut largest_difference) = (None, Difference::default());
    while float.is_under_way() || fixed.is_under_way() {
        steps += 1;
        // Each step has its own draws, so that one echo more or less leaves those of later steps alone.
        let mut generator = Generator::seed_from_u64(derive(seed, &[STEP, steps as u64]));
        float.step(world, &mut generator.clone());
        fixed.step(world, &mut generator);
        let states = [float.state(), fixed.state()];
        let decisions = states.map(|s| (s.tuple, s.crashed, s.stopped));
        if decisions[0] == decisions[1] {
            same_decisions += 1;
        } else if first_divergence.is_none() {
            first_divergence = Some(Divergence { run, step: steps, float: states[0], fixed: states[1] });
        }
        if first_divergence.is_none() {
            largest_difference = largest_difference.max(&states[0].difference(&states[1]));
        }
    }
    Runs {
        n: 1,
        steps,
        same_decisions,
        diverged: usize::from(first_divergence.is_some()),
        first_divergence,
        largest_difference,
    }
}

/// The environment of the runs, and the robot's dimensions.
struct World {
    robot: Robot,
    sides: Vec<Wall>,
    room: Room,
}

/// A robot under way that computes in one arithmetic.
struct Walker<'a, A: Arithmetic> {
    arithmetic: &'a A,
    pose: Pose,
    machine: Machine<'a>,
    previous: Motors,
    echo_cm: Option<A::Reading>,
    crashed: bool,
}

impl<'a, A: Arithmetic> Walker<'a, A> {
    fn new(arithmetic: &'a A, controller: &'a Controller, start: Pose) -> Self {
        let previous = Motors { left: 0, right: 0 };
        Walker { arithmetic, pose: start, machine: Machine::start(controller), previous, echo_cm: None, crashed: false }
    }

    fn is_under_way(&self) -> bool {
        !self.crashed && self.machine.status() == Status::Running
    }

    /// Moves straight along its heading, turns, and takes a reading unless it has touched something.
    fn step(&mut self, world: &World, generator: &mut Generator) {
        if !self.is_under_way() {
            return;
        }
        let now = self.machine.motors();
        let speeds = [now.left, now.right, self.previous.left, self.previous.right];
        self.previous = now;
        let [forward_cm, lateral_cm, turn_deg] = self.arithmetic.motion(speeds, generator).into_array();
        let from_cm = self.pose.position_cm;
        self.pose = self.pose.compose(&Pose::new(forward_cm, lateral_cm, turn_deg.to_radians()));
        self.crashed = world.room.touch(from_cm, self.pose.position_cm, world.robot.body_radius_cm).is_some();
        if self.crashed {
            return;
        }
        let sensor = world.robot.sensor_pose(&self.pose);
        self.echo_cm = cast(&world.sides, sensor.position_cm, sensor.direction()).and_then(|hit| {
            self.arithmetic.reading([hit.distance_cm, hit.incidence_rad.abs().to_degrees()], generator)
        });
        self.machine.step(self.echo_cm);
    }

    fn state(&self) -> RunState {
        RunState {
            x_cm: self.pose.position_cm.x,
            y_cm: self.pose.position_cm.y,
            heading_deg: self.pose.heading_rad.to_degrees(),
            echo_cm: self.echo_cm.map(Into::into),
            tuple: self.machine.tuple() + 1,
            crashed: self.crashed,
            stopped: self.machine.status() != Status::Running,
        }
    }
}

impl RunState {
    fn difference(&self, other: &Self) -> Difference {
        let echo_cm = self.echo_cm.zip(other.echo_cm).map_or(0.0, |(a, b)| (a - b).abs());
        Difference {
            position_cm: libm::hypot(self.x_cm - other.x_cm, self.y_cm - other.y_cm),
            heading_deg: wrap_rad((self.heading_deg - other.heading_deg).to_radians()).to_degrees().abs(),
            echo_cm,
        }
    }
}

impl Difference {
    fn max(&self, other: &Self) -> Self {
        Difference {
            position_cm: self.position_cm.max(other.position_cm),
            heading_deg: self.heading_deg.max(other.heading_deg),
            echo_cm: self.echo_cm.max(other.echo_cm),
        }
    }
}

impl Runs {
    /// Returns the share of the steps after which both runs held the same tuple.
    pub fn same_share(&self) -> f64 {
        self.same_decisions as f64 / self.steps as f64
    }

    fn and(self, other: Self) -> Self {
        Runs {
            n: self.n + other.n,
            steps: self.steps + other.steps,
            same_decisions: self.same_decisions + other.same_decisions,
            diverged: self.diverged + other.diverged,
            first_divergence: self.first_divergence.or(other.first_divergence),
            largest_difference: self.largest_difference.max(&other.largest_difference),
        }
    }
}
