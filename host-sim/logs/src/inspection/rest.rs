//! Rest: motion at zero commands, and runs that do not begin at rest.

use super::finding::Finding;
use super::tolerance::Tolerance;
use super::ways::{Drive, asked, is_broken};
use crate::{Logs, Run};
use mindgap_foundations::statistics::summary::median;

/// A robot whose commands have been zero for this long has come to rest, ms.
const STILL_MS: f64 = 1000.0;
/// So many steps of it one after the other: a jump there and back has two.
const FEWEST_STEPS: usize = 3;
/// The least share of a step that the command before it decides where it can be told whether a robot began at rest.
const LATE: f64 = 0.2;
/// The least share of the log's fastest step from which a first step is judged: runs may begin slowly.
const ENOUGH: f64 = 0.1;
/// The fewest runs whose beginnings tell it.
const FEWEST_RUNS: usize = 5;

/// Leaves out poses where the robot moves though its commands have been zero for long: somebody else moved it, or another
/// program. Logs without any command are of a sensor that is carried, and stay.
pub fn moves_at_zero_command(logs: &mut Logs) -> Vec<Finding> {
    let Some(tolerance) = Tolerance::of(logs) else { return Vec::new() };
    let mut moved = Vec::new();
    for (run, r) in logs.runs.iter().enumerate() {
        let steps: Vec<usize> = (0..r.rows.len() - 1).filter(|k| is_moved(&tolerance, r, *k)).collect();
        for stretch in steps.chunk_by(|a, b| a + 1 == *b).filter(|stretch| stretch.len() >= FEWEST_STEPS) {
            moved.extend(stretch.iter().skip(1).map(|k| (run, *k)));
        }
    }
    let sentence =
        "The robot moves though its commands have been zero for long: log what drives it, or leave the poses out.";
    Finding::without_poses(logs, "moves_at_zero_command", &moved, sentence).into_iter().collect()
}

fn is_moved(tolerance: &Tolerance, run: &Run, k: usize) -> bool {
    let (Some(from), Some(to)) = (run.rows.at(k).pose, run.rows.at(k + 1).pose) else { return false };
    let mut lately = run.rows.between(0..k + 1).rev().take_while(|row| run.rows.at(k).t_ms - row.t_ms <= STILL_MS);
    let is_still = lately.all(|row| row.command() == [0.0; 2]);
    let change = from.relative(&to);
    let moved = Drive { forward_cm: change.position_cm.length(), turn_rad: change.heading_rad };
    is_still && tolerance.is_large(&moved)
}

/// Leaves out the first pose of runs that begin in motion, where motors are taken to start from rest.
pub fn starts_moving(logs: &mut Logs) -> Vec<Finding> {
    let Some(tolerance) = Tolerance::of(logs) else { return Vec::new() };
    let all = tolerance.forward.iter().sum::<f64>();
    let late = 1.0 - tolerance.forward[0] / all;
    // From rest a step comes to what is not late; halfway between that and all of it lies the threshold.
    let is_moving = |share: f64| share > 1.0 - late / 2.0;
    let shares: Vec<Option<f64>> = logs.runs.iter().map(|run| share(logs, run, &tolerance, all)).collect();
    let is_told = shares.iter().flatten().count() >= FEWEST_RUNS;
    if !(LATE..=1.0).contains(&late) || !is_told || !is_moving(median(shares.iter().copied().flatten())) {
        return Vec::new();
    }
    // Runs that do not tell are taken to begin as most do.
    let begins = logs.runs.iter().zip(&shares).enumerate();
    let moving = begins.filter(|(_, (run, share))| run.rows.at(0).pose.is_some() && share.is_none_or(is_moving));
    let moving: Vec<(usize, usize)> = moving.map(|(run, _)| (run, 0)).collect();
    let sentence = "Runs begin while the robot moves: begin them at rest, with the first command.";
    Finding::without_poses(logs, "starts_moving", &moving, sentence).into_iter().collect()
}

/// How far a run's first step goes, against what its command comes to once it acts in full.
fn share(logs: &Logs, run: &Run, tolerance: &Tolerance, all: f64) -> Option<f64> {
    let (from, to) = (run.rows.at(0).pose?, run.rows.at(1).pose?);
    let ms = run.rows.at(1).t_ms - run.rows.at(0).t_ms;
    let full_cm = all * asked(&logs.robot, run.rows.at(0).command(), ms).forward_cm;
    let is_enough = !is_broken(&logs.robot, run.rows.at(0).t_ms, run.rows.at(1).t_ms)
        && full_cm.abs() >= ENOUGH * tolerance.fastest.forward_cm;
    is_enough.then(|| from.relative(&to).position_cm.x / full_cm)
}
