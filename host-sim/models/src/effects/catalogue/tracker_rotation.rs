//! The camera's frame is turned against the compass's.

use glam::DVec2;

use super::parameters;
use crate::effects::parameter::Guesses;
use crate::effects::{Effect, Hook, Parameter, Place, Variant};
use mindgap_foundations::geometry::direction;

pub const EFFECT: Effect = Effect {
    id: "tracker_rotation",
    name: "turned camera frame",
    what: "The camera's frame is turned against the one that headings are measured in.",
    in_logs: "The robot moves at a fixed angle to its heading, wherever it drives.",
    imitated_by: &["compass_disturbance", "sonar_yaw"],
    check: "Push the robot along a wall by hand: the tracked heading should be the direction of the tracked path, \
            and both the wall's.",
    place: Some(Place::Tracker),
    needs_known_robot: false,
    variants: &[
        Variant {
            id: "about_the_middle",
            parameters: Rotation::PARAMETERS,
            hooks: &[
                ROTATED,
                Hook::SensorHere(&|v, context, sensor| {
                    sensor.robot.position_cm = Rotation::read(v).undone(sensor.robot.position_cm, context.middle_cm);
                }),
            ],
        },
        Variant {
            id: "about_the_origin",
            parameters: Rotation::PARAMETERS,
            hooks: &[
                ROTATED,
                Hook::SensorHere(&|v, _, sensor| {
                    sensor.robot.position_cm = Rotation::read(v).undone(sensor.robot.position_cm, DVec2::ZERO);
                }),
            ],
        },
        Variant {
            id: "heading",
            parameters: Rotation::PARAMETERS,
            hooks: &[ROTATED, Hook::Sensor(&|v, _, sensor| sensor.yaw_rad += Rotation::read(v).deg.to_radians())],
        },
    ],
};

const ROTATED: Hook = Hook::Motion(&|v, _, increment| increment.rotate_translation(Rotation::read(v).deg.to_radians()));

parameters! {
    Rotation {
        /// Rotation counter-clockwise. Compasses and cameras are aligned by eye to about 5 degrees; 30 would be seen.
        deg: Parameter::new("deg", 0.0, [-30.0, 30.0]).prior_sd(8.0).from(Guesses::At(&[1.7, -1.7])),
    }
}

impl Rotation {
    /// Where something is that the turned camera sees at `at_cm`.
    fn undone(&self, at_cm: DVec2, about_cm: DVec2) -> DVec2 {
        about_cm + direction(-self.deg.to_radians()).rotate(at_cm - about_cm)
    }
}
