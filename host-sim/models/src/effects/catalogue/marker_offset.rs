//! The tracked marker is not above the middle of the axle.

use glam::DVec2;

use super::parameters;
use crate::effects::parameter::Guesses;
use crate::effects::{Effect, Hook, Parameter, Variant};
use mindgap_foundations::geometry::direction;

pub const EFFECT: Effect = Effect {
    id: "marker_offset",
    name: "marker off the axle",
    what: "The tracked marker does not sit over the middle of the axle, so turns on the spot look like motion.",
    check: "Measure from the marker to the middle of the axle with a ruler; turned on the spot by hand, the marker \
            draws a circle of that radius.",
    variants: &[Variant {
        id: "rigid",
        parameters: Marker::PARAMETERS,
        hooks: &[
            Hook::Motion(&|v, _, increment| {
                let at_cm = Marker::read(v).on_the_robot();
                let carried_cm = direction(increment.turn).rotate(at_cm) - at_cm;
                increment.forward += carried_cm.x;
                increment.lateral += carried_cm.y;
            }),
            Hook::SensorHere(&|v, _, sensor| {
                let at_cm = Marker::read(v).on_the_robot();
                sensor.robot.position_cm -= direction(sensor.robot.heading_rad).rotate(at_cm);
            }),
        ],
    }],
};

/// Either way: a marker farther off would not lie on the robot's body.
const OFFSET: Parameter = Parameter::new("cm", 0.0, [-15.0, 15.0]).prior_sd(4.0);

parameters! {
    Marker {
        /// How far ahead of the axle's middle.
        ahead_cm: OFFSET.from(Guesses::At(&[2.0, -2.0])),
        /// How far to its left.
        left_cm: OFFSET,
    }
}

impl Marker {
    fn on_the_robot(&self) -> DVec2 {
        DVec2::new(self.ahead_cm, self.left_cm)
    }
}
