//! Training samples extracted from logs: motion and sonar (paper, section VI).

use crate::{Logs, Run};
use mindgap_foundations::geometry::cast;

/// A step longer than this multiple of `step_ms` spans missing rows and is left out.
const LONGEST_STEP: f64 = 1.5;

/// One step of a run: commands and pose increment in the robot's own frame.
///
/// The increment is scaled from the actual duration of the step to `step_ms`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionSample {
    /// Index of the run.
    pub run: usize,
    /// Index of the row at which the step begins.
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

/// One reading of the sensor and the geometry that it faced.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SonarSample {
    /// Index of the run.
    pub run: usize,
    /// Index of the row.
    pub row: usize,
    /// D: distance along the sensor's axis to the first wall or edge, cm.
    pub distance_cm: f64,
    /// Signed angle between axis and normal in (-π/2, π/2), rad; its magnitude is α.
    pub incidence_rad: f64,
    /// The reading, cm; `None` if the sensor produced no value.
    pub echo_cm: Option<f64>,
}

impl SonarSample {
    /// α in degrees, 0..=90.
    pub fn alpha_deg(&self) -> f64 {
        self.incidence_rad.abs().to_degrees()
    }
}

/// All steps between two rows with a tracked pose.
pub fn motion(logs: &Logs) -> Vec<MotionSample> {
    steps(logs).collect()
}

/// The same one by one, for logs that are large.
pub fn steps(logs: &Logs) -> impl Iterator<Item = MotionSample> {
    let step_ms = logs.robot.step_ms;
    let rows = logs.runs.iter().enumerate().flat_map(|(run, r)| (1..r.rows.len()).map(move |end| (run, r, end - 1)));
    rows.filter_map(move |(run, r, row)| step(step_ms, run, r, row))
}

/// The step from a row of a run.
fn step(step_ms: f64, run: usize, r: &Run, row: usize) -> Option<MotionSample> {
    let (begin, end) = (r.rows.at(row), r.rows.at(row + 1));
    let stretch = (end.t_ms - begin.t_ms) / step_ms;
    let (from, to) = (begin.pose?, end.pose?);
    if stretch > LONGEST_STEP {
        return None;
    }
    let change = from.relative(&to);
    let ([left, right], [previous_left, previous_right]) = (begin.command(), r.previous_command(row));
    Some(MotionSample {
        run,
        row,
        speeds: [left, right, previous_left, previous_right],
        forward_cm: change.position_cm.x / stretch,
        lateral_cm: change.position_cm.y / stretch,
        turn_rad: change.heading_rad / stretch,
    })
}

/// All rows with a tracked pose at which the sensor, if there is one, faced a wall or an edge.
pub fn sonar(logs: &Logs) -> Vec<SonarSample> {
    readings(logs).collect()
}

/// The same one by one, for logs that are large.
pub fn readings(logs: &Logs) -> impl Iterator<Item = SonarSample> {
    let sides = logs.scene.sides();
    let sensor = Some(logs.robot.ultrasonic).filter(|sensor| !sensor.is_none());
    let rows =
        logs.runs.iter().enumerate().flat_map(|(run, r)| r.rows.iter().enumerate().map(move |(k, row)| (run, k, row)));
    rows.filter_map(move |(run, row, logged)| {
        let sensor = sensor?.pose_on(&logged.pose?);
        let hit = cast(&sides, sensor.position_cm, sensor.direction())?;
        let (distance_cm, incidence_rad) = (hit.distance_cm, hit.incidence_rad);
        Some(SonarSample { run, row, distance_cm, incidence_rad, echo_cm: logged.echo_cm })
    })
}
