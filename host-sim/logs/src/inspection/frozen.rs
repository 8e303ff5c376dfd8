//! A tracker that repeats the last pose while the robot drives on, and then catches up with it.

use super::finding::Finding;
use super::tolerance::Tolerance;
use super::ways::Drive;
use crate::{Logs, Run};

/// The tracker caught up when the pose after it has come this share of what was asked for: of a robot that was held and
/// let go, at most half.
const CAUGHT_UP: f64 = 0.75;
/// Equal poses up to a run's end are a tracker's fault from this number of steps on.
const AT_THE_END: usize = 3;
/// A robot nearer to a wall than its body and this may be held by it, cm: the body is no disc.
const NEAR_CM: f64 = 3.0;

/// Leaves out poses that repeat the one before although the robot moves.
pub fn check(logs: &mut Logs) -> Vec<Finding> {
    let Some(tolerance) = Tolerance::of(logs) else { return Vec::new() };
    let mut frozen = Vec::new();
    for (run, r) in logs.runs.iter().enumerate() {
        let mut from = 0;
        while from < r.rows.len() {
            let to = equal_until(r, from);
            if to > from && is_frozen(logs, &tolerance, r, from, to) {
                frozen.extend((from + 1..=to).map(|row| (run, row)));
            }
            from = to + 1;
        }
    }
    let sentence = "The tracker repeats a pose while the robot drives on: leave the pose empty where it is lost.";
    Finding::without_poses(logs, "tracker_frozen", &frozen, sentence).into_iter().collect()
}

/// The last row of those from `from` on that have one pose.
fn equal_until(run: &Run, from: usize) -> usize {
    let pose = run.rows.at(from).pose;
    let equal = run.rows.between(from + 1..run.rows.len()).take_while(|row| pose.is_some() && row.pose == pose).count();
    from + equal
}

/// Whether rows of one pose are those of a robot that moves meanwhile.
fn is_frozen(logs: &Logs, tolerance: &Tolerance, run: &Run, from: usize, to: usize) -> bool {
    let driven = (from..to).filter(|k| tolerance.is_large(&tolerance.expected(logs, run, *k))).count();
    let (Some(stood), true) = (run.rows.at(from).pose, driven > 0) else { return false };
    let Some(next) = run.rows.get(to + 1) else {
        let sides = logs.scene.sides();
        let is_near = sides.iter().any(|side| {
            side.nearest(stood.position_cm).distance(stood.position_cm) < logs.robot.body_radius_cm + NEAR_CM
        });
        return driven >= AT_THE_END && !is_near;
    };
    let (Some(after), Some(all)) = (next.pose, tolerance.expected_between(logs, run, from, to + 1)) else {
        return driven >= AT_THE_END;
    };
    let change = stood.relative(&after);
    let Some(last) = tolerance.expected_between(logs, run, to, to + 1) else { return false };
    let jumps = !tolerance.admits_way(change.position_cm.to_array(), &last)
        || !tolerance.admits_turn(change.heading_rad, &last);
    let way = Drive { turn_rad: 0.0, ..all };
    let is_way = tolerance.is_large(&way) && change.position_cm.length() >= CAUGHT_UP * all.forward_cm.abs();
    let turn = Drive { forward_cm: 0.0, ..all };
    let is_turn =
        tolerance.is_large(&turn) && change.heading_rad * all.turn_rad.signum() >= CAUGHT_UP * all.turn_rad.abs();
    jumps || is_way || is_turn
}
