//! Positions that jump farther than the robot can drive.

use super::chain::cheapest;
use super::finding::Finding;
use super::tolerance::Tolerance;
use crate::Logs;
use mindgap_foundations::geometry::{direction, wrap_rad};

/// Leaves out rows to which the tracker jumps, and the first one after a jump that stays.
pub fn check(logs: &mut Logs) -> Vec<Finding> {
    let Some(tolerance) = Tolerance::of(logs) else { return Vec::new() };
    let mut jumped = Vec::new();
    for (run, r) in logs.runs.iter().enumerate() {
        let posed: Vec<usize> = (0..r.rows.len()).filter(|k| r.rows.at(*k).pose.is_some()).collect();
        let follows = |[from, _]: [usize; 2], [to, _]: [usize; 2]| {
            let (begin, end) = (posed[from], posed[to]);
            let expected = tolerance.expected_between(logs, r, begin, end);
            let (Some(expected), Some(a), Some(b)) = (expected, r.rows.at(begin).pose, r.rows.at(end).pose) else {
                return Some(0.0);
            };
            let change_cm = b.position_cm - a.position_cm;
            let halfway_rad = a.heading_rad + wrap_rad(b.heading_rad - a.heading_rad) / 2.0;
            let local_cm = direction(-halfway_rad).rotate(change_cm);
            // Of several steps only the length is known: they may turn on the way.
            let along_cm = if end == begin + 1 {
                local_cm.to_array()
            } else {
                [change_cm.length() * expected.forward_cm.signum(), 0.0]
            };
            tolerance.admits_way(along_cm, &expected).then_some(0.0)
        };
        let read = cheapest::<1>(posed.len(), |_, _| 0.0, follows);
        jumped.extend(posed.iter().zip(read).filter(|(_, kept)| kept.is_none_or(|k| k.breaks)).map(|(k, _)| (run, *k)));
    }
    let sentence =
        "The tracker jumps farther than the robot can drive: leave the pose empty where the tracker is lost.";
    Finding::without_poses(logs, "tracker_jump", &jumped, sentence).into_iter().collect()
}
