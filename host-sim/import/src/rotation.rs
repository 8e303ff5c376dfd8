//! Recognises tracks without rotation: their headings never change although the robot moves and the commands turn it.

use super::recording::Recording;
use mindgap_logs::Robot;

/// Sine of the largest difference between headings that count as one.
const SAME_HEADING: f64 = 0.01;
/// Minimum commanded rotation that must be seen in headings, rad: one turn.
const MIN_ASKED_RAD: f64 = 2.0 * std::f64::consts::PI;
/// Minimum distance from the first pose of a robot that moves, cm.
const MIN_MOVED_CM: f64 = 20.0;

/// Returns why a recording is refused, if its track has no rotation. Without this, its clocks would seem to differ.
pub fn missing(recording: &Recording, robot: &Robot) -> Option<String> {
    let poses = || recording.poses.iter().map(|frame| frame.pose);
    let first = poses().next()?;
    // A rotation about another axis may look like half a turn.
    let is_constant = poses().all(|pose| libm::sin(pose.heading_rad - first.heading_rad).abs() < SAME_HEADING);
    let is_moving = poses().any(|pose| pose.position_cm.distance(first.position_cm) > MIN_MOVED_CM);
    let asked_rad: f64 = recording
        .commands
        .samples
        .windows(2)
        .map(|pair| {
            let [left_cm_s, right_cm_s] = recording.commands.kind.wheels_cm_s(pair[0].1, robot);
            ((right_cm_s - left_cm_s) / robot.track_cm).abs() * (pair[1].0 - pair[0].0) / 1e3
        })
        .sum();
    (is_constant && is_moving && asked_rad > MIN_ASKED_RAD).then(|| {
        format!(
            "the heading never changes, although the commands turn the robot by {:.0} degrees: export rotations, or set the \
             tracker's up axis to Z",
            asked_rad.to_degrees()
        )
    })
}
