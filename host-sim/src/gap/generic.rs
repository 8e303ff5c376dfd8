//! Anything at all: for each channel a form that follows every circumstance a little. What it explains beyond the named
//! effects is what no named effect explains.

use super::channel::Channel;
use crate::effects::effect::{Hook, Parameter, PoseIncrement, Sensor, StepContext, Variant};

/// The form that explains whatever depends on circumstances in a channel.
pub fn form(channel: Channel) -> &'static Variant {
    match channel {
        Channel::Forward => &FORWARD,
        Channel::Lateral => &LATERAL,
        Channel::Turn => &TURN,
        Channel::EchoRate => &ECHO_RATE,
        Channel::EchoValue => &ECHO_VALUE,
    }
}

/// The form that moves readings as circumstances have it, and leaves their scatter as it is.
pub static MOVED_READINGS: Variant = Variant {
    id: "anything",
    name: "where readings lie",
    parameters: const { &[Parameter::new(-20.0, 20.0, 0.0); SONAR_FEATURES] },
    starts: &[&[0.0; SONAR_FEATURES]],
    acts: &[Hook::Sensor(moved_readings)],
    report: |_, _| Vec::new(),
};

static FORWARD: Variant = motion_form(&[Hook::Motion(|v, moment, m| m.forward_cm += motion_sum(v, moment, m))]);
static LATERAL: Variant = motion_form(&[Hook::Motion(|v, moment, m| m.lateral_cm += motion_sum(v, moment, m))]);
static TURN: Variant = motion_form(&[Hook::Motion(|v, moment, m| m.turn_rad += 0.1 * motion_sum(v, moment, m))]);

static ECHO_RATE: Variant = Variant {
    id: "anything",
    name: "echo rate",
    parameters: const { &[Parameter::new(-4.0, 4.0, 0.0); SONAR_FEATURES] },
    starts: &[&[0.0; SONAR_FEATURES]],
    acts: &[Hook::Sensor(|v, moment, sensor| sensor.change.attenuation += sonar_sum(v, moment))],
    report: |_, _| Vec::new(),
};

static ECHO_VALUE: Variant = Variant {
    id: "anything",
    name: "echo value",
    parameters: &ECHO_VALUE_PARAMETERS,
    starts: &[&ECHO_VALUE_START],
    acts: &[Hook::Sensor(other_readings)],
    report: |_, _| Vec::new(),
};

const ECHO_VALUE_PARAMETERS: [Parameter; SONAR_FEATURES + 3] = {
    let mut parameters = [Parameter::new(-20.0, 20.0, 0.0); SONAR_FEATURES + 3];
    parameters[SONAR_FEATURES] = Parameter::new(0.0, 10.0, 0.0);
    parameters[SONAR_FEATURES + 1] = Parameter::new(0.0, 0.5, 0.0);
    parameters[SONAR_FEATURES + 2] = Parameter::new(0.0, 0.5, 0.0);
    parameters
};
const ECHO_VALUE_START: [f64; SONAR_FEATURES + 3] = {
    let mut start = [0.0; SONAR_FEATURES + 3];
    start[SONAR_FEATURES] = 0.3;
    start[SONAR_FEATURES + 1] = 0.002;
    start[SONAR_FEATURES + 2] = 0.002;
    start
};

const fn motion_form(acts: &'static [Hook]) -> Variant {
    Variant {
        id: "anything",
        name: "motion",
        parameters: const { &[Parameter::new(-3.0, 3.0, 0.0); MOTION_FEATURES] },
        starts: &[&[0.0; MOTION_FEATURES]],
        acts,
        report: |_, _| Vec::new(),
    }
}

const MOTION_FEATURES: usize = 28;
const SONAR_FEATURES: usize = 17;

fn motion_sum(weights: &[f64], moment: &StepContext, motion: &PoseIncrement) -> f64 {
    motion_features(moment, motion).iter().zip(weights).map(|(f, w)| f * w).sum()
}

fn sonar_sum(weights: &[f64], moment: &StepContext) -> f64 {
    sonar_features(moment).iter().zip(weights).map(|(f, w)| f * w).sum()
}

fn moved_readings(v: &[f64], moment: &StepContext, sensor: &mut Sensor) {
    sensor.change.offset_cm += sonar_sum(v, moment);
}

fn other_readings(v: &[f64], moment: &StepContext, sensor: &mut Sensor) {
    moved_readings(&v[..SONAR_FEATURES], moment, sensor);
    sensor.change.scatter_cm += v[SONAR_FEATURES];
    sensor.change.p_short = 1.0 - (1.0 - sensor.change.p_short) * (1.0 - v[SONAR_FEATURES + 1]);
    sensor.change.p_long += v[SONAR_FEATURES + 2];
}

/// Circumstances of a step, each of the order of one.
fn motion_features(moment: &StepContext, motion: &PoseIncrement) -> [f64; MOTION_FEATURES] {
    let (way, turn) = (motion.forward_cm / 8.0, motion.turn_rad / 0.4);
    let heading = moment.pose.heading_rad;
    let (sin, cos) = (libm::sin(heading), libm::cos(heading));
    let place = (moment.pose.position_cm - moment.middle_cm) / 100.0;
    let change = |wheel: usize, back: usize| (moment.commands[back][wheel] - moment.commands[back + 1][wheel]) / 50.0;
    let reversal = |wheel: usize| {
        let [now, before] = [moment.commands[0][wheel], moment.commands[1][wheel]];
        if now * before < 0.0 { now.signum() } else { 0.0 }
    };
    [
        1.0,
        way,
        way.abs(),
        way * way.abs(),
        turn,
        turn.abs(),
        turn * turn.abs(),
        way * turn,
        way * moment.elapsed_min * 2.5,
        turn * moment.elapsed_min * 2.5,
        cos,
        sin,
        way * cos,
        way * sin,
        way * (cos * cos - sin * sin),
        way * 2.0 * sin * cos,
        way * place.x,
        way * place.y,
        change(0, 0),
        change(1, 0),
        change(0, 1),
        change(1, 1),
        reversal(0),
        reversal(1),
        way * place.length_squared(),
        turn * place.length_squared(),
        kick(moment),
        kick(moment).abs() * way.signum(),
    ]
}

/// The turn before, where the robot as a whole goes the other way than before: what trails behind swings round.
fn kick(moment: &StepContext) -> f64 {
    let [now, before] = [moment.commands[0], moment.commands[1]];
    let reverses = (now[0] + now[1]) * (before[0] + before[1]) < 0.0;
    if reverses { ((before[1] - before[0]) / 50.0).clamp(-1.0, 1.0) } else { 0.0 }
}

/// Circumstances of a reading, each of the order of one.
fn sonar_features(moment: &StepContext) -> [f64; SONAR_FEATURES] {
    let [distance_cm, incidence_rad] = moment.faced.unwrap_or([300.0, 0.0]);
    let (metres, incidence) = (distance_cm.min(300.0) / 100.0, incidence_rad / 0.8);
    let heading = moment.pose.heading_rad;
    let [left, right] = moment.commands[1].map(|c| c / 50.0);
    // What is faced may be another thing in the middle of the room than at its rim.
    let faced_cm = moment.pose.position_cm + moment.pose.direction() * distance_cm.min(300.0);
    let rim = (faced_cm - moment.middle_cm) / 100.0;
    [
        1.0,
        metres,
        metres * metres,
        incidence,
        incidence.abs(),
        incidence * incidence,
        metres * incidence.abs(),
        moment.echo_before.map_or(0.0, |e| if e { 0.5 } else { -0.5 }),
        libm::cos(heading),
        libm::sin(heading),
        moment.elapsed_min * 2.5,
        0.5 * (left + right),
        0.5 * (right - left),
        metres * moment.elapsed_min * 2.5,
        rim.length(),
        rim.x,
        rim.y,
    ]
}
