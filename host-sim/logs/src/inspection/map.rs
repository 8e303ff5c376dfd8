//! How well readings fit the walls, for poses as they are and for poses changed.

use super::ways::one_in;
use crate::Logs;
use mindgap_foundations::geometry::{Pose, cast};

/// A reading fits when it lies within this share of the distance along the sensor's axis, or within
const FITS: f64 = 0.1;
/// this length: a beam is wide, and robots move while they listen.
const FITS_CM: f64 = 5.0;

/// Pairs of a reading and the distance along the sensor's axis, cm, from poses changed by `change`; of large logs enough.
pub fn faced(logs: &Logs, change: impl Fn(&Pose) -> Pose) -> Vec<[f64; 2]> {
    let sides = logs.scene.sides();
    let rows = logs.runs.iter().flat_map(|run| &run.rows).step_by(one_in(logs.rows()));
    let pairs = rows.filter_map(|row| {
        let sensor = logs.robot.ultrasonic.pose_on(&change(&row.pose?));
        Some([row.echo_cm?, cast(&sides, sensor.position_cm, sensor.direction())?.distance_cm])
    });
    pairs.filter(|[_, distance_cm]| *distance_cm <= logs.robot.ultrasonic.max_cm).collect()
}

/// The share of pairs that fit when readings are multiplied by `factor`.
pub fn fitting(pairs: &[[f64; 2]], factor: f64) -> f64 {
    let fits = |pair: &&[f64; 2]| (pair[0] * factor - pair[1]).abs() <= (FITS * pair[1]).max(FITS_CM);
    pairs.iter().filter(fits).count() as f64 / pairs.len().max(1) as f64
}
