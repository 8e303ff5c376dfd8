//! Checks for a tracker that repeats its last pose while the robot moves, and then catches up.

use super::finding::Finding;
use super::segments::Displacement;
use super::tolerance::Tolerance;
use crate::{Logs, Run};

/// The tracker has caught up if the next pose covers this fraction of the commanded motion; a robot that was held and let go
/// covers at most half.
const CAUGHT_UP: f64 = 0.75;
/// Equal poses up to the end of a run count as frozen from this number of steps on.
const MIN_STEPS_AT_END: usize = 3;
/// A wall this close to the body may hold the robot, cm, since the body is not exactly a disc.
const NEAR_CM: f64 = 3.0;

/// Excludes poses that repeat the one before although the robot moves.
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
    let sentence = "The tracker repeats a pose while the robot moves: leave the pose empty when tracking is lost.";
    Finding::without_poses(logs, "tracker_frozen", &frozen, sentence).into_iter().collect()
}

/// Returns the last row of the sequence from `from` on that has the same pose.
fn equal_until(run: &Run, from: usize) -> usize {
    let pose = run.rows.at(from).pose;
    let equal = run.rows.between(from + 1..run.rows.len()).take_while(|row| pose.is_some() && row.pose == pose).count();
    from + equal
}

/// Returns whether rows with one pose belong to a moving robot.
fn is_frozen(logs: &Logs, tolerance: &Tolerance, run: &Run, from: usize, to: usize) -> bool {
    let driven = (from..to).filter(|k| tolerance.is_large(&tolerance.expected(logs, run, *k))).count();
    let (Some(stood), true) = (run.rows.at(from).pose, driven > 0) else { return false };
    let Some(next) = run.rows.get(to + 1) else {
        let sides = logs.scene.sides();
        let is_near = sides.iter().any(|side| {
            side.nearest(stood.position_cm).distance(stood.position_cm) < logs.robot.body_radius_cm + NEAR_CM
        });
        return driven >= MIN_STEPS_AT_END && !is_near;
    };
    let (Some(after), Some(all)) = (next.pose, tolerance.expected_between(logs, run, from, to + 1)) else {
        return driven >= MIN_STEPS_AT_END;
    };
    let change = stood.relative(&after);
    let Some(last) = tolerance.expected_between(logs, run, to, to + 1) else { return false };
    let jumps = !tolerance.admits_length(change.position_cm.to_array(), &last)
        || !tolerance.admits_turn(change.heading_rad, &last);
    let length = Displacement { turn_rad: 0.0, ..all };
    let has_caught_up_in_length =
        tolerance.is_large(&length) && change.position_cm.length() >= CAUGHT_UP * all.forward_cm.abs();
    let turn = Displacement { forward_cm: 0.0, ..all };
    let has_caught_up_in_turn =
        tolerance.is_large(&turn) && change.heading_rad * all.turn_rad.signum() >= CAUGHT_UP * all.turn_rad.abs();
    jumps || has_caught_up_in_length || has_caught_up_in_turn
}
