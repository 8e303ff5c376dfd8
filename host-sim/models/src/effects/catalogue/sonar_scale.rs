//! Readings are too long or short by one factor.

use super::parameters;
use crate::effects::parameter::Guesses;
use crate::effects::{Effect, Hook, Parameter, Place, Variant};

pub const EFFECT: Effect = Effect {
    id: "sonar_scale",
    name: "sonar scale",
    what: "Readings are too long or too short by one factor.",
    in_logs: "The error of readings grows in proportion to the distance.",
    imitated_by: &["sonar_offset", "tracker_scale"],
    check: "Place the sensor squarely before a wall at 50, 100 and 200 cm by a ruler: the error grows with the \
            distance.",
    place: Some(Place::Sensor),
    needs_known_robot: false,
    variants: &[Variant {
        id: "gain",
        parameters: Scale::PARAMETERS,
        hooks: &[Hook::Sensor(&|v, _, sensor| sensor.perturbation.gain *= Scale::read(v).factor)],
    }],
};

parameters! {
    Scale {
        /// Factor on readings. The speed of sound changes by 0.2 % a kelvin and a sensor's clock by a few per cent; 0.7
        /// and 1.4 are those of a sensor that is set for another medium or unit.
        factor: Parameter::new("", 1.0, [0.7, 1.4]).prior_sd(0.1).from(Guesses::At(&[1.02, 0.98])),
    }
}
