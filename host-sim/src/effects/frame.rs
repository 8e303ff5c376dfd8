//! Effects of what watches the robot: the camera's frame and the compass.

use std::f64::consts::PI;

use glam::DVec2;

use super::effect::{Hook, Parameter, PoseIncrement, Reported, Sensor, StepContext, Variant};
use super::rounded;
use crate::geometry::{Pose, direction, wrap_rad};

/// The forms of this family.
pub const VARIANTS: &[Variant] = &[
    Variant {
        id: "tracker_rotation",
        name: "about the scene's middle",
        parameters: ANGLE,
        starts: ANGLE_STARTS,
        acts: &[Hook::Motion(rotated_way), Hook::Sensor(rotated_place)],
        report: angle,
    },
    Variant {
        id: "tracker_rotation",
        name: "about the origin",
        parameters: ANGLE,
        starts: ANGLE_STARTS,
        acts: &[Hook::Motion(rotated_way), Hook::Sensor(rotated_place_about_origin)],
        report: angle,
    },
    Variant {
        id: "tracker_rotation",
        name: "positions right, headings off",
        parameters: ANGLE,
        starts: ANGLE_STARTS,
        acts: &[Hook::Motion(rotated_way), Hook::Sensor(|v, _, s| s.yaw_rad += v[0])],
        report: angle,
    },
    Variant {
        id: "tracker_scale",
        name: "about the scene's middle",
        parameters: SCALE,
        starts: SCALE_STARTS,
        acts: &[Hook::Motion(scaled_way), Hook::Sensor(scaled_place)],
        report: |v, _| vec![("factor", rounded(v[0]))],
    },
    Variant {
        id: "tracker_scale",
        name: "about the origin",
        parameters: SCALE,
        starts: SCALE_STARTS,
        acts: &[Hook::Motion(scaled_way), Hook::Sensor(scaled_place_about_origin)],
        report: |v, _| vec![("factor", rounded(v[0]))],
    },
    Variant {
        id: "lens_distortion",
        name: "grows with the square of the distance",
        parameters: &[Parameter::new(-0.2, 0.2, 0.0)],
        starts: &[&[0.01], &[-0.01]],
        acts: &[Hook::Motion(distorted_way), Hook::Sensor(distorted_place)],
        report: |v, _| vec![("per_m2", rounded(v[0]))],
    },
    Variant {
        id: "compass_disturbance",
        name: "one wave a turn",
        parameters: WAVE,
        starts: WAVE_STARTS,
        acts: &[Hook::Motion(one_wave_way), Hook::Sensor(one_wave_heading)],
        report: |v, _| vec![("deg", rounded(v[0].to_degrees()))],
    },
    Variant {
        id: "compass_disturbance",
        name: "two waves a turn",
        parameters: WAVE,
        starts: WAVE_STARTS,
        acts: &[Hook::Motion(two_waves_way), Hook::Sensor(two_waves_heading)],
        report: |v, _| vec![("deg", rounded(v[0].to_degrees()))],
    },
];

const ANGLE: &[Parameter] = &[Parameter::new(-0.5, 0.5, 0.0)];
const ANGLE_STARTS: &[&[f64]] = &[&[0.03], &[-0.03]];
const SCALE: &[Parameter] = &[Parameter::new(0.7, 1.4, 1.0)];
const SCALE_STARTS: &[&[f64]] = &[&[1.02], &[0.98]];
/// Amplitude and phase in radians.
const WAVE: &[Parameter] = &[Parameter::new(0.0, 0.6, 0.0), Parameter::new(-2.0 * PI, 2.0 * PI, 0.0)];
const WAVE_STARTS: &[&[f64]] = &[&[0.05, 0.0], &[0.05, PI / 2.0], &[0.05, PI], &[0.05, -PI / 2.0]];

fn rotated_way(v: &[f64], _: &StepContext, motion: &mut PoseIncrement) {
    motion.rotate_way(v[0]);
}

fn rotated_place(v: &[f64], moment: &StepContext, sensor: &mut Sensor) {
    sensor.robot.position_cm = unrotated(v[0], sensor.robot.position_cm, moment.middle_cm);
}

fn rotated_place_about_origin(v: &[f64], _: &StepContext, sensor: &mut Sensor) {
    sensor.robot.position_cm = unrotated(v[0], sensor.robot.position_cm, DVec2::ZERO);
}

fn unrotated(angle_rad: f64, at_cm: DVec2, about_cm: DVec2) -> DVec2 {
    about_cm + direction(-angle_rad).rotate(at_cm - about_cm)
}

fn scaled_way(v: &[f64], _: &StepContext, motion: &mut PoseIncrement) {
    motion.forward_cm *= v[0];
    motion.lateral_cm *= v[0];
}

fn scaled_place(v: &[f64], moment: &StepContext, sensor: &mut Sensor) {
    let about_cm = moment.middle_cm;
    sensor.robot.position_cm = about_cm + (sensor.robot.position_cm - about_cm) / v[0];
}

fn scaled_place_about_origin(v: &[f64], _: &StepContext, sensor: &mut Sensor) {
    sensor.robot.position_cm /= v[0];
}

/// The picture's scale at a place is 1 + k r², with r in metres from the picture's middle.
fn distorted_way(v: &[f64], moment: &StepContext, motion: &mut PoseIncrement) {
    let start_cm = moment.pose.position_cm;
    let true_cm = undistorted(v[0], start_cm, moment.middle_cm);
    let heading = direction(moment.pose.heading_rad);
    let end_cm = true_cm + heading.rotate(DVec2::new(motion.forward_cm, motion.lateral_cm));
    let from_middle = end_cm - moment.middle_cm;
    let seen_cm = moment.middle_cm + from_middle * (1.0 + v[0] * from_middle.length_squared() * 1e-4);
    let way = direction(-moment.pose.heading_rad).rotate(seen_cm - start_cm);
    (motion.forward_cm, motion.lateral_cm) = (way.x, way.y);
}

fn distorted_place(v: &[f64], moment: &StepContext, sensor: &mut Sensor) {
    sensor.robot.position_cm = undistorted(v[0], sensor.robot.position_cm, moment.middle_cm);
}

/// Where something is that is seen at `seen_cm`: the inverse of the distortion, by a few rounds of substitution.
fn undistorted(per_m2: f64, seen_cm: DVec2, middle_cm: DVec2) -> DVec2 {
    let seen = seen_cm - middle_cm;
    let place = (0..6).fold(seen, |r, _| seen / (1.0 + per_m2 * r.length_squared().min(1e5) * 1e-4).max(0.3));
    middle_cm + place
}

/// The heading's error at a heading.
fn wave(v: &[f64], heading_rad: f64, waves: f64) -> f64 {
    v[0] * libm::sin(waves * heading_rad - v[1])
}

fn waves_way(v: &[f64], moment: &StepContext, motion: &mut PoseIncrement, waves: f64) {
    let here = wave(v, moment.pose.heading_rad, waves);
    let there = wave(v, moment.pose.heading_rad + motion.turn_rad, waves);
    motion.rotate_way(-here);
    motion.turn_rad += there - here;
}

fn waves_heading(v: &[f64], sensor: &mut Sensor, waves: f64) {
    let Pose { position_cm, heading_rad } = sensor.robot;
    sensor.robot = Pose { position_cm, heading_rad: wrap_rad(heading_rad - wave(v, heading_rad, waves)) };
}

fn one_wave_way(v: &[f64], moment: &StepContext, motion: &mut PoseIncrement) {
    waves_way(v, moment, motion, 1.0);
}

fn two_waves_way(v: &[f64], moment: &StepContext, motion: &mut PoseIncrement) {
    waves_way(v, moment, motion, 2.0);
}

fn one_wave_heading(v: &[f64], _: &StepContext, sensor: &mut Sensor) {
    waves_heading(v, sensor, 1.0);
}

fn two_waves_heading(v: &[f64], _: &StepContext, sensor: &mut Sensor) {
    waves_heading(v, sensor, 2.0);
}

fn angle(v: &[f64], _: f64) -> Reported {
    vec![("deg", rounded(v[0].to_degrees()))]
}
