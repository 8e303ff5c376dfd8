//! Several runs of one controller, kept whole: paths, readings, and how each ended.

use mindgap_core::controller::Controller;
use serde::Serialize;

use super::course::{Course, Ending, Job, Moment, Outcome, REACHED_CM, Sensor};
use crate::chance::derive;
use crate::logs::Scene;

/// What `mindgap simulate --json` writes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Rehearsal {
    /// Version of this form.
    pub schema: u32,
    /// Runs that end within this of the target, without a crash, reach it.
    pub reached_within_cm: f64,
    /// Share of the runs that reached the target; null in a scene without one.
    pub success: Option<f64>,
    /// The runs.
    pub runs: Vec<SimulatedRun>,
}

/// One run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SimulatedRun {
    /// `finished`, `timed_out` or `crashed`.
    pub ending: &'static str,
    /// Steps that were taken.
    pub steps: u16,
    /// Where it ended.
    pub end_x_cm: f64,
    /// Where it ended.
    pub end_y_cm: f64,
    /// From there to the target; null in a scene without one.
    pub distance_cm: Option<f64>,
    /// Whether it reached the target.
    pub reached: Option<bool>,
    /// The pose at the start and after each step.
    pub path: Vec<PathPoint>,
}

/// One moment of a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PathPoint {
    /// Position along x.
    pub x_cm: f64,
    /// Position along y.
    pub y_cm: f64,
    /// Heading in (-180, 180].
    pub heading_deg: f64,
    /// The reading; null when the sensor produced none.
    pub echo_cm: Option<f32>,
    /// The tuple that is held from here on, from 1; 7 once finished.
    pub tuple: usize,
}

impl Rehearsal {
    /// Simulates so many runs.
    pub fn new(course: &Course, scene: &Scene, controller: &Controller, runs: usize, seed: u64) -> Self {
        let motions = &course.motions(controller);
        let runs: Vec<SimulatedRun> = (0..runs as u64)
            .map(|run| {
                let (outcome, moments) =
                    course.trace(Job { controller, motions, sensor: Sensor::Networks, seed: derive(seed, &[run]) });
                SimulatedRun::new(&outcome, &moments, course, scene)
            })
            .collect();
        let successes = runs.iter().filter(|run| run.reached == Some(true)).count();
        let success = scene.target_cm.map(|_| successes as f64 / runs.len() as f64);
        Rehearsal { schema: 1, reached_within_cm: REACHED_CM, success, runs }
    }
}

impl SimulatedRun {
    fn new(outcome: &Outcome, moments: &[Moment], course: &Course, scene: &Scene) -> Self {
        let start = Moment { pose: course.start, echo_cm: None, tuple: 0 };
        let point = |m: &Moment| PathPoint {
            x_cm: m.pose.position_cm.x,
            y_cm: m.pose.position_cm.y,
            heading_deg: m.pose.heading_rad.to_degrees(),
            echo_cm: m.echo_cm,
            tuple: m.tuple + 1,
        };
        SimulatedRun {
            ending: match outcome.ending {
                Ending::Finished => "finished",
                Ending::TimedOut => "timed_out",
                Ending::Crashed => "crashed",
            },
            steps: outcome.steps,
            end_x_cm: outcome.end_cm.x,
            end_y_cm: outcome.end_cm.y,
            distance_cm: scene.target_cm.map(|target_cm| outcome.end_cm.distance(target_cm)),
            reached: scene.target_cm.map(|target_cm| outcome.reached(target_cm)),
            path: [&start].into_iter().chain(moments).map(point).collect(),
        }
    }
}
