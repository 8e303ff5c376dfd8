//! Now and then a random short reading.

use super::parameters;
use crate::effects::parameter::Guesses;
use crate::effects::{Effect, Hook, Parameter, Place, Variant};

pub const EFFECT: Effect = Effect {
    id: "sonar_crosstalk",
    name: "crosstalk",
    what: "Now and then there is a random reading that is too short, from another source of sound.",
    in_logs: "Single readings are too short by random amounts.",
    imitated_by: &["sonar_ghost", "sonar_noise"],
    check: "Switch off every other ultrasonic sensor, and compressed air, in the room, and log again.",
    place: Some(Place::Sensor),
    needs_known_robot: false,
    variants: &[Variant {
        id: "short",
        parameters: Crosstalk::PARAMETERS,
        hooks: &[Hook::Sensor(&|v, _, sensor| {
            let Crosstalk { probability } = Crosstalk::read(v);
            sensor.perturbation.p_short = 1.0 - (1.0 - sensor.perturbation.p_short) * (1.0 - probability);
        })],
    }],
};

parameters! {
    Crosstalk {
        /// Chance of it in a reading: another sensor that is heard more often drowns this one.
        probability: Parameter::new("", 0.0, [0.0, 0.6]).prior_sd(0.2).from(Guesses::At(&[0.03, 0.15])),
    }
}
