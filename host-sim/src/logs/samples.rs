//! Training samples extracted from logs: motion and sonar (paper, section VI).

use crate::geometry::cast;
use crate::logs::Logs;

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
    let mut samples = Vec::new();
    for (run, r) in logs.runs.iter().enumerate() {
        for (row, pair) in r.rows.windows(2).enumerate() {
            let stretch = (pair[1].t_ms - pair[0].t_ms) / logs.robot.step_ms;
            let (Some(from), Some(to)) = (pair[0].pose, pair[1].pose) else { continue };
            if stretch > LONGEST_STEP {
                continue;
            }
            let change = from.relative(&to);
            let ([left, right], [previous_left, previous_right]) = (pair[0].command(), r.previous_command(row));
            samples.push(MotionSample {
                run,
                row,
                speeds: [left, right, previous_left, previous_right],
                forward_cm: change.position_cm.x / stretch,
                lateral_cm: change.position_cm.y / stretch,
                turn_rad: change.heading_rad / stretch,
            });
        }
    }
    samples
}

/// All rows with a tracked pose at which the sensor, if there is one, faced a wall or an edge.
pub fn sonar(logs: &Logs) -> Vec<SonarSample> {
    if logs.robot.ultrasonic.is_none() {
        return Vec::new();
    }
    let sides = logs.scene.sides();
    let mut samples = Vec::new();
    for (run, r) in logs.runs.iter().enumerate() {
        for (row, logged) in r.rows.iter().enumerate() {
            let Some(pose) = logged.pose else { continue };
            let sensor = logs.robot.ultrasonic.pose_on(&pose);
            if let Some(hit) = cast(&sides, sensor.position_cm, sensor.direction()) {
                samples.push(SonarSample {
                    run,
                    row,
                    distance_cm: hit.distance_cm,
                    incidence_rad: hit.incidence_rad,
                    echo_cm: logged.echo_cm,
                });
            }
        }
    }
    samples
}
