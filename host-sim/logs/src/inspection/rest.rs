//! Checks for motion at zero commands, and for runs that do not start at rest.

use super::finding::Finding;
use super::segments::{Displacement, commanded, is_gap};
use super::tolerance::Tolerance;
use crate::{Logs, Run};
use mindgap_foundations::statistics::summary::median;

/// A robot is at rest once its commands have been zero for this long, ms.
const SETTLING_MS: f64 = 1000.0;
/// Minimum number of consecutive moving steps: a jump there and back has two.
const MIN_STEPS: usize = 3;
/// Minimum fraction of a step due to earlier commands: with less lag, a start at rest and one in motion look alike.
const MIN_LAG: f64 = 0.2;
/// Minimum first step to be judged, as a fraction of the fastest step in the logs: runs may start slowly.
const MIN_FIRST_STEP: f64 = 0.1;
/// Minimum number of runs with a first step that can be judged.
const MIN_RUNS: usize = 5;

/// Excludes poses where the robot moves long after its commands became zero: a person or another program moved it. Logs
/// without any commands are of a sensor that is carried, and stay.
pub fn moves_at_zero_command(logs: &mut Logs) -> Vec<Finding> {
    let Some(tolerance) = Tolerance::of(logs) else { return Vec::new() };
    let mut moved = Vec::new();
    for (run, r) in logs.runs.iter().enumerate() {
        let steps: Vec<usize> = (0..r.rows.len() - 1).filter(|k| is_moved(&tolerance, r, *k)).collect();
        for sequence in steps.chunk_by(|a, b| a + 1 == *b).filter(|sequence| sequence.len() >= MIN_STEPS) {
            moved.extend(sequence.iter().skip(1).map(|k| (run, *k)));
        }
    }
    let sentence = "The robot moves long after its commands became zero: log what drives it, or leave the poses empty.";
    Finding::without_poses(logs, "moves_at_zero_command", &moved, sentence).into_iter().collect()
}

fn is_moved(tolerance: &Tolerance, run: &Run, k: usize) -> bool {
    let (Some(from), Some(to)) = (run.rows.at(k).pose, run.rows.at(k + 1).pose) else { return false };
    let mut recent = run.rows.between(0..k + 1).rev().take_while(|row| run.rows.at(k).t_ms - row.t_ms <= SETTLING_MS);
    let is_still = recent.all(|row| row.command() == [0.0; 2]);
    let change = from.relative(&to);
    let moved = Displacement { forward_cm: change.position_cm.length(), turn_rad: change.heading_rad };
    is_still && tolerance.is_large(&moved)
}

/// Excludes the first pose of runs that start in motion, since motors are assumed to start from rest.
pub fn starts_moving(logs: &mut Logs) -> Vec<Finding> {
    let Some(tolerance) = Tolerance::of(logs) else { return Vec::new() };
    let all = tolerance.forward.iter().sum::<f64>();
    let lag = 1.0 - tolerance.forward[0] / all;
    // A first step from rest covers a share of 1 - lag, one in motion all of it; the threshold lies halfway.
    let is_moving = |share: f64| share > 1.0 - lag / 2.0;
    let shares: Vec<Option<f64>> = logs.runs.iter().map(|run| share(logs, run, &tolerance, all)).collect();
    let is_decidable = shares.iter().flatten().count() >= MIN_RUNS;
    if !(MIN_LAG..=1.0).contains(&lag) || !is_decidable || !is_moving(median(shares.iter().copied().flatten())) {
        return Vec::new();
    }
    // Runs that cannot be judged are assumed to start as most do.
    let starts = logs.runs.iter().zip(&shares).enumerate();
    let moving = starts.filter(|(_, (run, share))| run.rows.at(0).pose.is_some() && share.is_none_or(is_moving));
    let moving: Vec<(usize, usize)> = moving.map(|(run, _)| (run, 0)).collect();
    let sentence = "Runs start while the robot is moving: start them at rest, with the first command.";
    Finding::without_poses(logs, "starts_moving", &moving, sentence).into_iter().collect()
}

/// Returns the length of a run's first step relative to the full effect of its command.
fn share(logs: &Logs, run: &Run, tolerance: &Tolerance, all: f64) -> Option<f64> {
    let (from, to) = (run.rows.at(0).pose?, run.rows.at(1).pose?);
    let ms = run.rows.at(1).t_ms - run.rows.at(0).t_ms;
    let full_cm = all * commanded(&logs.robot, run.rows.at(0).command(), ms).forward_cm;
    let is_usable = !is_gap(&logs.robot, run.rows.at(0).t_ms, run.rows.at(1).t_ms)
        && full_cm.abs() >= MIN_FIRST_STEP * tolerance.fastest.forward_cm;
    is_usable.then(|| from.relative(&to).position_cm.x / full_cm)
}
