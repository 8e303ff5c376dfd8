//! Cumulative motion from wheel odometry or a camera.

use std::f64::consts::PI;

use super::frame::{Frame, GAP_MS};
use mindgap_logs::{Robot, Row, Rows};

/// Number of motion components: rotation (rad) and forward travel (cm).
pub const MOTIONS: usize = 2;

/// Number of consecutive frames that are averaged, which halves the camera's noise.
const NEIGHBOURS: usize = 4;

/// Cumulative motion at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CumulativeMotion {
    /// Time on the clock of the measuring device, ms.
    pub t_ms: f64,
    /// Rotation (rad) and forward travel (cm) since the first row or frame.
    pub by: [f64; MOTIONS],
}

/// Integrates motion from the rotation counters; rows without them are skipped.
pub fn by_wheels(rows: &Rows, robot: &Robot) -> Vec<CumulativeMotion> {
    let cm_per_deg = PI * robot.wheel_diameter_cm / 360.0;
    let moved = |row: Row| {
        let [left_cm, right_cm] = [row.rot_left_deg? * cm_per_deg, row.rot_right_deg? * cm_per_deg];
        Some(CumulativeMotion {
            t_ms: row.t_ms,
            by: [(right_cm - left_cm) / robot.track_cm, (left_cm + right_cm) / 2.0],
        })
    };
    rows.iter().filter_map(moved).collect()
}

/// Integrates motion from camera frames, with a moving average over consecutive frames.
pub fn by_camera(frames: &[Frame]) -> Vec<CumulativeMotion> {
    let mut by = [0.0; MOTIONS];
    let mut before: Option<&Frame> = None;
    let mut near: Vec<CumulativeMotion> = Vec::with_capacity(NEIGHBOURS);
    let averaged = frames.iter().filter_map(|frame| {
        if let Some(before) = before.replace(frame) {
            let change = before.pose.relative(&frame.pose);
            // Travel along the mean of both headings, which is the direction of an arc's chord.
            let (sin, cos) = libm::sincos(change.heading_rad / 2.0);
            by[0] += change.heading_rad;
            by[1] += change.position_cm.x * cos + change.position_cm.y * sin;
        }
        if near.len() == NEIGHBOURS {
            near.remove(0);
        }
        near.push(CumulativeMotion { t_ms: frame.t_ms, by });
        (near.len() == NEIGHBOURS && frame.t_ms - near[0].t_ms <= GAP_MS).then(|| mean(&near))
    });
    averaged.collect()
}

fn mean(near: &[CumulativeMotion]) -> CumulativeMotion {
    let mean = |value: &dyn Fn(&CumulativeMotion) -> f64| near.iter().map(value).sum::<f64>() / near.len() as f64;
    CumulativeMotion { t_ms: mean(&|m| m.t_ms), by: std::array::from_fn(|motion| mean(&|m| m.by[motion])) }
}
