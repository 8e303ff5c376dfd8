//! Effects of the ultrasonic sensor: where it looks, what comes back, and what it makes of that.

use super::effect::{Hook, Parameter, Reported, Sensor, StepContext, Variant};
use super::rounded;
use crate::geometry::{Pose, wrap_rad};

/// The forms of this family.
pub const VARIANTS: &[Variant] = &[
    Variant {
        id: "sonar_scale",
        name: "a factor",
        parameters: &[Parameter::new(0.7, 1.4, 1.0)],
        starts: &[&[1.02], &[0.98]],
        acts: &[Hook::Sensor(|v, _, s| s.change.gain *= v[0])],
        report: |v, _| vec![("factor", rounded(v[0]))],
    },
    Variant {
        id: "sonar_offset",
        name: "a length",
        parameters: &[Parameter::new(-25.0, 25.0, 0.0)],
        starts: &[&[1.0], &[-1.0]],
        acts: &[Hook::Sensor(|v, _, s| s.change.offset_cm += v[0])],
        report: |v, _| vec![("cm", rounded(v[0]))],
    },
    Variant {
        id: "sonar_yaw",
        name: "a turned axis",
        parameters: &[Parameter::new(-0.5, 0.5, 0.0)],
        starts: &[&[0.06], &[-0.06], &[0.2], &[-0.2]],
        acts: &[Hook::Sensor(|v, _, s| s.yaw_rad += v[0])],
        report: |v, _| vec![("deg", rounded(v[0].to_degrees()))],
    },
    Variant {
        id: "sonar_beam",
        name: "another width",
        parameters: &[Parameter::new(0.2, 4.0, 1.0)],
        starts: &[&[0.7], &[1.3], &[2.0]],
        acts: &[Hook::Sensor(|v, _, s| s.width *= v[0])],
        report: |v, _| vec![("factor", rounded(v[0]))],
    },
    Variant {
        id: "sonar_beam",
        name: "another width, and another strength with it",
        parameters: &[Parameter::new(0.2, 4.0, 1.0), Parameter::new(-4.0, 4.0, 0.0)],
        starts: &[&[0.7, 0.1], &[1.3, -0.1], &[2.0, -0.5]],
        acts: &[Hook::Sensor(wider_and_stronger)],
        report: |v, _| vec![("factor", rounded(v[0]))],
    },
    Variant {
        id: "sonar_beam",
        name: "a beam where a ray was thought",
        parameters: &[Parameter::new(1.0, 30.0, 1.0)],
        starts: &[&[6.0], &[12.0], &[20.0]],
        acts: &[Hook::Sensor(|v, _, s| s.width *= v[0])],
        report: |v, _| vec![("factor", rounded(v[0]))],
    },
    Variant {
        id: "sonar_ghost",
        name: "in place of an echo",
        parameters: GHOST,
        starts: GHOST_STARTS,
        acts: &[Hook::Sensor(ghost_for_echo)],
        report: ghost,
    },
    Variant {
        id: "sonar_ghost",
        name: "whether there is an echo or not",
        parameters: GHOST,
        starts: GHOST_STARTS,
        acts: &[Hook::Sensor(ghost_for_any)],
        report: ghost,
    },
    Variant {
        id: "sonar_dropout",
        name: "a missing reading is followed by another",
        parameters: &[Parameter::new(0.0, 1.0, 0.0), Parameter::new(0.0, 0.5, 0.0)],
        starts: &[&[0.3, 0.05], &[0.6, 0.1]],
        acts: &[Hook::Sensor(dropout)],
        report: |v, _| vec![("probability", rounded(v[1])), ("goes_on", rounded(v[0]))],
    },
    Variant {
        id: "sonar_lag",
        name: "where the robot was",
        parameters: &[Parameter::new(0.0, 2.0, 0.0)],
        starts: &[&[0.2], &[0.6], &[1.0], &[1.6]],
        acts: &[Hook::Sensor(old_pose)],
        report: |v, _| vec![("steps", rounded(v[0]))],
    },
    Variant {
        id: "sonar_lag",
        name: "the reading before",
        parameters: &[Parameter::new(0.0, 1.0, 0.0)],
        starts: &[&[0.1], &[0.5]],
        acts: &[Hook::Sensor(old_reading)],
        report: |v, _| vec![("steps", rounded(v[0]))],
    },
    Variant {
        id: "sonar_absorption",
        name: "less comes back",
        parameters: DAMPING,
        starts: DAMPING_STARTS,
        acts: &[Hook::Sensor(|v, _, s| s.change.attenuation += v[0])],
        report: absorbed,
    },
    Variant {
        id: "sonar_absorption",
        name: "less comes back from afar",
        parameters: DAMPING,
        starts: DAMPING_STARTS,
        acts: &[Hook::Sensor(|v, _, s| s.change.attenuation_per_m += v[0])],
        report: absorbed,
    },
    Variant {
        id: "sonar_absorption",
        name: "less comes back from aslant",
        parameters: DAMPING,
        starts: DAMPING_STARTS,
        acts: &[Hook::Sensor(|v, _, s| s.change.attenuation_per_incidence += v[0])],
        report: absorbed,
    },
    Variant {
        id: "sonar_crosstalk",
        name: "a random short reading",
        parameters: &[Parameter::new(0.0, 0.6, 0.0)],
        starts: &[&[0.03], &[0.15]],
        acts: &[Hook::Sensor(|v, _, s| s.change.p_short = 1.0 - (1.0 - s.change.p_short) * (1.0 - v[0]))],
        report: |v, _| vec![("probability", rounded(v[0]))],
    },
    Variant {
        id: "sonar_noise",
        name: "more scatter",
        parameters: &[Parameter::new(0.0, 15.0, 0.0)],
        starts: &[&[1.0], &[3.0]],
        acts: &[Hook::Sensor(|v, _, s| {
            s.change.scatter_cm = (s.change.scatter_cm * s.change.scatter_cm + v[0] * v[0]).sqrt()
        })],
        report: |v, _| vec![("cm", rounded(v[0]))],
    },
];

/// Probability, and the reading in cm.
const GHOST: &[Parameter] = &[Parameter::new(0.0, 0.6, 0.0), Parameter::new(5.0, 80.0, 20.0)];
/// As near to each other as a ghost scatters: from farther off none is found.
const GHOST_STARTS: &[&[f64]] = &[
    &[0.05, 5.0],
    &[0.05, 8.0],
    &[0.05, 11.0],
    &[0.05, 14.0],
    &[0.05, 17.0],
    &[0.05, 20.0],
    &[0.05, 23.0],
    &[0.05, 26.0],
    &[0.05, 29.0],
    &[0.05, 32.0],
    &[0.05, 35.0],
    &[0.05, 38.0],
    &[0.05, 41.0],
    &[0.05, 44.0],
    &[0.05, 47.0],
    &[0.05, 50.0],
    &[0.05, 53.0],
    &[0.05, 56.0],
    &[0.05, 59.0],
    &[0.05, 62.0],
    &[0.05, 65.0],
    &[0.05, 68.0],
    &[0.05, 71.0],
    &[0.05, 74.0],
    &[0.05, 77.0],
    &[0.05, 80.0],
];
/// Distances that differ by more are of something else, cm.
const OTHER_CM: f64 = 4.0;
const DAMPING: &[Parameter] = &[Parameter::new(-4.0, 8.0, 0.0)];
const DAMPING_STARTS: &[&[f64]] = &[&[0.3], &[-0.3], &[1.5]];

fn wider_and_stronger(v: &[f64], _: &StepContext, sensor: &mut Sensor) {
    sensor.width *= v[0];
    sensor.change.attenuation += v[1];
}

fn ghost_for_echo(v: &[f64], _: &StepContext, sensor: &mut Sensor) {
    sensor.change.p_ghost_given_echo = v[0];
    sensor.change.ghost_cm = v[1];
}

fn ghost_for_any(v: &[f64], moment: &StepContext, sensor: &mut Sensor) {
    ghost_for_echo(v, moment, sensor);
    sensor.change.p_ghost_given_none = v[0];
}

fn dropout(v: &[f64], moment: &StepContext, sensor: &mut Sensor) {
    let lost = if moment.echo_before == Some(false) { v[0] } else { v[1] };
    sensor.change.p_dropout = 1.0 - (1.0 - sensor.change.p_dropout) * (1.0 - lost);
}

/// A reading is old where it is the one before although something else is faced now; where the same is faced, readings
/// repeat anyway.
fn old_reading(v: &[f64], moment: &StepContext, sensor: &mut Sensor) {
    let (Some([now_cm, _]), Some([before_cm, _])) = (moment.faced, moment.faced_before) else { return };
    if (now_cm - before_cm).abs() > OTHER_CM {
        sensor.change.p_stale = v[0];
    }
}

/// The robot's pose `v[0]` steps ago, between rows in proportion.
fn old_pose(v: &[f64], moment: &StepContext, sensor: &mut Sensor) {
    let known = |back: usize| match back {
        0 => Some(moment.pose),
        _ => moment.earlier[back - 1],
    };
    let whole = (v[0] as usize).min(1);
    let (Some(newer), Some(older)) = (known(whole), known(whole + 1)) else { return };
    let share = v[0] - whole as f64;
    let position_cm = newer.position_cm.lerp(older.position_cm, share);
    let turn = wrap_rad(older.heading_rad - newer.heading_rad);
    sensor.robot = Pose { position_cm, heading_rad: wrap_rad(newer.heading_rad + share * turn) };
}

fn ghost(v: &[f64], _: f64) -> Reported {
    vec![("probability", rounded(v[0])), ("cm", rounded(v[1]))]
}

/// The factor on a ray's odds to come back, at one metre or at 45 degrees.
fn absorbed(v: &[f64], _: f64) -> Reported {
    vec![("factor", rounded(libm::exp(-v[0])))]
}
