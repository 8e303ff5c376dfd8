//! The camera's scale is off.

use super::parameters;
use crate::effects::parameter::Guesses;
use crate::effects::{Effect, Hook, Parameter, Place, Variant};

pub const EFFECT: Effect = Effect {
    id: "tracker_scale",
    name: "camera scale",
    what: "Tracked lengths are off by one factor.",
    in_logs: "Forward motion is off by one factor; turns agree.",
    imitated_by: &["drive_scale"],
    check: "Put the robot at two marks that are one metre apart by a ruler, and compare the tracked distance.",
    place: Some(Place::Tracker),
    needs_known_robot: false,
    variants: &[
        Variant {
            id: "about_the_middle",
            parameters: Scale::PARAMETERS,
            hooks: &[
                SCALED,
                Hook::SensorHere(&|v, context, sensor| {
                    let from_middle = sensor.robot.position_cm - context.middle_cm;
                    sensor.robot.position_cm = context.middle_cm + from_middle / Scale::read(v).factor;
                }),
            ],
        },
        Variant {
            id: "about_the_origin",
            parameters: Scale::PARAMETERS,
            hooks: &[SCALED, Hook::SensorHere(&|v, _, sensor| sensor.robot.position_cm /= Scale::read(v).factor)],
        },
    ],
};

const SCALED: Hook = Hook::Motion(&|v, _, increment| {
    let Scale { factor } = Scale::read(v);
    increment.forward *= factor;
    increment.lateral *= factor;
});

parameters! {
    Scale {
        /// Factor on tracked lengths. A marker 10 cm above the floor under a camera at 2.5 m makes 4 %; 0.7 and 1.4 are
        /// another lens.
        factor: Parameter::new("", 1.0, [0.7, 1.4]).prior_sd(0.1).from(Guesses::At(&[1.02, 0.98])),
    }
}
