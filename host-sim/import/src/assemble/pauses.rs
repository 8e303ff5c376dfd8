//! What the base does while no commands arrive: most bases stop by themselves after a while, others drive on.

use std::str::FromStr;

use crate::clocks::{align, lag};
use crate::motion::CumulativeMotion;
use crate::recording::Commands;
use crate::report::{Determined, PausesReport};
use mindgap_foundations::statistics::summary::median;
use mindgap_logs::Robot;

use super::Stated;
use super::clock::{MAX_LAG_MS, MAX_UNEXPLAINED, commanded, shifted};
use super::rows::Prepared;

/// What a base does when commands pause.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Watchdog {
    /// It stops this long after the last command, ms.
    StopsAfter(f64),
    /// It drives on.
    None,
}

impl FromStr for Watchdog {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if text == "none" {
            return Ok(Watchdog::None);
        }
        let ms = text.parse().ok().filter(|ms: &f64| *ms >= 0.0 && *ms < 1e6);
        ms.map(Watchdog::StopsAfter).ok_or_else(|| "give a time in ms, or none".into())
    }
}

/// A pause is longer than this multiple of the usual interval between commands.
const USUAL_INTERVALS: f64 = 3.0;
/// Shorter pauses are delays of the network, ms.
const MIN_PAUSE_MS: f64 = 300.0;
/// Fewer pauses do not show what the base does.
const MIN_PAUSES: usize = 3;
/// Timeouts tried: up to this one, ms, in increments of `COARSE_MS`, then of `FINE_MS` about the best.
const MAX_TIMEOUT_MS: f64 = 3000.0;
const COARSE_MS: f64 = 100.0;
const FINE_MS: f64 = 20.0;
/// Maximum number of steps of the recording on which timeouts are tried.
const MAX_STEPS: f64 = 3000.0;
/// The base stops if that leaves at most this fraction of the motion that is unexplained if it drives on,
const MAX_REMAINING: f64 = 0.6;
/// and explains at least this fraction of all motion in addition.
const MIN_GAIN: f64 = 0.01;

/// Makes commands zero where the base stops by itself, as the user states or as the motion shows, and returns what was found;
/// `None` without pauses.
pub fn apply(prepared: &mut Prepared, robot: &Robot, is_one_clock: bool, stated: Stated) -> Option<PausesReport> {
    let pauses_ms = pauses_ms(&prepared.commands);
    let longest_ms = pauses_ms.iter().copied().fold(0.0, f64::max);
    let (watchdog, determined) = match stated.watchdog {
        Some(watchdog) => (watchdog, Determined::Stated),
        None => match inferred(prepared, robot, is_one_clock, stated, pauses_ms.len(), longest_ms) {
            Some(watchdog) => (watchdog, Determined::Inferred),
            None => (Watchdog::None, Determined::Assumed),
        },
    };
    let stops_after_ms = match watchdog {
        Watchdog::StopsAfter(ms) => Some(ms),
        Watchdog::None => None,
    };
    if let Some(ms) = stops_after_ms {
        prepared.commands = stopping(&prepared.commands, ms);
    }
    (!pauses_ms.is_empty()).then_some(PausesReport {
        number: pauses_ms.len(),
        longest_s: longest_ms / 1e3,
        stops_after_ms,
        determined,
    })
}

/// Returns the pauses while the last command asks for motion, ms.
fn pauses_ms(commands: &Commands) -> Vec<f64> {
    intervals(commands).filter(is_pause(commands)).map(|(ms, _)| ms).collect()
}

/// Returns the intervals between commands, ms, each with the command that holds in it.
fn intervals(commands: &Commands) -> impl Iterator<Item = (f64, [f64; 2])> {
    commands.samples.windows(2).map(|pair| (pair[1].0 - pair[0].0, pair[0].1))
}

/// Returns a test of intervals: whether the last command asks for motion and no other arrives for long.
fn is_pause(commands: &Commands) -> impl Fn(&(f64, [f64; 2])) -> bool + use<> {
    let least_ms = (USUAL_INTERVALS * median(intervals(commands).map(|(ms, _)| ms))).max(MIN_PAUSE_MS);
    move |(ms, command)| *ms > least_ms && *command != [0.0; 2]
}

/// Returns the commands as a base executes them that stops `after_ms` after the last one.
fn stopping(commands: &Commands, after_ms: f64) -> Commands {
    let mut samples = Vec::with_capacity(commands.samples.len());
    for (i, (ms, command)) in commands.samples.iter().enumerate() {
        samples.push((*ms, *command));
        let is_followed = commands.samples.get(i + 1).is_some_and(|(next_ms, _)| *next_ms <= ms + after_ms);
        if *command != [0.0; 2] && !is_followed {
            samples.push((ms + after_ms, [0.0; 2]));
        }
    }
    Commands { kind: commands.kind, samples }
}

/// Infers from the motion what the base does; `None` if it does not show.
fn inferred(
    prepared: &Prepared,
    robot: &Robot,
    is_one_clock: bool,
    stated: Stated,
    pauses: usize,
    longest_ms: f64,
) -> Option<Watchdog> {
    if pauses < MIN_PAUSES {
        return None;
    }
    let observed = prepared.track.motion();
    let mut track = shifted(&observed, stated.offset_ms.unwrap_or(0.0));
    let excerpt = excerpt(&prepared.commands, robot);
    let usual = watchdog(&excerpt, &track, robot, longest_ms);
    if let Some((watchdog, unexplained)) = usual
        && unexplained <= MAX_UNEXPLAINED
    {
        return Some(watchdog);
    }
    // With clocks of their own, streams are aligned first.
    if is_one_clock || stated.offset_ms.is_some() {
        return None;
    }
    let clocks = align(&commanded(&prepared.commands, robot), &observed)?.clocks;
    let on_clock_of_commands = |m: &CumulativeMotion| (m.t_ms - clocks.offset_ms) / (1.0 + clocks.drift);
    track = observed.iter().map(|m| CumulativeMotion { t_ms: on_clock_of_commands(m), ..*m }).collect();
    watchdog(&excerpt, &track, robot, longest_ms).map(|(watchdog, _)| watchdog)
}

/// Returns the first commands, from shortly before the first pause on, that take a bounded time to try.
fn excerpt(commands: &Commands, robot: &Robot) -> Commands {
    let is_pause = is_pause(commands);
    let first = intervals(commands).position(|interval| is_pause(&interval));
    let from_ms = first.map_or(f64::NEG_INFINITY, |at| commands.samples[at].0 - 10.0 * robot.step_ms);
    let to_ms = from_ms.max(commands.samples[0].0) + MAX_STEPS * robot.step_ms;
    let samples = commands.samples.iter().filter(|(ms, _)| (from_ms..to_ms).contains(ms)).copied().collect();
    Commands { kind: commands.kind, samples }
}

/// Returns what explains the motion best, and the fraction that is then unexplained.
fn watchdog(
    commands: &Commands,
    track: &[CumulativeMotion],
    robot: &Robot,
    longest_ms: f64,
) -> Option<(Watchdog, f64)> {
    let unexplained = |commands: &Commands| Some(lag(&commanded(commands, robot), track, MAX_LAG_MS)?.1);
    let stops_after = |ms: f64| Some((ms, unexplained(&stopping(commands, ms))?));
    let best_of =
        |times: &mut dyn Iterator<Item = f64>| times.filter_map(stops_after).min_by(|a, b| a.1.total_cmp(&b.1));
    let on = unexplained(commands)?;
    let last_ms = longest_ms.min(MAX_TIMEOUT_MS);
    let coarse = best_of(&mut (0..=(last_ms / COARSE_MS) as usize).map(|i| COARSE_MS * i as f64))?;
    let around = (COARSE_MS / FINE_MS) as i32;
    let fine = (-around..=around).map(|i| coarse.0 + FINE_MS * f64::from(i)).filter(|ms| *ms >= 0.0);
    let (ms, stopped) = best_of(&mut fine.into_iter())?;
    if stopped <= MAX_REMAINING * on && on - stopped >= MIN_GAIN {
        return Some((Watchdog::StopsAfter(ms), stopped));
    }
    Some((Watchdog::None, on))
}
