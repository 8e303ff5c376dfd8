//! Effects of the single motor: what a command does to a wheel, and when.

use super::effect::{CommandHistory, HISTORY, Hook, Parameter, Reported, StepContext, Variant};
use super::{magnitude, rounded};

/// The forms of this family.
pub const VARIANTS: &[Variant] = &[
    Variant {
        id: "deadband",
        name: "small commands do nothing",
        parameters: BAND,
        starts: BAND_STARTS,
        acts: &[Hook::Commands(cut_band)],
        report: command,
    },
    Variant {
        id: "deadband",
        name: "friction eats its part of every command",
        parameters: BAND,
        starts: BAND_STARTS,
        acts: &[Hook::Commands(eaten_band)],
        report: command,
    },
    Variant {
        id: "deadband",
        name: "full commands are as before",
        parameters: BAND,
        starts: BAND_STARTS,
        acts: &[Hook::Commands(stretched_band)],
        report: command,
    },
    Variant {
        id: "saturation",
        name: "a limit",
        parameters: LIMIT,
        starts: LIMIT_STARTS,
        acts: &[Hook::Commands(limited)],
        report: command,
    },
    Variant {
        id: "saturation",
        name: "a soft limit",
        parameters: LIMIT,
        starts: LIMIT_STARTS,
        acts: &[Hook::Commands(softly_limited)],
        report: command,
    },
    Variant {
        id: "latency",
        name: "part of the step still has the command before",
        parameters: &[Parameter::new(0.0, 2.0, 0.0)],
        starts: &[&[0.1], &[0.4], &[0.9]],
        acts: &[Hook::Commands(late)],
        report: |v, step_ms| vec![("ms", rounded(v[0] * step_ms))],
    },
    Variant {
        id: "inertia",
        name: "the step lags, and what lags dies away",
        parameters: &[Parameter::new(0.0, 0.8, 0.0), Parameter::new(0.03, 0.8, 0.2)],
        starts: &[&[0.1, 0.15], &[0.3, 0.2], &[0.5, 0.4]],
        acts: &[Hook::Commands(lagging)],
        report: |v, step_ms| vec![("ms", rounded(v[0] * step_ms))],
    },
];

const BAND: &[Parameter] = &[Parameter::new(0.0, 50.0, 0.0)];
const BAND_STARTS: &[&[f64]] = &[&[4.0], &[8.0], &[14.0], &[22.0], &[30.0]];
const LIMIT: &[Parameter] = &[Parameter::new(20.0, 100.0, 100.0)];
const LIMIT_STARTS: &[&[f64]] = &[&[35.0], &[50.0], &[65.0], &[80.0]];
/// A cut is not sharper than this, in commands, so that its place can be fitted.
const SOFTNESS: f64 = 2.0;

fn cut_band(v: &[f64], _: &StepContext, window: &mut CommandHistory) {
    let edge = v[0];
    if edge > 0.0 {
        magnitude(window, |c| c * ((c - edge) / SOFTNESS + 0.5).clamp(0.0, 1.0));
    }
}

fn eaten_band(v: &[f64], _: &StepContext, window: &mut CommandHistory) {
    magnitude(window, |c| (c - v[0]).max(0.0));
}

fn stretched_band(v: &[f64], _: &StepContext, window: &mut CommandHistory) {
    magnitude(window, |c| (c - v[0]).max(0.0) * 100.0 / (100.0 - v[0]));
}

fn limited(v: &[f64], _: &StepContext, window: &mut CommandHistory) {
    magnitude(window, |c| c.min(v[0]));
}

/// Half of what lies above the limit's begin is lost, and all beyond one and a half times it.
fn softly_limited(v: &[f64], _: &StepContext, window: &mut CommandHistory) {
    let begin = 0.75 * v[0];
    let end = 1.25 * v[0];
    if v[0] < 100.0 {
        magnitude(window, |c| {
            let into = ((c - begin) / (end - begin)).clamp(0.0, 1.0);
            if c <= begin { c } else { begin + (end - begin) * (into - 0.5 * into * into) }
        });
    }
}

/// `v[0]` steps late: the command before holds for the first part of the step. What it did to the wheels is over by then.
fn late(v: &[f64], _: &StepContext, window: &mut CommandHistory) {
    let (whole, part) = (v[0] as usize, v[0] % 1.0);
    window.rotate_left(whole);
    let [now, before, ..] = window;
    *now = [0, 1].map(|m| (1.0 - part) * now[m] + part * before[m]);
}

/// The share `v[0]` of a step still has the speed at its begin, which has come within `v[1]` of the command before.
fn lagging(v: &[f64], _: &StepContext, window: &mut CommandHistory) {
    if v[0] == 0.0 {
        return;
    }
    let mut speed = window[HISTORY - 1];
    for command in window[1..].iter().rev() {
        speed = [0, 1].map(|m| command[m] + v[1] * (speed[m] - command[m]));
    }
    window[0] = [0, 1].map(|m| window[0][m] + v[0] * (speed[m] - window[0][m]));
    window[1] = speed;
}

fn command(v: &[f64], _: f64) -> Reported {
    vec![("command", rounded(v[0]))]
}
