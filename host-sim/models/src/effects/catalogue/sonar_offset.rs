//! Readings are too long or short by one length.

use super::parameters;
use crate::effects::parameter::Guesses;
use crate::effects::{Effect, Hook, Parameter, Place, Variant};

pub const EFFECT: Effect = Effect {
    id: "sonar_offset",
    name: "sonar offset",
    what: "Readings are too long or too short by one length.",
    in_logs: "The error of readings is the same at all distances.",
    imitated_by: &["sonar_scale", "marker_offset"],
    check: "Place the sensor squarely before a wall at 50, 100 and 200 cm by a ruler: the error is the same at each.",
    place: Some(Place::Sensor),
    needs_known_robot: false,
    variants: &[Variant {
        id: "length",
        parameters: Offset::PARAMETERS,
        hooks: &[Hook::Sensor(&|v, _, sensor| sensor.perturbation.offset_cm += Offset::read(v).cm)],
    }],
};

parameters! {
    Offset {
        /// Added to readings. NXT sensors are known to be 1 to 4 cm off; a mount on the wrong end of a robot makes 25 cm.
        cm: Parameter::new("cm", 0.0, [-25.0, 25.0]).prior_sd(6.0).from(Guesses::At(&[1.0, -1.0])),
    }
}
