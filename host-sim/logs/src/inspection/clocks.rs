//! Checks clocks: runs with times in seconds or at another rate, and commands shifted in time against the motion.

use super::finding::{Finding, Handling, Part, RunRows};
use super::segments::{MIN_SAMPLES, commanded, is_gap, stride};
use crate::{Logs, Robot, Row, Run};
use mindgap_foundations::geometry::wrap_rad;
use mindgap_foundations::statistics::summary::median;

/// Relative deviation of a run's row interval that counts as another rate, as for the logs as a whole.
const RATE_TOLERANCE: f64 = 0.2;
/// Motion follows a command within this time, ms: brick, radio link and camera together take less than a second.
const MAX_LATENCY_MS: f64 = 1000.0;
/// Largest clock shift tried in either direction, ms: beyond it, repeated commands fit by chance.
const MAX_SHIFT_MS: f64 = 5000.0;
/// Increment of the tried clock shifts, ms, or one row if rows are farther apart: a camera frame or two do no harm.
const SHIFT_STEP_MS: f64 = 200.0;
/// Minimum correlation of motion with shifted commands for a shift to count.
const MIN_CORRELATION: f64 = 0.7;
/// A shift must reduce the unexplained variance at least to this fraction: half the scatter.
const MAX_REMAINING_VARIANCE: f64 = 0.25;
/// Motion is clipped to this multiple of its median, so that jumps do not dominate the correlation.
const CLIP: f64 = 5.0;

/// Corrects runs with times in seconds and excludes those at another rate.
pub fn rates(logs: &mut Logs) -> Vec<Finding> {
    let rate = |run: &Run| median(run.rows.pairs().map(|pair| pair[1].t_ms - pair[0].t_ms)) / logs.robot.step_ms;
    let is_near = |rate: f64, factor: f64| (rate / factor - 1.0).abs() <= RATE_TOLERANCE;
    let rates: Vec<f64> = logs.runs.iter().map(rate).collect();
    let (in_seconds, expected): (Vec<bool>, Vec<bool>) =
        rates.iter().map(|r| (is_near(*r, 0.001), is_near(*r, 1.0))).unzip();
    let mut findings = Vec::new();
    if in_seconds.contains(&true) {
        for (run, _) in logs.runs.iter_mut().zip(&in_seconds).filter(|(_, is_affected)| **is_affected) {
            run.rows.scale_times(1000.0);
        }
        findings.push(Finding {
            id: "clock_seconds",
            rows_by_run: affected_rows(logs, &in_seconds),
            handling: Handling::Corrected,
            withholds: &[],
            sentence: "Some runs give t_ms in seconds: write milliseconds.".into(),
        });
    }
    let at_other_rate: Vec<bool> = in_seconds.iter().zip(&expected).map(|(s, r)| !s && !r).collect();
    findings.extend(exclude(logs, &at_other_rate, "clock_rate", |step_ms| {
        format!("The rows of some runs are not about {step_ms} ms apart, as robot.toml states: log at that interval.")
    }));
    findings
}

/// Excludes runs whose commands fit the motion at a shifted time, unless most runs do.
pub fn shifts(logs: &mut Logs) -> Vec<Finding> {
    let common = shift(logs, &logs.runs.iter().collect::<Vec<_>>());
    if let Some(ms) = common {
        return vec![Finding {
            id: "clock_shifted",
            rows_by_run: RunRows::all(logs),
            handling: Handling::Reported,
            withholds: &[Part::Motion],
            sentence: shift_sentence("Commands are", ms),
        }];
    }
    let by_run: Vec<Option<f64>> = logs.runs.iter().map(|run| shift(logs, &[run])).collect();
    let Some(first) = by_run.iter().copied().flatten().next() else { return Vec::new() };
    let shifted_runs: Vec<bool> = by_run.iter().map(Option::is_some).collect();
    exclude(logs, &shifted_runs, "clock_shifted", |_| shift_sentence("In some runs, commands are", first))
        .into_iter()
        .collect()
}

fn shift_sentence(what: &str, ms: f64) -> String {
    let (ms, direction) = (ms.abs(), if ms < 0.0 { "behind" } else { "ahead of" });
    format!("{what} {ms:.0} ms {direction} the motion that they cause: use one clock for commands and poses.")
}

/// Excludes the affected runs, or only reports them if they are not a minority.
fn exclude(
    logs: &mut Logs,
    is_affected: &[bool],
    id: &'static str,
    sentence: impl FnOnce(f64) -> String,
) -> Option<Finding> {
    let count = is_affected.iter().filter(|affected| **affected).count();
    if count == 0 {
        return None;
    }
    let is_minority = 2 * count < is_affected.len();
    let found = Finding {
        id,
        rows_by_run: affected_rows(logs, is_affected),
        handling: if is_minority { Handling::Excluded } else { Handling::Reported },
        withholds: if is_minority { &[] } else { &[Part::Motion] },
        sentence: sentence(logs.robot.step_ms),
    };
    if is_minority {
        let mut affected = is_affected.iter();
        logs.runs.retain(|_| affected.next() == Some(&false));
    }
    Some(found)
}

fn affected_rows(logs: &Logs, is_affected: &[bool]) -> Vec<RunRows> {
    let rows_by_run = RunRows::all(logs).into_iter().zip(is_affected);
    rows_by_run.filter(|(_, affected)| **affected).map(|(rows, _)| rows).collect()
}

/// Returns the time, ms, by which commands must be shifted to fit the motion of runs; `None` if they fit as they are.
fn shift(logs: &Logs, runs: &[&Run]) -> Option<f64> {
    let half_steps = libm::round(2.0 * SHIFT_STEP_MS / logs.robot.step_ms).max(1.0);
    let times = |ms: f64| libm::floor(2.0 * ms / (half_steps * logs.robot.step_ms)) as isize;
    let stride = stride(runs.iter().map(|run| run.rows.len()).sum());
    let samples: Vec<RunSamples> = runs.iter().map(|run| RunSamples::of(&logs.robot, run, stride)).collect();
    let fit = |times: isize| correlation(&logs.robot, &samples, times * half_steps as isize);
    let unshifted = (0..=times(MAX_LATENCY_MS)).filter_map(fit).fold(0.0, f64::max);
    let mut best = (0, unshifted);
    for times in (-times(MAX_SHIFT_MS)..-1).chain(times(MAX_LATENCY_MS) + 1..=times(MAX_SHIFT_MS)) {
        let correlation_there = fit(times).unwrap_or(0.0);
        best = if correlation_there > best.1 { (times, correlation_there) } else { best };
    }
    let unexplained = |r: f64| 1.0 - r * r;
    let is_decisive =
        best.1 >= MIN_CORRELATION && unexplained(best.1) <= MAX_REMAINING_VARIANCE * unexplained(unshifted);
    (best.0 != 0 && is_decisive).then_some(best.0 as f64 * half_steps / 2.0 * logs.robot.step_ms)
}

/// Commands and steps of a run, extracted once for all tried shifts.
struct RunSamples {
    commands: Vec<[f64; 2]>,
    steps: Vec<Step>,
}

/// A step between two poses, and the row at which it starts.
struct Step {
    row: usize,
    ms: f64,
    length_cm: f64,
    turn_rad: f64,
}

impl RunSamples {
    /// Extracts the commands and every `stride`-th step of a run.
    fn of(robot: &Robot, run: &Run, stride: usize) -> Self {
        let step = |(row, [from, to]): (usize, [Row; 2])| {
            let (a, b) = from.pose.zip(to.pose)?;
            let length_cm = a.position_cm.distance(b.position_cm);
            let turn_rad = wrap_rad(b.heading_rad - a.heading_rad);
            let is_whole = !is_gap(robot, from.t_ms, to.t_ms);
            is_whole.then_some(Step { row, ms: to.t_ms - from.t_ms, length_cm, turn_rad })
        };
        RunSamples {
            commands: run.rows.iter().map(|row| row.command()).collect(),
            steps: run.rows.pairs().enumerate().step_by(stride).filter_map(step).collect(),
        }
    }
}

/// Returns the correlation of motion with the commands `halves` half rows earlier, averaged over length and turn; `None` with
/// too few steps. Reversed turns are a defect of the frame, not of the clock, so the sign of the turn is ignored.
fn correlation(robot: &Robot, samples: &[RunSamples], halves: isize) -> Option<f64> {
    let mut pairs: [Vec<[f64; 2]>; 2] = [Vec::new(), Vec::new()];
    for RunSamples { commands, steps } in samples {
        for step in steps {
            let command_at = |half: isize| {
                let row = step.row.checked_add_signed(-(half.div_euclid(2)))?;
                Some(commanded(robot, *commands.get(row)?, step.ms))
            };
            let Some((first, second)) = command_at(halves).zip(command_at(halves + 1)) else { continue };
            let forward_cm = (first.forward_cm + second.forward_cm) / 2.0;
            pairs[0].push([forward_cm.abs(), step.length_cm]);
            pairs[1].push([(first.turn_rad + second.turn_rad) / 2.0, step.turn_rad]);
        }
    }
    if pairs[0].len() < MIN_SAMPLES {
        return None;
    }
    let [length, turn] = pairs.map(|pairs| pearson(&clipped(pairs)));
    match (length, turn) {
        (Some(length), Some(turn)) => Some((length + turn.abs()) / 2.0),
        (first, second) => first.or(second.map(f64::abs)),
    }
}

fn clipped(mut pairs: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    let limit = CLIP * median(pairs.iter().map(|[_, moved]| moved.abs()));
    pairs.iter_mut().for_each(|[_, moved]| *moved = moved.clamp(-limit, limit));
    pairs
}

/// Returns Pearson's correlation; `None` if either variable is constant.
fn pearson(pairs: &[[f64; 2]]) -> Option<f64> {
    let n = pairs.len() as f64;
    let mean = |i: usize| pairs.iter().map(|pair| pair[i]).sum::<f64>() / n;
    let means = [mean(0), mean(1)];
    let moment = |i: usize, j: usize| pairs.iter().map(|pair| (pair[i] - means[i]) * (pair[j] - means[j])).sum::<f64>();
    let scale = libm::sqrt(moment(0, 0) * moment(1, 1));
    (scale > 0.0).then(|| moment(0, 1) / scale)
}
