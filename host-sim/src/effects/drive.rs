//! Effects of the drive as a whole and of its halves: weaker motors, other wheels, another track.

use super::effect::{CommandHistory, Hook, Parameter, PoseIncrement, Reported, StepContext, Variant};
use super::{magnitude, rounded, side_of};

/// The forms of this family.
pub const VARIANTS: &[Variant] = &[
    Variant {
        id: "battery_sag",
        name: "commands weaken",
        parameters: SAG,
        starts: SAG_STARTS,
        acts: &[Hook::Commands(sagging_commands)],
        report: |v, _| vec![("loss_per_min", rounded(v[0]))],
    },
    Variant {
        id: "battery_sag",
        name: "ways shorten",
        parameters: SAG,
        starts: SAG_STARTS,
        acts: &[Hook::Motion(shortening_ways)],
        report: |v, _| vec![("loss_per_min", rounded(v[0]))],
    },
    Variant {
        id: "motor_asymmetry",
        name: "a weaker command",
        parameters: ASYMMETRY,
        starts: ASYMMETRY_STARTS,
        acts: &[Hook::Commands(one_weaker_command)],
        report: asymmetry,
    },
    Variant {
        id: "motor_asymmetry",
        name: "a shorter way",
        parameters: ASYMMETRY,
        starts: ASYMMETRY_STARTS,
        acts: &[Hook::Motion(one_shorter_way)],
        report: asymmetry,
    },
    Variant {
        id: "drive_scale",
        name: "longer ways",
        parameters: FACTOR,
        starts: FACTOR_STARTS,
        acts: &[Hook::Motion(scaled_ways)],
        report: factor,
    },
    Variant {
        id: "drive_scale",
        name: "stronger commands",
        parameters: FACTOR,
        starts: FACTOR_STARTS,
        acts: &[Hook::Commands(scaled_commands)],
        report: factor,
    },
    Variant {
        id: "track_width",
        name: "smaller turns",
        parameters: FACTOR,
        starts: FACTOR_STARTS,
        acts: &[Hook::Motion(scaled_turn)],
        report: factor,
    },
];

const SAG: &[Parameter] = &[Parameter::new(0.0, 0.9, 0.0)];
const SAG_STARTS: &[&[f64]] = &[&[0.05], &[0.25], &[0.6]];
const ASYMMETRY: &[Parameter] = &[Parameter::new(-0.5, 0.5, 0.0)];
const ASYMMETRY_STARTS: &[&[f64]] = &[&[0.05], &[-0.05]];
const FACTOR: &[Parameter] = &[Parameter::new(0.6, 1.5, 1.0)];
const FACTOR_STARTS: &[&[f64]] = &[&[1.03], &[0.97]];

fn sagging_commands(v: &[f64], moment: &StepContext, window: &mut CommandHistory) {
    let left = (1.0 - v[0] * moment.elapsed_min).max(0.0);
    magnitude(window, |c| c * left);
}

fn shortening_ways(v: &[f64], moment: &StepContext, motion: &mut PoseIncrement) {
    scaled_ways(&[(1.0 - v[0] * moment.elapsed_min).max(0.0)], moment, motion);
}

/// Positive: the left motor is the weaker one by this share; negative: the right one.
fn one_weaker_command(v: &[f64], _: &StepContext, window: &mut CommandHistory) {
    let factor = [1.0 - v[0].max(0.0), 1.0 + v[0].min(0.0)];
    window.iter_mut().for_each(|c| *c = [c[0] * factor[0], c[1] * factor[1]]);
}

fn one_shorter_way(v: &[f64], moment: &StepContext, motion: &mut PoseIncrement) {
    let factor = [1.0 - v[0].max(0.0), 1.0 + v[0].min(0.0)];
    let [left, right] = motion.wheels_cm(moment.track_cm);
    motion.set_wheels([left * factor[0], right * factor[1]], moment.track_cm);
}

fn scaled_ways(v: &[f64], _: &StepContext, motion: &mut PoseIncrement) {
    motion.forward_cm *= v[0];
    motion.lateral_cm *= v[0];
    motion.turn_rad *= v[0];
}

fn scaled_commands(v: &[f64], _: &StepContext, window: &mut CommandHistory) {
    magnitude(window, |c| c * v[0]);
}

fn scaled_turn(v: &[f64], _: &StepContext, motion: &mut PoseIncrement) {
    motion.turn_rad *= v[0];
}

fn asymmetry(v: &[f64], _: f64) -> Reported {
    vec![("side", side_of(v[0])), ("factor", rounded(1.0 - v[0].abs()))]
}

fn factor(v: &[f64], _: f64) -> Reported {
    vec![("factor", rounded(v[0]))]
}
