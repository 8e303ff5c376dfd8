//! The frame of poses, put right where it does not fit the way that the robot goes.

use glam::DVec2;

use crate::recording::Recording;
use mindgap_foundations::geometry::{Pose, direction};
use mindgap_logs::Logs;
use mindgap_logs::inspection::Orientation;

/// Turns or mirrors the poses of recordings by what their logs show, and says what was done.
pub fn put_right(recordings: &mut [Recording], logs: &Logs) -> Option<String> {
    let Orientation { going, is_reversed } = Orientation::of(logs);
    let quarter_deg = 90 * (going % 4);
    let quarter_rad = f64::from(quarter_deg as u32).to_radians();
    let (change, told): (&dyn Fn(&Pose) -> Pose, String) = match (going, is_reversed) {
        (1..4, false) => (
            &|pose| Pose::new(pose.position_cm.x, pose.position_cm.y, pose.heading_rad + quarter_rad),
            format!("headings were turned by {quarter_deg} deg, since the robot goes so much beside them"),
        ),
        (4.., true) => (
            &|pose| Pose::new(pose.position_cm.x, pose.position_cm.y, quarter_rad - pose.heading_rad),
            "headings count clockwise, as a compass does, and were mirrored".into(),
        ),
        (4.., false) => (
            &|pose| {
                // About the line at half that angle.
                let DVec2 { x, y } = direction(quarter_rad).rotate(DVec2::new(pose.position_cm.x, -pose.position_cm.y));
                Pose { position_cm: DVec2::new(x, y), heading_rad: pose.heading_rad }
            },
            "positions are mirrored against headings and motion, as where y counts downwards, and were mirrored back"
                .into(),
        ),
        _ => return None,
    };
    let frames = recordings.iter_mut().flat_map(|recording| &mut recording.poses).flatten();
    frames.for_each(|frame| frame.pose = change(&frame.pose));
    Some(told)
}
