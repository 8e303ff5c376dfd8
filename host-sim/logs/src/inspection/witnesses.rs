//! Checks what the robot measures of its own motion: rotation counters that wrap, jump, run backwards or count something else,
//! and a gyro with another sign or unit. Such columns are left out, and the rest of the logs is compared without them.

use std::f64::consts::PI;

use super::finding::{Finding, Handling, RunRows};
use super::segments::{MIN_SAMPLES, commanded, is_gap};
use crate::{Logs, Row, samples};
use mindgap_foundations::geometry::wrap_rad;
use mindgap_foundations::statistics::summary::robust_slope;

/// A wheel does not turn faster than this multiple of full speed.
const FASTEST: f64 = 2.0;
/// Counters that stay within a turn although the wheels were commanded this many start again after each.
const TURNS: f64 = 4.0;
/// Counted per commanded rotation, and gyro per tracked turn, within which a unit is right. A gear that was not divided by lies
/// beyond for most motors, and units do by far.
const PLAUSIBLE: std::ops::Range<f64> = 0.2..5.0;
/// The factor by which a gyro in radians per second is too small, and how near to it one has to be.
const RADIANS: f64 = PI / 180.0;
const WITHIN: f64 = 2.0;

/// Leaves out counters and gyros that cannot be right.
pub fn check(logs: &mut Logs) -> Vec<Finding> {
    let mut findings: Vec<Finding> = SIDES.iter().flat_map(|side| counter(logs, side)).collect();
    findings.extend(gyro(logs));
    findings
}

/// One of the two counters.
struct Side {
    index: usize,
    name: &'static str,
    get: fn(&Row) -> Option<f64>,
    clear: fn(&mut Row),
}

const SIDES: [Side; 2] = [
    Side { index: 0, name: "rot_left_deg", get: |row| row.rot_left_deg, clear: |row| row.rot_left_deg = None },
    Side { index: 1, name: "rot_right_deg", get: |row| row.rot_right_deg, clear: |row| row.rot_right_deg = None },
];

fn counter(logs: &mut Logs, side: &Side) -> Vec<Finding> {
    if wraps_each_turn(logs, side) {
        let what = format!("{} starts again after each turn: write the sum of all turns.", side.name);
        return vec![without(logs, "counter_wraps", side.get, side.clear, what)];
    }
    // A counter in another unit jumps in nearly every row.
    if let Some(gain) = counted_per_commanded(logs, side)
        && gain >= 0.0
        && !PLAUSIBLE.contains(&gain)
    {
        let what = format!(
            "{} counts {gain:.3} of the commanded rotation: write degrees of the wheel, not of the motor, and check \
             wheel_diameter_cm.",
            side.name
        );
        return vec![without(logs, "counter_unit", side.get, side.clear, what)];
    }
    let jumps = jumps(logs, side);
    let mut findings = Vec::new();
    if !jumps.is_empty() {
        let rows_by_run = RunRows::group(logs, &jumps);
        jumps.iter().for_each(|(run, row)| logs.runs[*run].rows.edit(*row, side.clear));
        let sentence = format!(
            "{} jumps farther than the wheel can turn, as a counter does that is reset or overflows: write the sum of all turns.",
            side.name
        );
        findings.push(Finding {
            id: "counter_jump",
            rows_by_run,
            handling: Handling::Excluded,
            withholds: &[],
            sentence,
        });
    }
    if counted_per_commanded(logs, side).is_some_and(|gain| gain < 0.0) {
        let what = format!("{} falls while the wheel is commanded forwards: change its sign.", side.name);
        findings.push(without(logs, "counter_backwards", side.get, side.clear, what));
    }
    findings
}

/// Returns the degrees that a wheel turns in a time if its rim moves at the speed of a command.
fn commanded_deg(logs: &Logs, command: f64, ms: f64) -> f64 {
    let robot = &logs.robot;
    command / 100.0 * robot.full_speed_cm_s * ms / 1000.0 * 360.0 / (PI * robot.wheel_diameter_cm)
}

fn wraps_each_turn(logs: &Logs, side: &Side) -> bool {
    let counted = || logs.runs.iter().flat_map(|run| &run.rows).filter_map(|row| (side.get)(&row));
    let (low, high) = counted().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), deg| (l.min(deg), h.max(deg)));
    let way_deg = logs
        .runs
        .iter()
        .flat_map(|run| run.rows.pairs())
        .map(|[from, to]| commanded_deg(logs, from.command()[side.index], to.t_ms - from.t_ms).abs());
    // A robot that only rocks to and fro stays within a turn too, without a jump of most of a turn.
    let is_wrap = |[from, to]: [Row; 2]| {
        let change = (side.get)(&from).zip((side.get)(&to)).map_or(0.0, |(from, to)| (to - from).abs());
        change > 180.0
    };
    low < high
        && high - low <= 361.0
        && way_deg.sum::<f64>() > 360.0 * TURNS
        && logs.runs.iter().flat_map(|run| run.rows.pairs()).any(is_wrap)
}

/// Returns run and index of the rows whose count is farther from that of the row before than the wheel can turn.
fn jumps(logs: &Logs, side: &Side) -> Vec<(usize, usize)> {
    let mut jumps = Vec::new();
    for (run, logged) in logs.runs.iter().enumerate() {
        for (k, [from, to]) in logged.rows.pairs().enumerate() {
            let Some((begin, end)) = (side.get)(&from).zip((side.get)(&to)) else { continue };
            if (end - begin).abs() > FASTEST * commanded_deg(logs, 100.0, to.t_ms - from.t_ms) {
                jumps.push((run, k + 1));
            }
        }
    }
    jumps
}

fn counted_per_commanded(logs: &Logs, side: &Side) -> Option<f64> {
    let mut pairs = Vec::new();
    for run in &logs.runs {
        for [from, to] in run.rows.pairs() {
            let counted = (side.get)(&from).zip((side.get)(&to));
            let commanded = commanded_deg(logs, from.command()[side.index], to.t_ms - from.t_ms);
            pairs.extend(counted.filter(|_| commanded != 0.0).map(|(begin, end)| (end - begin, commanded)));
        }
    }
    (pairs.len() >= MIN_SAMPLES).then(|| robust_slope(pairs.into_iter())).flatten()
}

fn gyro(logs: &mut Logs) -> Option<Finding> {
    let pairs = gyro_and_turn(logs);
    let gain = (pairs.len() >= MIN_SAMPLES).then(|| robust_slope(pairs.into_iter())).flatten()?;
    let (id, what) = if (RADIANS / WITHIN..RADIANS * WITHIN).contains(&gain.abs()) {
        ("gyro_unit", "gyro_deg_s is in radians per second: write degrees per second.".into())
    } else if gain < 0.0 {
        ("gyro_sign", "gyro_deg_s is negative in turns to the left: change its sign.".into())
    } else if !PLAUSIBLE.contains(&gain) {
        ("gyro_unit", format!("gyro_deg_s shows {gain:.3} of the turn: write degrees per second."))
    } else {
        return None;
    };
    Some(without(logs, id, |row| row.gyro_deg_s, |row| row.gyro_deg_s = None, what))
}

/// Returns pairs for each step: the mean of the gyro at both ends, and the turn rate by the poses, or else by the counters, or
/// else by the commands, degrees per second.
fn gyro_and_turn(logs: &Logs) -> Vec<(f64, f64)> {
    let has_poses = !samples::motion(logs).is_empty();
    let mut pairs = Vec::new();
    for run in &logs.runs {
        for (k, [from, to]) in run.rows.pairs().enumerate() {
            let ms = to.t_ms - from.t_ms;
            let Some((begin, end)) = from.gyro_deg_s.zip(to.gyro_deg_s) else { continue };
            if is_gap(&logs.robot, from.t_ms, to.t_ms) {
                continue;
            }
            let turn_rad = if has_poses {
                from.pose.zip(to.pose).map(|(from, to)| wrap_rad(to.heading_rad - from.heading_rad))
            } else {
                let counted = samples::wheels_cm(&logs.robot, run, k);
                let counted =
                    counted.map(|[left, right]| (right - left) / logs.robot.track_cm * ms / logs.robot.step_ms);
                counted.or_else(|| Some(commanded(&logs.robot, from.command(), ms).turn_rad))
            };
            let rate = turn_rad.map(|turn_rad| turn_rad.to_degrees() / ms * 1000.0).filter(|rate| *rate != 0.0);
            pairs.extend(rate.map(|rate| (0.5 * (begin + end), rate)));
        }
    }
    pairs
}

/// Clears a column and returns the finding about it.
fn without(
    logs: &mut Logs,
    id: &'static str,
    get: fn(&Row) -> Option<f64>,
    clear: fn(&mut Row),
    sentence: String,
) -> Finding {
    let rows = logs.runs.iter().enumerate().flat_map(|(run, logged)| {
        logged.rows.iter().enumerate().filter(|(_, row)| get(row).is_some()).map(move |(k, _)| (run, k))
    });
    let rows_by_run = RunRows::group(logs, &rows.collect::<Vec<_>>());
    logs.runs.iter_mut().for_each(|run| run.rows.edit_each(clear));
    Finding { id, rows_by_run, handling: Handling::Excluded, withholds: &[], sentence }
}
