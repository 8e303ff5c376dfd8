//! Checks for headings that jump, or that are flipped by half a turn as by trackers of symmetric markers.

use std::f64::consts::{FRAC_PI_2, PI};

use super::finding::{Finding, Handling, RunRows};
use super::segments::{Displacement, LARGE};
use super::tolerance::Tolerance;
use super::viterbi::cheapest_path;
use crate::{Logs, Run};
use mindgap_foundations::geometry::{direction, wrap_rad};

/// Cost of a flipped heading, so that equal fits count as not flipped.
const FLIPPED: f64 = 0.1;
/// Cost of a persistent turn that is possible but was not commanded, as after a lost command or with a blocked wheel: more
/// than a flip, less than an excluded row.
const UNCOMMANDED: f64 = 1.2;
/// Cost of moving against the heading: less than a flip there and back, since one step may slip.
const AGAINST: f64 = 0.6;

/// Corrects flipped headings and excludes rows whose heading jumps otherwise.
pub fn check(logs: &mut Logs) -> Vec<Finding> {
    let Some(tolerance) = Tolerance::of(logs) else { return Vec::new() };
    let (mut flipped, mut jumped) = (Vec::new(), Vec::new());
    for (run, r) in logs.runs.iter().enumerate() {
        let posed: Vec<usize> = (0..r.rows.len()).filter(|k| r.rows.at(*k).pose.is_some()).collect();
        let heading_rad = |[at, state]: [usize; 2]| {
            r.rows.at(posed[at]).pose.map_or(0.0, |pose| pose.heading_rad) + PI * state as f64
        };
        let turn = |begin: usize, end: usize| tolerance.expected_between(logs, r, begin, end);
        let follows = |from: [usize; 2], to: [usize; 2]| {
            let (begin, end) = (posed[from[0]], posed[to[0]]);
            let turn_rad = heading_rad(to) - heading_rad(from);
            if turn(begin, end).is_none_or(|expected| tolerance.admits_turn(turn_rad, &expected)) {
                return Some(0.0);
            }
            // A wrong heading reverts with the next row; a turn persists.
            let admits = |[a, b]: [usize; 2]| {
                let turn_rad = heading_rad([b, to[1]]) - heading_rad([a, from[1]]);
                turn(posed[a], posed[b]).is_some_and(|expected| tolerance.admits_turn(turn_rad, &expected))
            };
            let reverts =
                from[0] > 0 && admits([from[0] - 1, to[0]]) || to[0] + 1 < posed.len() && admits([from[0], to[0] + 1]);
            (end == begin + 1 && !reverts && tolerance.is_within_reach(turn_rad)).then_some(UNCOMMANDED)
        };
        let goes_against: Vec<Option<bool>> = posed.iter().map(|k| goes_against(logs, &tolerance, r, *k)).collect();
        let cost = |at: usize, state: usize| {
            let is_against = goes_against[at].is_some_and(|against| against == (state == 0));
            FLIPPED * state as f64 + if is_against { AGAINST } else { 0.0 }
        };
        for (k, kept) in posed.iter().zip(cheapest_path::<2>(posed.len(), cost, follows)) {
            match kept {
                Some(kept) if !kept.breaks => flipped.extend((kept.state == 1).then_some((run, *k))),
                _ => jumped.push((run, *k)),
            }
        }
    }
    let mut findings = Vec::new();
    if !flipped.is_empty() {
        findings.push(Finding {
            id: "heading_flipped",
            rows_by_run: RunRows::group(logs, &flipped),
            handling: Handling::Corrected,
            withholds: &[],
            sentence: "The tracker confused the robot's front and back in some rows: heading_deg is off by 180.".into(),
        });
    }
    for (run, row) in flipped {
        logs.runs[run].rows.edit_pose(row, |pose| pose.heading_rad = wrap_rad(pose.heading_rad + PI));
    }
    let sentence = "The heading jumps farther than the robot can turn: leave the pose empty when tracking is lost.";
    findings.extend(Finding::without_poses(logs, "heading_jump", &jumped, sentence));
    findings
}

/// Returns whether the step from row `k` goes against its heading; `None` if the step is too short or too curved to say.
fn goes_against(logs: &Logs, tolerance: &Tolerance, run: &Run, k: usize) -> Option<bool> {
    let (from, to) = (run.rows.at(k).pose?, run.rows.get(k + 1)?.pose?);
    let Displacement { forward_cm, turn_rad } = tolerance.expected(logs, run, k);
    let large_cm = LARGE * tolerance.fastest.forward_cm;
    let change_cm = to.position_cm - from.position_cm;
    let is_clear = forward_cm.abs() >= large_cm && turn_rad.abs() < FRAC_PI_2 && change_cm.length() >= large_cm;
    is_clear.then(|| change_cm.dot(direction(from.heading_rad + turn_rad / 2.0)) * forward_cm < 0.0)
}
