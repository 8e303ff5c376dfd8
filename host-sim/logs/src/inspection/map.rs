//! Compares readings with the walls, for the given poses or transformed ones.

use super::segments::stride;
use crate::Logs;
use mindgap_foundations::geometry::{Pose, cast};

/// A reading fits if it is within this fraction of the distance along the sensor's axis.
const RELATIVE_TOLERANCE: f64 = 0.1;
/// A reading also fits within this length, cm: the beam is wide, and the robot moves during the measurement.
const TOLERANCE_CM: f64 = 5.0;

/// Returns pairs of a reading and the distance along the sensor's axis, cm, with poses transformed by `change`; large logs
/// are subsampled.
pub fn ranges_along_axis(logs: &Logs, change: impl Fn(&Pose) -> Pose) -> Vec<[f64; 2]> {
    let Some(mount) = logs.robot.ultrasonic else { return Vec::new() };
    let sides = logs.scene.sides();
    let rows = logs.runs.iter().flat_map(|run| &run.rows).step_by(stride(logs.rows()));
    let pairs = rows.filter_map(|row| {
        let sensor = mount.pose_on(&change(&row.pose?));
        Some([row.echo_cm?, cast(&sides, sensor.position_cm, sensor.direction())?.distance_cm])
    });
    pairs.filter(|[_, distance_cm]| *distance_cm <= mount.max_cm).collect()
}

/// Returns the fraction of pairs that fit after multiplying readings by `factor`.
pub fn fitting_fraction(pairs: &[[f64; 2]], factor: f64) -> f64 {
    let fits =
        |pair: &&[f64; 2]| (pair[0] * factor - pair[1]).abs() <= (RELATIVE_TOLERANCE * pair[1]).max(TOLERANCE_CM);
    pairs.iter().filter(fits).count() as f64 / pairs.len().max(1) as f64
}
