//! Several runs of one controller, kept whole: paths, readings, and how each ended.

use mindgap_core::controller::Controller;
use rayon::prelude::*;
use schemars::JsonSchema;
use serde::Serialize;

use super::environment::Environment;
use super::motion::MotionTable;
use super::rollout::{REACHED_CM, RolloutOutcome, RolloutRequest, TrajectoryPoint};
use mindgap_foundations::counter::Counter;
use mindgap_foundations::random::derive;
use mindgap_foundations::schema_number::SchemaNumber;
use mindgap_logs::{Scene, Termination};

/// What `mindgap simulate --json` writes.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct RolloutReport {
    /// Version of the JSON.
    pub schema: SchemaNumber<1>,
    /// Runs that end within this distance of the target, without a crash, reach it, cm.
    pub reached_within_cm: f64,
    /// Share of the runs that reached the target; null in a scene without one.
    pub success: Option<f64>,
    /// The runs.
    pub runs: Vec<Rollout>,
}

/// One run.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Rollout {
    /// How it ended.
    #[serde(rename = "ending")]
    pub termination: Termination,
    /// Number of steps taken.
    pub steps: u16,
    /// Final position along x, cm.
    pub end_x_cm: f64,
    /// Final position along y, cm.
    pub end_y_cm: f64,
    /// Distance from there to the target, cm; null in a scene without one.
    pub distance_cm: Option<f64>,
    /// Whether it reached the target; null in a scene without one.
    pub reached: Option<bool>,
    /// The pose at the start and after each step.
    pub path: Vec<PathPoint>,
}

/// One point of a run's path.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct PathPoint {
    /// Position along x, cm.
    pub x_cm: f64,
    /// Position along y, cm.
    pub y_cm: f64,
    /// Heading in (-180, 180], degrees.
    pub heading_deg: f64,
    /// The reading, cm; null when the sensor produced none.
    pub echo_cm: Option<f32>,
    /// Number of the tuple held from here on, from 1; 7 once finished.
    pub tuple: usize,
}

impl RolloutReport {
    /// Simulates `runs` runs of a controller.
    pub fn new(environment: &Environment, scene: &Scene, controller: &Controller, runs: usize, seed: u64) -> Self {
        Self::of_robots(std::slice::from_ref(environment), scene, controller, runs, seed, |_, _| ())
    }

    /// As [`new`](Self::new), with several robots that take turns; there must be at least one. `watch` receives the number
    /// of finished runs and of all runs.
    pub fn of_robots(
        robots: &[Environment],
        scene: &Scene,
        controller: &Controller,
        runs: usize,
        seed: u64,
        watch: impl Fn(usize, usize) + Sync,
    ) -> Self {
        let motions: Vec<MotionTable> = robots.iter().map(|robot| robot.motions(controller)).collect();
        let counter = Counter::new(runs, watch);
        let rollout = |run: usize| {
            let environment = &robots[run % robots.len()];
            let (outcome, trajectory) = environment.trace(RolloutRequest {
                controller,
                motions: &motions[run % robots.len()],
                seed: derive(seed, &[run as u64]),
            });
            counter.increment();
            Rollout::new(&outcome, &trajectory, environment, scene)
        };
        let runs: Vec<Rollout> = (0..runs).into_par_iter().map(rollout).collect();
        let successes = runs.iter().filter(|run| run.reached == Some(true)).count();
        let success = scene.target_cm.map(|_| successes as f64 / runs.len() as f64);
        RolloutReport { schema: SchemaNumber, reached_within_cm: REACHED_CM, success, runs }
    }
}

impl Rollout {
    fn new(outcome: &RolloutOutcome, trajectory: &[TrajectoryPoint], environment: &Environment, scene: &Scene) -> Self {
        let start = TrajectoryPoint { pose: environment.start, echo_cm: None, tuple: 0 };
        let point = |m: &TrajectoryPoint| PathPoint {
            x_cm: m.pose.position_cm.x,
            y_cm: m.pose.position_cm.y,
            heading_deg: m.pose.heading_rad.to_degrees(),
            echo_cm: m.echo_cm,
            tuple: m.tuple + 1,
        };
        Rollout {
            termination: outcome.termination,
            steps: outcome.steps,
            end_x_cm: outcome.end_cm.x,
            end_y_cm: outcome.end_cm.y,
            distance_cm: scene.target_cm.map(|target_cm| outcome.end_cm.distance(target_cm)),
            reached: scene.target_cm.map(|target_cm| outcome.reached(target_cm)),
            path: [&start].into_iter().chain(trajectory).map(point).collect(),
        }
    }
}
