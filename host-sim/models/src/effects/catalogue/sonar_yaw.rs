//! The sensor is mounted turned.

use super::parameters;
use crate::effects::parameter::Guesses;
use crate::effects::{Effect, Hook, Parameter, Place, Variant};

pub const EFFECT: Effect = Effect {
    id: "sonar_yaw",
    name: "turned sensor",
    what: "The sensor is mounted turned against the robot's heading.",
    in_logs: "Readings belong to a direction to one side of the heading: too long or too short as a wall slants.",
    imitated_by: &["sonar_beam", "tracker_rotation"],
    check: "Lay a ruler along the robot and one along the sensor's two eyes: they should make a right angle. If they do, the \
            sensor hears better to one side, which looks the same in logs.",
    place: Some(Place::Sensor),
    needs_known_robot: false,
    variants: &[Variant {
        id: "axis",
        parameters: Yaw::PARAMETERS,
        hooks: &[Hook::Sensor(&|v, _, sensor| sensor.yaw_rad += Yaw::read(v).deg.to_radians())],
    }],
};

parameters! {
    Yaw {
        /// Rotation counter-clockwise. A mount by a single pin slips by 10 degrees; beyond 30 it would be seen.
        deg: Parameter::new("deg", 0.0, [-30.0, 30.0]).prior_sd(10.0).from(Guesses::At(&[3.5, -3.5, 11.5, -11.5])),
    }
}
