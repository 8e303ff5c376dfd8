//! Training samples extracted from logs: motion and sonar (paper, section VI).

use std::f64::consts::PI;

use crate::{Logs, Robot, Run};
use mindgap_foundations::geometry::cast;
use mindgap_foundations::motion::Motion;

/// A step longer than this multiple of `step_ms` spans missing rows and is skipped, and so is the step after it.
pub const LONGEST_STEP: f64 = 1.5;

/// A row of logs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct RowId {
    /// Index of the run.
    pub run: usize,
    /// Index of the row within the run.
    pub row: usize,
}

/// One step of a run: commands and pose increment in the robot's own frame.
///
/// The increment is scaled from the actual duration of the step to `step_ms`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionSample {
    /// Index of the run.
    pub run: usize,
    /// Index of the row at which the step starts.
    pub row: usize,
    /// Left, right, previous left and previous right command.
    pub speeds: [f64; 4],
    /// Displacement forward, cm.
    pub forward_cm: f64,
    /// Displacement to the left, cm.
    pub lateral_cm: f64,
    /// Turn to the left, rad.
    pub turn_rad: f64,
}

impl MotionSample {
    /// Returns the row at which the step begins.
    pub fn id(&self) -> RowId {
        RowId { run: self.run, row: self.row }
    }

    /// Returns the pose increment.
    pub fn motion(&self) -> Motion<f64> {
        Motion { forward: self.forward_cm, lateral: self.lateral_cm, turn: self.turn_rad }
    }
}

/// One reading of the sensor and the geometry in front of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SonarSample {
    /// Index of the run.
    pub run: usize,
    /// Index of the row.
    pub row: usize,
    /// D: distance along the sensor's axis to the first wall or edge, cm.
    pub distance_cm: f64,
    /// Signed incidence angle between axis and normal in (-π/2, π/2), rad; its magnitude is α.
    pub incidence_rad: f64,
    /// The reading, cm; `None` if the sensor produced no value.
    pub echo_cm: Option<f64>,
}

impl SonarSample {
    /// Returns α in degrees, 0..=90.
    pub fn alpha_deg(&self) -> f64 {
        self.incidence_rad.abs().to_degrees()
    }
}

/// Returns all steps between two rows with tracked poses.
pub fn motion(logs: &Logs) -> Vec<MotionSample> {
    steps(logs).collect()
}

/// Iterates over the samples of [`motion`], for large logs.
pub fn steps(logs: &Logs) -> impl Iterator<Item = MotionSample> {
    let step_ms = logs.robot.step_ms;
    let rows = logs.runs.iter().enumerate().flat_map(|(run, r)| (1..r.rows.len()).map(move |end| (run, r, end - 1)));
    rows.filter_map(move |(run, r, row)| step(step_ms, run, r, row))
}

/// Returns the step from a row of a run.
fn step(step_ms: f64, run: usize, r: &Run, row: usize) -> Option<MotionSample> {
    let (begin, end) = (r.rows.at(row), r.rows.at(row + 1));
    let duration_ratio = (end.t_ms - begin.t_ms) / step_ms;
    let (from, to) = (begin.pose?, end.pose?);
    if duration_ratio > LONGEST_STEP || follows_gap(step_ms, r, row) {
        return None;
    }
    let change = from.relative(&to);
    let ([left, right], [previous_left, previous_right]) = (begin.command(), r.previous_command(row));
    Some(MotionSample {
        run,
        row,
        speeds: [left, right, previous_left, previous_right],
        forward_cm: change.position_cm.x / duration_ratio,
        lateral_cm: change.position_cm.y / duration_ratio,
        turn_rad: change.heading_rad / duration_ratio,
    })
}

/// Returns whether rows are missing before a row. What was commanded there is unknown, and it still acts on the step that follows.
pub fn follows_gap(step_ms: f64, run: &Run, row: usize) -> bool {
    row > 0 && run.rows.at(row).t_ms - run.rows.at(row - 1).t_ms > LONGEST_STEP * step_ms
}

/// Returns how far the rims of the left and the right wheel turned in the step from a row, cm, by their rotation counters,
/// scaled to the nominal step; `None` without counters at both ends, and where rows are missing in it or before it.
pub fn wheels_cm(robot: &Robot, run: &Run, row: usize) -> Option<[f64; 2]> {
    let (begin, end) = (run.rows.get(row)?, run.rows.get(row + 1)?);
    let duration_ratio = (end.t_ms - begin.t_ms) / robot.step_ms;
    let cm_per_deg = PI * robot.wheel_diameter_cm / 360.0;
    let turned_cm = |from: Option<f64>, to: Option<f64>| Some((to? - from?) * cm_per_deg / duration_ratio);
    let left_cm = turned_cm(begin.rot_left_deg, end.rot_left_deg)?;
    let right_cm = turned_cm(begin.rot_right_deg, end.rot_right_deg)?;
    let is_step = duration_ratio <= LONGEST_STEP && !follows_gap(robot.step_ms, run, row);
    is_step.then_some([left_cm, right_cm])
}

/// Returns all rows with a tracked pose at which the sensor, if there is one, faced a wall or an edge.
pub fn sonar(logs: &Logs) -> Vec<SonarSample> {
    readings(logs).collect()
}

/// Iterates over the samples of [`sonar`], for large logs.
pub fn readings(logs: &Logs) -> impl Iterator<Item = SonarSample> {
    let sides = logs.scene.sides();
    let sensor = logs.robot.ultrasonic;
    let rows =
        logs.runs.iter().enumerate().flat_map(|(run, r)| r.rows.iter().enumerate().map(move |(k, row)| (run, k, row)));
    rows.filter_map(move |(run, row, logged)| {
        let sensor = sensor?.pose_on(&logged.pose?);
        let hit = cast(&sides, sensor.position_cm, sensor.direction())?;
        let (distance_cm, incidence_rad) = (hit.distance_cm, hit.incidence_rad);
        Some(SonarSample { run, row, distance_cm, incidence_rad, echo_cm: logged.echo_cm })
    })
}
