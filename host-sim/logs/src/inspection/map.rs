//! Compares readings with the walls, for the given poses or transformed ones.

use super::segments::stride;
use crate::Logs;
use mindgap_foundations::geometry::{Pose, cast};

/// A reading fits if it is within this fraction of the distance along the sensor's axis.
const RELATIVE_TOLERANCE: f64 = 0.1;
/// A reading also fits within this length, cm: the beam is wide, and the robot moves during the measurement.
const TOLERANCE_CM: f64 = 5.0;

/// With fewer readings, the fraction that fits the walls is too uncertain to compare frames.
pub const MIN_READINGS: usize = 100;

/// Returns the fraction of readings that fit the walls, counted as zero where none is expected; `None` with too few readings.
pub fn fit_to_walls(logs: &Logs) -> Option<f64> {
    let readings = logs.runs.iter().flat_map(|run| &run.rows).filter(|row| row.echo_cm.is_some()).count();
    let pairs = ranges_along_axis(logs, |pose| *pose);
    let is_decidable = readings >= MIN_READINGS && !logs.scene.sides().is_empty();
    is_decidable
        .then(|| fitting_fraction(&pairs, 1.0) * pairs.len() as f64 / readings.div_ceil(stride(logs.rows())) as f64)
}

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
