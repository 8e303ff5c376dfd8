//! Effects of the floor, of grip and of load.

use std::f64::consts::PI;

use glam::DVec2;

use super::effect::{CommandHistory, Hook, Parameter, PoseIncrement, Reported, StepContext, Variant};
use super::{degrees, magnitude_each, rounded, side_of};
use crate::geometry::direction;

/// The forms of this family.
pub const VARIANTS: &[Variant] = &[
    Variant {
        id: "payload",
        name: "commands lose, more on one side",
        parameters: LOAD,
        starts: LOAD_STARTS,
        acts: &[Hook::Commands(loaded_commands)],
        report: load,
    },
    Variant {
        id: "payload",
        name: "ways shorten, more on one side",
        parameters: LOAD,
        starts: LOAD_STARTS,
        acts: &[Hook::Motion(loaded_ways)],
        report: load,
    },
    Variant {
        id: "payload",
        name: "ways shorten on one side, and a heavy robot is slow to start and to turn",
        parameters: HEAVY_LOAD,
        starts: HEAVY_LOAD_STARTS,
        acts: &[Hook::Commands(slow_start), Hook::Motion(load_on_turns)],
        report: load,
    },
    Variant {
        id: "payload",
        name: "a wheel rolls hard at any speed, and a heavy robot is slow to start",
        parameters: ROLLING_LOAD,
        starts: ROLLING_LOAD_STARTS,
        acts: &[Hook::Commands(slow_start), Hook::Motion(hard_rolling)],
        report: load,
    },
    Variant {
        id: "slope",
        name: "a drift downhill while moving",
        parameters: DIRECTED,
        starts: DIRECTED_STARTS,
        acts: &[Hook::Motion(slope_drift)],
        report: directed,
    },
    Variant {
        id: "slope",
        name: "a gain or loss that grows with speed in part, and sideways down in part",
        parameters: MIXED_SLOPE,
        starts: MIXED_SLOPE_STARTS,
        acts: &[Hook::Motion(slope_mixed)],
        report: directed,
    },
    Variant {
        id: "carpet_nap",
        name: "drag that grows with speed in part, and sets in softly in part",
        parameters: MIXED_NAP,
        starts: MIXED_NAP_STARTS,
        acts: &[Hook::Motion(nap_mixed)],
        report: directed,
    },
    Variant {
        id: "carpet_nap",
        name: "drag along an axis",
        parameters: AXIS,
        starts: AXIS_STARTS,
        acts: &[Hook::Motion(nap_axis)],
        report: directed,
    },
    Variant {
        id: "slip",
        name: "large commands lose grip",
        parameters: FAST_GRIP,
        starts: GRIP_STARTS,
        acts: &[Hook::Commands(slip_when_fast)],
        report: onset,
    },
    Variant {
        id: "slip",
        name: "large changes lose grip",
        parameters: GRIP,
        starts: GRIP_STARTS,
        acts: &[Hook::Commands(slip_when_changing)],
        report: onset,
    },
    Variant {
        id: "slip",
        name: "large changes lose way",
        parameters: GRIP,
        starts: GRIP_STARTS,
        acts: &[Hook::Motion(slip_of_ways)],
        report: onset,
    },
    Variant {
        id: "slip",
        name: "large changes lose more than in proportion, and turns drag",
        parameters: DRAGGING_GRIP,
        starts: DRAGGING_GRIP_STARTS,
        acts: &[Hook::Commands(slip_growing), Hook::Motion(dragging_turn)],
        report: onset,
    },
];

/// Loss of the loaded side (negative: the right one), and the other side's share of it: with none it would be a weaker
/// motor, with all of it a scale.
const LOAD: &[Parameter] = &[Parameter::new(-0.6, 0.6, 0.0), Parameter::new(0.15, 0.8, 0.5)];
const LOAD_STARTS: &[&[f64]] = &[&[0.06, 0.5], &[-0.06, 0.5]];
/// The same with the loss of turns and of changes of command, each so many times the side's loss: a load that costs
/// much of these costs something on the straight too, or it would be another track or a slower motor.
const HEAVY_LOAD: &[Parameter] = &[
    Parameter::new(-0.6, 0.6, 0.0),
    Parameter::new(0.0, 0.8, 0.5),
    Parameter::new(0.0, 6.0, 0.0),
    Parameter::new(0.0, 6.0, 0.0),
];
const HEAVY_LOAD_STARTS: &[&[f64]] = &[&[0.03, 0.5, 2.0, 1.0], &[-0.03, 0.5, 2.0, 1.0]];
/// Loss, the other side's share of it, the share of it that grows with speed (with all of it it would be a weaker
/// motor), and the loss of changes of command, so many times the side's.
const ROLLING_LOAD: &[Parameter] = &[
    Parameter::new(-0.6, 0.6, 0.0),
    Parameter::new(0.0, 0.8, 0.2),
    Parameter::new(0.0, 0.6, 0.3),
    Parameter::new(0.0, 6.0, 0.0),
];
const ROLLING_LOAD_STARTS: &[&[f64]] = &[&[0.05, 0.2, 0.3, 1.0], &[-0.05, 0.2, 0.3, 1.0]];
/// Direction in radians, and loss.
const DIRECTED: &[Parameter] = &[Parameter::new(-2.0 * PI, 2.0 * PI, 0.0), Parameter::new(0.0, 0.6, 0.0)];
const DIRECTED_STARTS: &[&[f64]] = &[&[0.0, 0.05], &[PI / 2.0, 0.05], &[PI, 0.05], &[-PI / 2.0, 0.05]];
/// Direction, loss, the share of it that grows with speed, and how much of it slides sideways.
const MIXED_SLOPE: &[Parameter] = &[
    Parameter::new(-2.0 * PI, 2.0 * PI, 0.0),
    Parameter::new(0.0, 0.6, 0.0),
    Parameter::new(0.0, 1.0, 0.5),
    Parameter::new(0.0, 1.5, 0.0),
];
const MIXED_SLOPE_STARTS: &[&[f64]] =
    &[&[0.0, 0.05, 0.5, 0.5], &[PI / 2.0, 0.05, 0.5, 0.5], &[PI, 0.05, 0.5, 0.5], &[-PI / 2.0, 0.05, 0.5, 0.5]];
/// Direction, loss, the share of it that grows with speed, and the share of it that is there across the nap too.
const MIXED_NAP: &[Parameter] = &[
    Parameter::new(-2.0 * PI, 2.0 * PI, 0.0),
    Parameter::new(0.0, 0.6, 0.0),
    Parameter::new(0.0, 1.0, 0.5),
    Parameter::new(0.0, 1.0, 0.5),
];
const MIXED_NAP_STARTS: &[&[f64]] =
    &[&[0.0, 0.05, 0.5, 0.5], &[PI / 2.0, 0.05, 0.5, 0.5], &[PI, 0.05, 0.5, 0.5], &[-PI / 2.0, 0.05, 0.5, 0.5]];
const AXIS: &[Parameter] = &[Parameter::new(-PI, PI, 0.0), Parameter::new(0.0, 0.6, 0.0)];
const AXIS_STARTS: &[&[f64]] = &[&[0.0, 0.05], &[PI / 4.0, 0.05], &[PI / 2.0, 0.05], &[-PI / 4.0, 0.05]];
/// Onset in commands, and the share that is lost of what lies beyond. Below some onset it would be a scale or a lag.
const GRIP: &[Parameter] = &[Parameter::new(15.0, 120.0, 120.0), Parameter::new(0.0, 1.0, 0.0)];
/// Large commands alone: what loses more than half is a limit.
const FAST_GRIP: &[Parameter] = &[Parameter::new(15.0, 120.0, 120.0), Parameter::new(0.0, 0.5, 0.0)];
const GRIP_STARTS: &[&[f64]] = &[&[20.0, 0.2], &[40.0, 0.3], &[70.0, 0.4]];
/// Onset, loss, and so many times that many radians that a step's turn loses: a tyre of little grip creeps where it is
/// held back.
const DRAGGING_GRIP: &[Parameter] =
    &[Parameter::new(15.0, 90.0, 60.0), Parameter::new(0.0, 1.5, 0.0), Parameter::new(0.0, 0.1, 0.0)];
const DRAGGING_GRIP_STARTS: &[&[f64]] = &[&[30.0, 0.3, 0.0], &[60.0, 0.3, 0.0], &[30.0, 0.8, 0.05], &[60.0, 0.8, 0.05]];
/// Turns of a step below this do not pull the tyres to their grip, rad.
const LITTLE_TURN_RAD: f64 = 0.04;
/// A change of so many onsets is not caught up with at the end of its step.
const NOT_CAUGHT_UP: f64 = 2.5;

fn load_factors(v: &[f64]) -> [f64; 2] {
    let (near, far) = (v[0].abs(), v[0].abs() * v[1]);
    if v[0] > 0.0 { [1.0 - near, 1.0 - far] } else { [1.0 - far, 1.0 - near] }
}

fn loaded_commands(v: &[f64], _: &StepContext, window: &mut CommandHistory) {
    let factor = load_factors(v);
    magnitude_each(window, |c, motor| c * factor[motor]);
}

fn loaded_ways(v: &[f64], moment: &StepContext, motion: &mut PoseIncrement) {
    let factor = load_factors(v);
    let [left, right] = motion.wheels_cm(moment.track_cm);
    motion.set_wheels([left * factor[0], right * factor[1]], moment.track_cm);
}

fn hard_rolling(v: &[f64], moment: &StepContext, motion: &mut PoseIncrement) {
    let [near, far] = [v[0].abs(), v[0].abs() * v[1]];
    let losses = if v[0] > 0.0 { [near, far] } else { [far, near] };
    let wheels = motion.wheels_cm(moment.track_cm);
    motion.set_wheels([0, 1].map(|m| pushed(wheels[m], -losses[m] * cost_cm(v[2], wheels[m]))), moment.track_cm);
}

fn load_on_turns(v: &[f64], moment: &StepContext, motion: &mut PoseIncrement) {
    loaded_ways(v, moment, motion);
    motion.turn_rad *= 1.0 - (v[2] * v[0].abs()).min(1.0);
}

/// Part of every change of command is not there yet.
fn slow_start(v: &[f64], _: &StepContext, window: &mut CommandHistory) {
    let late = (v[3] * v[0].abs()).min(1.0);
    let [now, before, ..] = window;
    for (c, earlier) in now.iter_mut().zip(before) {
        *c += late * (*earlier - *c);
    }
}

/// Cosine between the direction of travel and `direction_rad`: reversing travels against the heading.
fn along(direction_rad: f64, moment: &StepContext, motion: &PoseIncrement) -> f64 {
    libm::cos(moment.pose.heading_rad + 0.5 * motion.turn_rad - direction_rad) * motion.forward_cm.signum()
}

/// Way downhill in a step, in shares of the way of both wheels.
fn downhill(v: &[f64], moment: &StepContext, motion: &PoseIncrement) -> DVec2 {
    let [left, right] = motion.wheels_cm(moment.track_cm);
    let way_cm = 0.5 * (left.abs() + right.abs());
    direction(v[0] - moment.pose.heading_rad - 0.5 * motion.turn_rad) * (v[1] * way_cm)
}

fn slope_drift(v: &[f64], moment: &StepContext, motion: &mut PoseIncrement) {
    let drift = downhill(v, moment, motion);
    motion.forward_cm += drift.x;
    motion.lateral_cm += drift.y;
}

/// The way of a step at half of the largest command, about; a force costs a share of it at any speed.
const HALF_SPEED_CM: f64 = 8.0;

/// What a force costs in a step of a way: a share of it that grows with speed, and the rest at any speed.
fn cost_cm(with_speed: f64, way_cm: f64) -> f64 {
    with_speed * way_cm.abs() + (1.0 - with_speed) * HALF_SPEED_CM
}

/// A wheel that is driven gives way downhill, one that stands holds.
fn slope_mixed(v: &[f64], moment: &StepContext, motion: &mut PoseIncrement) {
    let driven_cm = motion.wheels_cm(moment.track_cm).into_iter().fold(0.0, |most: f64, w| most.max(w.abs()));
    let pull_cm = (driven_cm / 1.5).min(1.0) * v[1] * cost_cm(v[2], motion.forward_cm);
    let downhill = direction(v[0] - moment.pose.heading_rad - 0.5 * motion.turn_rad) * pull_cm;
    motion.forward_cm += downhill.x;
    motion.lateral_cm += v[3] * downhill.y;
}

fn nap_mixed(v: &[f64], moment: &StepContext, motion: &mut PoseIncrement) {
    let against = along(v[0], moment, motion);
    let drag = v[3] * 0.5 * (1.0 + against) + (1.0 - v[3]) * against.max(0.0);
    motion.forward_cm = pushed(motion.forward_cm, -v[1] * drag * cost_cm(v[2], motion.forward_cm));
}

/// A way made longer or shorter, not below nothing; a robot that stands stays.
fn pushed(way_cm: f64, more_cm: f64) -> f64 {
    let moving = (way_cm.abs() / 1.5).min(1.0);
    (way_cm.abs() + moving * more_cm).max(0.0) * way_cm.signum()
}

fn nap_axis(v: &[f64], moment: &StepContext, motion: &mut PoseIncrement) {
    drag(motion, v[1] * along(v[0], moment, motion).abs());
}

fn drag(motion: &mut PoseIncrement, loss: f64) {
    motion.forward_cm *= 1.0 - loss;
    motion.lateral_cm *= 1.0 - loss;
}

fn slip_when_fast(v: &[f64], _: &StepContext, window: &mut CommandHistory) {
    magnitude_each(window, |c, _| c - v[1] * (c - v[0]).max(0.0));
}

/// A wheel that slips in a step has caught up at its end.
fn slip_when_changing(v: &[f64], _: &StepContext, window: &mut CommandHistory) {
    slipped(window, 0, |beyond| v[1] * beyond, v[0]);
}

fn slip_growing(v: &[f64], _: &StepContext, window: &mut CommandHistory) {
    let lost = |beyond: f64| v[1] * beyond * beyond / (40.0 + beyond);
    slipped(window, 0, lost, v[0]);
    slipped(window, 1, lost, NOT_CAUGHT_UP * v[0]);
}

fn dragging_turn(v: &[f64], _: &StepContext, motion: &mut PoseIncrement) {
    motion.turn_rad -= v[1] * v[2] * libm::tanh(motion.turn_rad / LITTLE_TURN_RAD);
}

/// Takes from the command of a step what the change of command so many steps ago loses beyond an onset.
fn slipped(window: &mut CommandHistory, ago: usize, lost: impl Fn(f64) -> f64, onset: f64) {
    let (to, from) = (window[ago], window[ago + 1]);
    for ((command, to), from) in window[0].iter_mut().zip(to).zip(from) {
        let change = to - from;
        *command -= lost((change.abs() - onset).max(0.0)) * change.signum();
    }
}

fn slip_of_ways(v: &[f64], moment: &StepContext, motion: &mut PoseIncrement) {
    let [now, before] = [moment.commands[0], moment.commands[1]];
    let wheels = motion.wheels_cm(moment.track_cm);
    let kept = [0, 1].map(|m| 1.0 - (v[1] * ((now[m] - before[m]).abs() - v[0]).max(0.0) / 100.0).min(1.0));
    motion.set_wheels([wheels[0] * kept[0], wheels[1] * kept[1]], moment.track_cm);
}

fn load(v: &[f64], _: f64) -> Reported {
    vec![("side", side_of(v[0])), ("loss", rounded(v[0].abs()))]
}

fn directed(v: &[f64], _: f64) -> Reported {
    vec![("direction_deg", degrees(v[0])), ("loss", rounded(v[1]))]
}

fn onset(v: &[f64], _: f64) -> Reported {
    vec![("onset", rounded(v[0])), ("loss", rounded(v[1]))]
}
