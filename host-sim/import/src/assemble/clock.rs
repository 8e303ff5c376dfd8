//! Finds one clock for commands and poses, or what the robot measured of its motion if there are none: the clock they share, or an
//! alignment by their motion.

use std::borrow::Cow;

use crate::clocks::{Clocks, align, gains, lag};
use crate::motion::CumulativeMotion;
use crate::recording::Commands;
use crate::report::ClocksReport;
use crate::scale_check::{commanded_wheels_cm, travel_and_rotation};
use mindgap_foundations::error::{Error, Result};
use mindgap_logs::{Robot, Row};

use super::rows::Prepared;

/// Up to this lag of motion behind commands may be the robot's own: with no more, the clocks count as one.
pub const MAX_LAG_MS: f64 = 1000.0;
/// Commands and poses on one clock leave at most this fraction of the motion unexplained, whatever the robot's faults; those of
/// two different drives leave about 0.6, since both mostly go ahead.
pub const MAX_UNEXPLAINED: f64 = 0.45;

/// Finds how the clocks of commands and poses are related. `is_one_clock` says that they are known to be the same, `offset_ms`
/// is the lead of the poses' clock if the user states it.
///
/// # Errors
/// When the streams have nothing in common.
pub fn aligned(
    prepared: &Prepared,
    robot: &Robot,
    is_one_clock: bool,
    offset_ms: Option<f64>,
) -> Result<(Clocks, ClocksReport)> {
    let commanded = commanded(&prepared.commands, robot);
    let observed = prepared.track.motion();
    let stated_ms = offset_ms.unwrap_or(0.0);
    let shifted = shifted(&observed, stated_ms);
    let lag = lag(&commanded, &shifted, MAX_LAG_MS);
    let report = |clocks: Clocks, shared, lag_ms: Option<f64>, unexplained| {
        let Clocks { offset_ms, drift } = clocks;
        let lagging = Clocks { offset_ms: offset_ms + lag_ms.unwrap_or(0.0), drift };
        let [rotation_gain, travel_gain] = gains(&lagging, &commanded, &observed);
        (clocks, ClocksReport { shared, offset_ms, drift, lag_ms, unexplained, travel_gain, rotation_gain })
    };
    if offset_ms.is_some() || lag.is_some_and(|(_, unexplained)| unexplained <= MAX_UNEXPLAINED) {
        let (lag_ms, unexplained) = lag.unzip();
        return Ok(report(Clocks { offset_ms: stated_ms, drift: 0.0 }, true, lag_ms, unexplained));
    }
    let found = if is_one_clock { None } else { align(&commanded, &observed).filter(|found| found.doubt().is_none()) };
    if let Some(found) = found {
        return Ok(report(found.clocks, false, None, Some(found.unexplained)));
    }
    // What the robot measured is its own, even if a counter runs backwards; a gyro shows nothing of straight travel.
    if !prepared.is_tracked && (is_one_clock || lag.is_none()) {
        let (lag_ms, unexplained) = lag.unzip();
        return Ok(report(Clocks { offset_ms: 0.0, drift: 0.0 }, true, lag_ms, unexplained));
    }
    let shown_by = prepared.shown_by;
    let what = match lag {
        Some((_, unexplained)) => format!(
            "commands and {shown_by} have nothing in common: {:.0} % of the motion is unexplained with the given times, and no clock \
             offset fits; are they from one drive? (if so, state the lead of their clock by --offset-ms)",
            100.0 * unexplained
        ),
        // Nothing moves, or the times do not overlap.
        None => format!(
            "commands ({}) and {shown_by} ({}) do not overlap or nothing moves, and no clock offset fits; state the lead of \
             their clock by --offset-ms",
            span(&commanded),
            span(&observed)
        ),
    };
    Err(Error::in_file(&prepared.file, what))
}

/// Returns whether the motion follows the commands only if the robot is taken to turn the opposite way.
pub fn is_mirrored(prepared: &Prepared, robot: &Robot, is_one_clock: bool, offset_ms: Option<f64>) -> bool {
    let commanded = commanded(&prepared.commands, robot);
    let observed = prepared.track.motion();
    let explained = |track: &[CumulativeMotion]| {
        let lag = lag(&commanded, &shifted(track, offset_ms.unwrap_or(0.0)), MAX_LAG_MS);
        lag.is_some_and(|(_, unexplained)| unexplained <= MAX_UNEXPLAINED)
    };
    let aligned = |track: &[CumulativeMotion]| align(&commanded, track).is_some_and(|found| found.doubt().is_none());
    if explained(&observed) {
        return false;
    }
    let opposite: Vec<CumulativeMotion> =
        observed.iter().map(|m| CumulativeMotion { by: [-m.by[0], m.by[1]], ..*m }).collect();
    explained(&opposite) || !is_one_clock && offset_ms.is_none() && !aligned(&observed) && aligned(&opposite)
}

/// Returns motion on a clock that lags by `ms`.
pub fn shifted(motion: &[CumulativeMotion], ms: f64) -> Cow<'_, [CumulativeMotion]> {
    if ms == 0.0 {
        return Cow::Borrowed(motion);
    }
    Cow::Owned(motion.iter().map(|m| CumulativeMotion { t_ms: m.t_ms - ms, ..*m }).collect())
}

fn span(motion: &[CumulativeMotion]) -> String {
    let ends = motion.first().zip(motion.last());
    ends.map_or("none".into(), |(a, b)| format!("{:.1} to {:.1} s", a.t_ms / 1e3, b.t_ms / 1e3))
}

/// Integrates the commanded motion step by step.
pub fn commanded(commands: &Commands, robot: &Robot) -> Vec<CumulativeMotion> {
    let (first_ms, last_ms) = (commands.samples[0].0, commands.samples[commands.samples.len() - 1].0);
    let steps = ((last_ms - first_ms) / robot.step_ms) as usize;
    let mut by = [0.0; 2];
    let mut motion = vec![CumulativeMotion { t_ms: first_ms, by }];
    for step in 0..steps {
        let from_ms = first_ms + step as f64 * robot.step_ms;
        let [left, right] = commands.mean(from_ms, from_ms + robot.step_ms);
        let row = Row { left, right, ..Row::default() };
        let [left_cm, right_cm] = commanded_wheels_cm(&row, robot.step_ms, robot);
        let [cm, rad] = travel_and_rotation(left_cm, right_cm, robot);
        by = [by[0] + rad, by[1] + cm];
        motion.push(CumulativeMotion { t_ms: from_ms + robot.step_ms, by });
    }
    motion
}
