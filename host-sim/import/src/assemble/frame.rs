//! Corrects the frame of poses if it contradicts the robot's motion.

use glam::DVec2;

use crate::recording::Recording;
use mindgap_foundations::geometry::{Pose, direction};
use mindgap_logs::Logs;
use mindgap_logs::inspection::Orientation;

/// Rotates or mirrors the poses of recordings as their logs require, and returns a description of the change.
pub fn correct_frame(recordings: &mut [Recording], logs: &Logs) -> Option<String> {
    let Orientation { direction: direction_index, is_reversed } = Orientation::of(logs);
    let quarter_deg = 90 * (direction_index % 4);
    let quarter_rad = f64::from(quarter_deg as u32).to_radians();
    let (change, description): (&dyn Fn(&Pose) -> Pose, String) = match (direction_index, is_reversed) {
        (1..4, false) => (
            &|pose| Pose::new(pose.position_cm.x, pose.position_cm.y, pose.heading_rad + quarter_rad),
            format!("headings were rotated by {quarter_deg} deg to match the direction of motion"),
        ),
        (4.., true) => (
            &|pose| Pose::new(pose.position_cm.x, pose.position_cm.y, quarter_rad - pose.heading_rad),
            "headings increased clockwise, like a compass, and were mirrored".into(),
        ),
        (4.., false) => (
            &|pose| {
                // Mirrors about the line at half that angle.
                let DVec2 { x, y } = direction(quarter_rad).rotate(DVec2::new(pose.position_cm.x, -pose.position_cm.y));
                Pose { position_cm: DVec2::new(x, y), heading_rad: pose.heading_rad }
            },
            "positions are mirrored against headings and motion, as if y pointed downwards, and were mirrored back"
                .into(),
        ),
        _ => return None,
    };
    let frames = recordings.iter_mut().flat_map(|recording| &mut recording.poses).flatten();
    frames.for_each(|frame| frame.pose = change(&frame.pose));
    Some(description)
}
