//! One clock for commands and poses: theirs if it is one, or else by their motion.

use crate::clocks::{Clocks, align, lag};
use crate::motion::CumulativeMotion;
use crate::recording::Commands;
use crate::report::ClocksReport;
use crate::sides::{covered, drive};
use mindgap_foundations::error::{Error, Result};
use mindgap_logs::{Robot, Row};

use super::rows::Prepared;

/// A lag of motion behind its commands up to this may be the robot's own: clocks that are off by no more are one.
const LONGEST_LAG_MS: f64 = 1000.0;
/// Commands and poses on one clock leave at most this share of the motion unexplained, whatever the robot's faults; those of
/// two drives leave about 0.6, since both mostly go ahead.
const MOST_UNEXPLAINED: f64 = 0.45;

/// How the clocks of commands and poses go together, which one clock stamped `for_certain` or not; `offset_ms` is what the
/// user says that the poses' clock is ahead.
///
/// # Errors
/// When the streams have nothing in common.
pub fn aligned(
    prepared: &Prepared,
    robot: &Robot,
    for_certain: bool,
    offset_ms: Option<f64>,
) -> Result<(Clocks, ClocksReport)> {
    let asked = asked(&prepared.commands, robot);
    let seen = prepared.track.motion();
    let stated_ms = offset_ms.unwrap_or(0.0);
    let shifted: Vec<CumulativeMotion> =
        seen.iter().map(|m| CumulativeMotion { t_ms: m.t_ms - stated_ms, ..*m }).collect();
    let lag = lag(&asked, &shifted, LONGEST_LAG_MS);
    let report = |clocks: Clocks, one, lag_ms, unexplained| {
        let Clocks { offset_ms, drift } = clocks;
        (clocks, ClocksReport { one, offset_ms, drift, lag_ms, unexplained })
    };
    if offset_ms.is_some() || lag.is_some_and(|(_, unexplained)| unexplained <= MOST_UNEXPLAINED) {
        let (lag_ms, unexplained) = lag.unzip();
        return Ok(report(Clocks { offset_ms: stated_ms, drift: 0.0 }, true, lag_ms, unexplained));
    }
    let found = if for_certain { None } else { align(&asked, &seen).filter(|found| found.doubt().is_none()) };
    if let Some(found) = found {
        return Ok(report(found.clocks, false, None, Some(found.unexplained)));
    }
    let what = match lag {
        Some((_, unexplained)) => format!(
            "commands and poses have nothing in common: {:.0} % of the motion differ on the clock that they have, and no other \
             offset of clocks fits; are they of one drive? (if so, --offset-ms states what the poses' clock is ahead)",
            100.0 * unexplained
        ),
        // Nothing moves, or the times do not overlap.
        None => format!(
            "commands ({}) and poses ({}) do not overlap or nothing moves, and no offset of clocks fits; --offset-ms states \
             what the poses' clock is ahead",
            span(&asked),
            span(&seen)
        ),
    };
    Err(Error::in_file(&prepared.file, what))
}

fn span(motion: &[CumulativeMotion]) -> String {
    let ends = motion.first().zip(motion.last());
    ends.map_or("none".into(), |(a, b)| format!("{:.1} to {:.1} s", a.t_ms / 1e3, b.t_ms / 1e3))
}

/// The motion that is asked for, cumulated step by step.
fn asked(commands: &Commands, robot: &Robot) -> Vec<CumulativeMotion> {
    let (first_ms, last_ms) = (commands.samples[0].0, commands.samples[commands.samples.len() - 1].0);
    let steps = ((last_ms - first_ms) / robot.step_ms) as usize;
    let mut by = [0.0; 2];
    let mut motion = vec![CumulativeMotion { t_ms: first_ms, by }];
    for step in 0..steps {
        let from_ms = first_ms + step as f64 * robot.step_ms;
        let [left, right] = commands.mean(from_ms, from_ms + robot.step_ms);
        let row = Row { left, right, ..Row::default() };
        let [left_cm, right_cm] = covered(&row, robot.step_ms, robot);
        let [cm, rad] = drive(left_cm, right_cm, robot);
        by = [by[0] + rad, by[1] + cm];
        motion.push(CumulativeMotion { t_ms: from_ms + robot.step_ms, by });
    }
    motion
}
