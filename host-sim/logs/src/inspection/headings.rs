//! Headings that are flipped by half a turn, as trackers of symmetric markers have them, or that jump.

use std::f64::consts::{FRAC_PI_2, PI};

use super::chain::cheapest;
use super::finding::{Finding, Handling, Place};
use super::tolerance::Tolerance;
use super::ways::{Drive, LARGE};
use crate::{Logs, Run};
use mindgap_foundations::geometry::{direction, wrap_rad};

/// What a flipped heading costs beside one that is not, so that equal fits count as not flipped.
const FLIPPED: f64 = 0.1;
/// What a turn costs that stays and that the robot can make but was not asked for, as after a lost command or where a wheel is
/// held: more than a flip, and less than a row left out.
const UNASKED: f64 = 1.2;
/// What it costs to go against the heading: less than a flip there and back, since one step may slip.
const AGAINST: f64 = 0.6;

/// Turns flipped headings back, and leaves out rows whose heading jumps otherwise.
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
            // A heading that is off comes back with the next row; a turn stays.
            let admits = |[a, b]: [usize; 2]| {
                let turn_rad = heading_rad([b, to[1]]) - heading_rad([a, from[1]]);
                turn(posed[a], posed[b]).is_some_and(|expected| tolerance.admits_turn(turn_rad, &expected))
            };
            let comes_back =
                from[0] > 0 && admits([from[0] - 1, to[0]]) || to[0] + 1 < posed.len() && admits([from[0], to[0] + 1]);
            (end == begin + 1 && !comes_back && tolerance.is_within_reach(turn_rad)).then_some(UNASKED)
        };
        let goes_against: Vec<Option<bool>> = posed.iter().map(|k| goes_against(logs, &tolerance, r, *k)).collect();
        let cost = |at: usize, state: usize| {
            let is_against = goes_against[at].is_some_and(|against| against == (state == 0));
            FLIPPED * state as f64 + if is_against { AGAINST } else { 0.0 }
        };
        for (k, kept) in posed.iter().zip(cheapest::<2>(posed.len(), cost, follows)) {
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
            places: Place::of(logs, &flipped),
            handling: Handling::PutRight,
            withholds: &[],
            sentence: "The tracker took the robot's front for its back in some rows: heading_deg is off by 180.".into(),
        });
    }
    for (run, row) in flipped {
        logs.runs[run].rows.edit_pose(row, |pose| pose.heading_rad = wrap_rad(pose.heading_rad + PI));
    }
    let sentence = "The heading jumps farther than the robot can turn: leave the pose empty where the tracker is lost.";
    findings.extend(Finding::without_poses(logs, "heading_jump", &jumped, sentence));
    findings
}

/// Whether the step from row `k` goes against its heading; none where it is too short or too crooked to
/// tell.
fn goes_against(logs: &Logs, tolerance: &Tolerance, run: &Run, k: usize) -> Option<bool> {
    let (from, to) = (run.rows.at(k).pose?, run.rows.get(k + 1)?.pose?);
    let Drive { forward_cm, turn_rad } = tolerance.expected(logs, run, k);
    let large_cm = LARGE * tolerance.fastest.forward_cm;
    let change_cm = to.position_cm - from.position_cm;
    let is_plain = forward_cm.abs() >= large_cm && turn_rad.abs() < FRAC_PI_2 && change_cm.length() >= large_cm;
    is_plain.then(|| change_cm.dot(direction(from.heading_rad + turn_rad / 2.0)) * forward_cm < 0.0)
}
