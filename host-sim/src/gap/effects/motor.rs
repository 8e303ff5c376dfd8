//! Effects of the single motor: what a command does to a wheel, and when.

use super::{magnitude, rounded};
use crate::gap::effect::{Reported, Act, Form, Moment, Parameter, WINDOW, Window};

/// The forms of this family.
pub const FORMS: &[Form] = &[
    Form {
        id: "deadband",
        name: "small commands do nothing",
        parameters: BAND,
        starts: BAND_STARTS,
        acts: &[Act::Commands(cut_band)],
        report: command,
    },
    Form {
        id: "deadband",
        name: "friction eats its part of every command",
        parameters: BAND,
        starts: BAND_STARTS,
        acts: &[Act::Commands(eaten_band)],
        report: command,
    },
    Form {
        id: "deadband",
        name: "full commands are as before",
        parameters: BAND,
        starts: BAND_STARTS,
        acts: &[Act::Commands(stretched_band)],
        report: command,
    },
    Form {
        id: "saturation",
        name: "a limit",
        parameters: LIMIT,
        starts: LIMIT_STARTS,
        acts: &[Act::Commands(limited)],
        report: command,
    },
    Form {
        id: "saturation",
        name: "a soft limit",
        parameters: LIMIT,
        starts: LIMIT_STARTS,
        acts: &[Act::Commands(softly_limited)],
        report: command,
    },
    Form {
        id: "latency",
        name: "part of the step still has the command before",
        parameters: &[Parameter::new(0.0, 2.0, 0.0)],
        starts: &[&[0.1], &[0.4], &[0.9]],
        acts: &[Act::Commands(late)],
        report: |v, step_ms| vec![("ms", rounded(v[0] * step_ms))],
    },
    Form {
        id: "inertia",
        name: "the speed follows the command",
        parameters: &[Parameter::new(0.0, 0.8, 0.0)],
        starts: &[&[0.05], &[0.2], &[0.4]],
        acts: &[Act::Commands(slow)],
        report: |v, step_ms| vec![("ms", rounded(-step_ms / libm::log(v[0].max(1e-3))))],
    },
];

const BAND: &[Parameter] = &[Parameter::new(0.0, 50.0, 0.0)];
const BAND_STARTS: &[&[f64]] = &[&[4.0], &[8.0], &[14.0], &[22.0], &[30.0]];
const LIMIT: &[Parameter] = &[Parameter::new(20.0, 100.0, 100.0)];
const LIMIT_STARTS: &[&[f64]] = &[&[35.0], &[50.0], &[65.0], &[80.0]];
/// A cut is not sharper than this, in commands, so that its place can be fitted.
const SOFTNESS: f64 = 2.0;

fn cut_band(v: &[f64], _: &Moment, window: &mut Window) {
    let edge = v[0];
    if edge > 0.0 {
        magnitude(window, |c| c * ((c - edge) / SOFTNESS + 0.5).clamp(0.0, 1.0));
    }
}

fn eaten_band(v: &[f64], _: &Moment, window: &mut Window) {
    magnitude(window, |c| (c - v[0]).max(0.0));
}

fn stretched_band(v: &[f64], _: &Moment, window: &mut Window) {
    magnitude(window, |c| (c - v[0]).max(0.0) * 100.0 / (100.0 - v[0]));
}

fn limited(v: &[f64], _: &Moment, window: &mut Window) {
    magnitude(window, |c| c.min(v[0]));
}

/// Half of what lies above the limit's begin is lost, and all beyond one and a half times it.
fn softly_limited(v: &[f64], _: &Moment, window: &mut Window) {
    let begin = 0.75 * v[0];
    let end = 1.25 * v[0];
    if v[0] < 100.0 {
        magnitude(window, |c| {
            let into = ((c - begin) / (end - begin)).clamp(0.0, 1.0);
            if c <= begin { c } else { begin + (end - begin) * (into - 0.5 * into * into) }
        });
    }
}

/// `v[0]` steps late, broken steps mixed in proportion.
fn late(v: &[f64], _: &Moment, window: &mut Window) {
    let (whole, part) = (v[0] as usize, v[0] % 1.0);
    let before = *window;
    for (i, c) in window.iter_mut().enumerate() {
        let [newer, older] = [i + whole, i + whole + 1].map(|j| before[j.min(WINDOW - 1)]);
        *c = [0, 1].map(|m| (1.0 - part) * newer[m] + part * older[m]);
    }
}

/// Each step the share `v[0]` of the speed before remains.
fn slow(v: &[f64], _: &Moment, window: &mut Window) {
    for i in (0..WINDOW - 1).rev() {
        let before = window[i + 1];
        window[i] = [0, 1].map(|m| (1.0 - v[0]) * window[i][m] + v[0] * before[m]);
    }
}

fn command(v: &[f64], _: f64) -> Reported {
    vec![("command", rounded(v[0]))]
}
