//! What networks learn from: motion samples and sonar samples taken from logs (paper, section VI).

use crate::geometry::cast;
use crate::logs::Logs;

/// A step so much longer than `step_ms` has rows missing inside and is left out.
const LONGEST_STEP: f64 = 1.5;

/// One step of a run: the commands, and what they did in the robot's own frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionSample {
    /// Which run.
    pub run: usize,
    /// Which row of it the step begins at.
    pub row: usize,
    /// Left, right, previous left and previous right command.
    pub speeds: [f64; 4],
    /// Way forward, cm. This and the next two are brought from the step's real length to `step_ms` in proportion.
    pub forward_cm: f64,
    /// Way to the left, cm.
    pub lateral_cm: f64,
    /// Turn to the left, in (-π, π].
    pub turn_rad: f64,
}

/// One reading of the sensor: what it faced, and what it said.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SonarSample {
    /// Which run.
    pub run: usize,
    /// Which row of it.
    pub row: usize,
    /// D: along the sensor's axis to the first wall or edge.
    pub distance_cm: f64,
    /// Angle between axis and normal in (-π/2, π/2); its magnitude is α.
    pub incidence_rad: f64,
    /// The reading, if there was one.
    pub echo_cm: Option<f64>,
}

impl SonarSample {
    /// α in degrees, 0..=90.
    pub fn alpha_deg(&self) -> f64 {
        self.incidence_rad.abs().to_degrees()
    }
}

/// All steps at both of whose rows the tracker saw the robot.
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

/// All rows at which the tracker saw the robot and its sensor faced something.
pub fn sonar(logs: &Logs) -> Vec<SonarSample> {
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
