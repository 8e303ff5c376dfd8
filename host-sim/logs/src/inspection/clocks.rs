//! Clocks: runs whose time is in seconds or at another rate, and commands that stand beside the motion of another time.

use super::finding::{Finding, Handling, Part, Place};
use super::ways::{FEWEST, asked, is_broken, one_in};
use crate::{Logs, Robot, Row, Run};
use mindgap_foundations::geometry::wrap_rad;
use mindgap_foundations::statistics::summary::median;

/// Rows of a run are this far off the usual time when they are at another rate, as for the logs as a whole.
const RATE_TOLERANCE: f64 = 0.2;
/// Motion follows a command within this time, ms: brick, link and camera together take no second.
const LATEST_MS: f64 = 1000.0;
/// How far a clock is sought before and behind, ms: farther off, commands that repeat fit by chance.
const SOUGHT_MS: f64 = 5000.0;
/// Clocks are sought in steps of this, ms, or of a row where rows are farther apart: a camera's frame or two do no harm.
const SOUGHT_EVERY_MS: f64 = 200.0;
/// The least correlation of motion with the commands of another time,
const LEAST_CORRELATION: f64 = 0.7;
/// and the largest share of what is unexplained as it is that is left then: half the scatter.
const LEFT: f64 = 0.25;
/// A number beyond this multiple of the median counts as the multiple, so that jumps do not matter.
const CLIPPED: f64 = 5.0;

/// Runs in seconds are put right; those at another rate are left out.
pub fn rates(logs: &mut Logs) -> Vec<Finding> {
    let rate = |run: &Run| median(run.rows.pairs().map(|pair| pair[1].t_ms - pair[0].t_ms)) / logs.robot.step_ms;
    let is_at = |rate: f64, factor: f64| (rate / factor - 1.0).abs() <= RATE_TOLERANCE;
    let rates: Vec<f64> = logs.runs.iter().map(rate).collect();
    let (seconds, right): (Vec<bool>, Vec<bool>) = rates.iter().map(|r| (is_at(*r, 0.001), is_at(*r, 1.0))).unzip();
    let mut findings = Vec::new();
    if seconds.contains(&true) {
        for (run, _) in logs.runs.iter_mut().zip(&seconds).filter(|(_, is_meant)| **is_meant) {
            run.rows.edit_each(|row| row.t_ms *= 1000.0);
        }
        findings.push(Finding {
            id: "clock_seconds",
            places: whole(logs, &seconds),
            handling: Handling::PutRight,
            withholds: &[],
            sentence: "Some runs count seconds as t_ms: write milliseconds.".into(),
        });
    }
    let other: Vec<bool> = seconds.iter().zip(&right).map(|(s, r)| !s && !r).collect();
    findings.extend(leave_out(logs, &other, "clock_rate", |step_ms| {
        format!("Some runs' rows are not about {step_ms} ms apart as robot.toml says: write rows that are.")
    }));
    findings
}

/// Commands that fit the motion of another time: such runs are left out, unless most are such.
pub fn shifts(logs: &mut Logs) -> Vec<Finding> {
    let whole = shift(logs, &logs.runs.iter().collect::<Vec<_>>());
    if let Some(ms) = whole {
        return vec![Finding {
            id: "clock_shifted",
            places: Place::all(logs),
            handling: Handling::Told,
            withholds: &[Part::Motion],
            sentence: shifted("Commands stand", ms),
        }];
    }
    let of_runs: Vec<Option<f64>> = logs.runs.iter().map(|run| shift(logs, &[run])).collect();
    let Some(first) = of_runs.iter().copied().flatten().next() else { return Vec::new() };
    let shifted_runs: Vec<bool> = of_runs.iter().map(Option::is_some).collect();
    leave_out(logs, &shifted_runs, "clock_shifted", |_| shifted("Some runs' commands stand", first))
        .into_iter()
        .collect()
}

fn shifted(what: &str, ms: f64) -> String {
    let (ms, way) = (ms.abs(), if ms < 0.0 { "behind" } else { "ahead of" });
    format!("{what} {ms:.0} ms {way} the motion that they cause: give commands and poses one clock.")
}

/// Leaves out runs, or tells them where they are not the fewer.
fn leave_out(
    logs: &mut Logs,
    is_meant: &[bool],
    id: &'static str,
    sentence: impl FnOnce(f64) -> String,
) -> Option<Finding> {
    let count = is_meant.iter().filter(|meant| **meant).count();
    if count == 0 {
        return None;
    }
    let are_fewer = 2 * count < is_meant.len();
    let found = Finding {
        id,
        places: whole(logs, is_meant),
        handling: if are_fewer { Handling::LeftOut } else { Handling::Told },
        withholds: if are_fewer { &[] } else { &[Part::Motion] },
        sentence: sentence(logs.robot.step_ms),
    };
    if are_fewer {
        let mut meant = is_meant.iter();
        logs.runs.retain(|_| meant.next() == Some(&false));
    }
    Some(found)
}

fn whole(logs: &Logs, is_meant: &[bool]) -> Vec<Place> {
    let places = Place::all(logs).into_iter().zip(is_meant);
    places.filter(|(_, meant)| **meant).map(|(place, _)| place).collect()
}

/// By how much time, ms, commands have to be moved to fit the motion of runs; none where they fit as they are.
fn shift(logs: &Logs, runs: &[&Run]) -> Option<f64> {
    let every = libm::round(2.0 * SOUGHT_EVERY_MS / logs.robot.step_ms).max(1.0);
    let times = |ms: f64| libm::floor(2.0 * ms / (every * logs.robot.step_ms)) as isize;
    let one_in = one_in(runs.iter().map(|run| run.rows.len()).sum());
    let courses: Vec<Course> = runs.iter().map(|run| Course::of(&logs.robot, run, one_in)).collect();
    let fit = |times: isize| correlation(&logs.robot, &courses, times * every as isize);
    let as_is = (0..=times(LATEST_MS)).filter_map(fit).fold(0.0, f64::max);
    let mut best = (0, as_is);
    for times in (-times(SOUGHT_MS)..-1).chain(times(LATEST_MS) + 1..=times(SOUGHT_MS)) {
        let there = fit(times).unwrap_or(0.0);
        best = if there > best.1 { (times, there) } else { best };
    }
    let unexplained = |r: f64| 1.0 - r * r;
    let is_decisive = best.1 >= LEAST_CORRELATION && unexplained(best.1) <= LEFT * unexplained(as_is);
    (best.0 != 0 && is_decisive).then_some(best.0 as f64 * every / 2.0 * logs.robot.step_ms)
}

/// What a run was asked for, row by row, and its steps: taken from its rows once for all times at which clocks are sought.
struct Course {
    commands: Vec<[f64; 2]>,
    steps: Vec<Step>,
}

/// A step between two places, and the row at which it begins.
struct Step {
    row: usize,
    ms: f64,
    length_cm: f64,
    turn_rad: f64,
}

impl Course {
    /// Of a run, with one step in so many.
    fn of(robot: &Robot, run: &Run, one_in: usize) -> Self {
        let step = |(row, [from, to]): (usize, [Row; 2])| {
            let (a, b) = from.pose.zip(to.pose)?;
            let length_cm = a.position_cm.distance(b.position_cm);
            let turn_rad = wrap_rad(b.heading_rad - a.heading_rad);
            let is_whole = !is_broken(robot, from.t_ms, to.t_ms);
            is_whole.then_some(Step { row, ms: to.t_ms - from.t_ms, length_cm, turn_rad })
        };
        Course {
            commands: run.rows.iter().map(|row| row.command()).collect(),
            steps: run.rows.pairs().enumerate().step_by(one_in).filter_map(step).collect(),
        }
    }
}

/// How motion correlates with the commands so many halves of a row before, the mean of length and turn; none of too few steps.
/// Reversed turns are a frame's fault and not a clock's.
fn correlation(robot: &Robot, courses: &[Course], halves: isize) -> Option<f64> {
    let mut pairs: [Vec<[f64; 2]>; 2] = [Vec::new(), Vec::new()];
    for Course { commands, steps } in courses {
        for step in steps {
            let commanded = |half: isize| {
                let row = step.row.checked_add_signed(-(half.div_euclid(2)))?;
                Some(asked(robot, *commands.get(row)?, step.ms))
            };
            let Some((one, other)) = commanded(halves).zip(commanded(halves + 1)) else { continue };
            let forward_cm = (one.forward_cm + other.forward_cm) / 2.0;
            pairs[0].push([forward_cm.abs(), step.length_cm]);
            pairs[1].push([(one.turn_rad + other.turn_rad) / 2.0, step.turn_rad]);
        }
    }
    if pairs[0].len() < FEWEST {
        return None;
    }
    let [length, turn] = pairs.map(|pairs| pearson(&clipped(pairs)));
    match (length, turn) {
        (Some(length), Some(turn)) => Some((length + turn.abs()) / 2.0),
        (one, other) => one.or(other.map(f64::abs)),
    }
}

fn clipped(mut pairs: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    let most = CLIPPED * median(pairs.iter().map(|[_, moved]| moved.abs()));
    pairs.iter_mut().for_each(|[_, moved]| *moved = moved.clamp(-most, most));
    pairs
}

/// Pearson's correlation; none where one side does not vary.
fn pearson(pairs: &[[f64; 2]]) -> Option<f64> {
    let n = pairs.len() as f64;
    let mean = |i: usize| pairs.iter().map(|pair| pair[i]).sum::<f64>() / n;
    let means = [mean(0), mean(1)];
    let moment = |i: usize, j: usize| pairs.iter().map(|pair| (pair[i] - means[i]) * (pair[j] - means[j])).sum::<f64>();
    let scale = libm::sqrt(moment(0, 0) * moment(1, 1));
    (scale > 0.0).then(|| moment(0, 1) / scale)
}
