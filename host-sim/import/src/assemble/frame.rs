//! Corrects the frame of poses if it contradicts the robot's motion.

use glam::DVec2;

use super::Stated;
use super::clock::is_mirrored;
use super::rows::Prepared;
use crate::recording::{Commands, Kind, Recording};
use mindgap_foundations::error::Result;
use mindgap_foundations::geometry::{Pose, direction};
use mindgap_logs::inspection::{Orientation, fit_to_walls};
use mindgap_logs::{Logs, Robot, Scene};

/// Rotates or mirrors the poses of recordings as their logs require, and returns a description of the change.
pub fn correct_frame(recordings: &mut [Recording], logs: &Logs) -> Option<String> {
    let Orientation { direction: direction_index, is_reversed } = Orientation::of(logs);
    let quarter_deg = 90 * (direction_index % 4);
    let quarter_rad = f64::from(quarter_deg as u32).to_radians();
    let mirror = |v: DVec2| direction(quarter_rad).rotate(DVec2::new(v.x, -v.y));
    let (change, description): (&dyn Fn(&Pose) -> Pose, String) = match (direction_index, is_reversed) {
        (1..4, false) => (
            &|pose| Pose::new(pose.position_cm.x, pose.position_cm.y, pose.heading_rad + quarter_rad),
            format!("headings were rotated by {quarter_deg} deg to match the direction of motion"),
        ),
        (4.., true) => (
            &|pose| Pose::new(pose.position_cm.x, pose.position_cm.y, quarter_rad - pose.heading_rad),
            "headings increased clockwise, like a compass, and were mirrored".into(),
        ),
        (4.., false) => {
            let within_cm = back_into_room(&logs.scene, mirror);
            (
                &move |pose| Pose { position_cm: mirror(pose.position_cm) + within_cm, heading_rad: pose.heading_rad },
                "positions are mirrored against headings and motion, as if y pointed downwards, and were mirrored back"
                    .into(),
            )
        }
        _ => return None,
    };
    apply(recordings.iter_mut(), change);
    Some(description)
}

/// Mirrors the poses of recordings in which the robot turns opposite to its commands, or exchanges left and right where the
/// walls show that; returns a description of the change.
///
/// # Errors
/// When a recording cannot be prepared and is the only one.
pub fn unmirror(recordings: &mut [Recording], robot: &Robot, scene: &Scene, stated: Stated) -> Result<Option<String>> {
    let all = recordings.len();
    let mirrored = |recording: &&mut Recording| {
        recording.is_tracked()
            && Prepared::of(recording, robot)
                .is_ok_and(|prepared| is_mirrored(&prepared, robot, recording.has_one_clock, stated.offset_ms))
    };
    let mut mirrored: Vec<&mut Recording> = recordings.iter_mut().filter(mirrored).collect();
    if mirrored.is_empty() {
        return Ok(None);
    }
    let flip = |v: DVec2| DVec2::new(v.x, -v.y);
    let within_cm = back_into_room(scene, flip);
    let change = |pose: &Pose| Pose { position_cm: flip(pose.position_cm) + within_cm, heading_rad: -pose.heading_rad };
    let before = walls_fit(&mirrored, robot, scene)?;
    apply(mirrored.iter_mut().map(|recording| &mut **recording), &change);
    let after = walls_fit(&mirrored, robot, scene)?;
    let is_given_frame_right = before.zip(after).is_some_and(|(before, after)| before > after);
    let count = mirrored.len();
    let some = if count == all { String::new() } else { format!("in {count} of {all} recordings, ") };
    let is_twist = mirrored.iter().all(|recording| recording.commands.kind == Kind::Twist);
    if is_given_frame_right {
        apply(mirrored.iter_mut().map(|recording| &mut **recording), &change);
        mirrored.iter_mut().for_each(|recording| recording.commands.turn_opposite());
        let what =
            "the robot turns opposite to its commands, and readings fit the walls: left and right were exchanged";
        return Ok(Some(some + what));
    }
    let doubt =
        if is_twist || before.is_some() { "" } else { " (if left and right are exchanged instead, exchange them)" };
    Ok(Some(format!(
        "{some}the robot turns opposite to its commands: the frame is mirrored, as if y pointed downwards; y and headings were \
         mirrored back{doubt}"
    )))
}

/// Returns how well readings fit the walls; `None` without walls or with too few readings.
fn walls_fit(recordings: &[&mut Recording], robot: &Robot, scene: &Scene) -> Result<Option<f64>> {
    let clocks = crate::clocks::Clocks { offset_ms: 0.0, drift: 0.0 };
    let mut runs = Vec::new();
    for recording in recordings {
        runs.extend(Prepared::of(recording, robot)?.runs(&clocks, robot, runs.len()));
    }
    Ok(fit_to_walls(&Logs { robot: *robot, scene: scene.clone(), runs }))
}

fn apply<'a>(recordings: impl Iterator<Item = &'a mut Recording>, change: &dyn Fn(&Pose) -> Pose) {
    let frames = recordings.flat_map(|recording| &mut recording.poses);
    frames.for_each(|frame| frame.pose = change(&frame.pose));
}

/// Returns the displacement that brings positions back into the room after `mirror`: the mirrored frame has its origin in
/// another corner.
fn back_into_room(scene: &Scene, mirror: impl Fn(DVec2) -> DVec2) -> DVec2 {
    let Some(room) = scene.bounding_box() else { return DVec2::ZERO };
    let corners = [room.low_cm, room.high_cm].map(&mirror);
    let mirrored_low_cm = corners[0].min(corners[1]);
    // Along a diagonal, width and height are exchanged, and the corner at the origin stays.
    let swapped = mirror(DVec2::X).x.abs() < 0.5;
    let low_cm = if swapped { DVec2::new(room.low_cm.y, room.low_cm.x) } else { room.low_cm };
    (low_cm - mirrored_low_cm).round()
}

impl Commands {
    /// Reverses all turns.
    fn turn_opposite(&mut self) {
        let is_twist = self.kind == Kind::Twist;
        for (_, pair) in &mut self.samples {
            *pair = if is_twist { [pair[0], -pair[1]] } else { [pair[1], pair[0]] };
        }
    }
}
