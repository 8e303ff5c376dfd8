//! Now and then one constant wrong reading.

use super::parameters;
use crate::effects::parameter::Guesses;
use crate::effects::{Effect, Hook, Parameter, Place, Variant};

pub const EFFECT: Effect = Effect {
    id: "sonar_ghost",
    name: "ghost reading",
    what: "Now and then there is one constant wrong reading, whatever is in front.",
    in_logs: "One reading recurs at places where nothing is at that distance.",
    imitated_by: &["sonar_crosstalk"],
    check: "Point the sensor into an empty room and list its readings: the ghost is the one that comes again; look \
            for a cable or a part of the robot at that distance.",
    place: Some(Place::Sensor),
    needs_known_robot: false,
    variants: &[
        Variant {
            id: "for_an_echo",
            parameters: Ghost::PARAMETERS,
            hooks: &[Hook::Sensor(&|v, _, sensor| {
                let Ghost { probability, cm } = Ghost::read(v);
                sensor.perturbation.p_ghost_given_echo = probability;
                sensor.perturbation.ghost_cm = cm;
            })],
        },
        Variant {
            id: "always",
            parameters: Ghost::PARAMETERS,
            hooks: &[Hook::Sensor(&|v, _, sensor| {
                let Ghost { probability, cm } = Ghost::read(v);
                sensor.perturbation.p_ghost_given_echo = probability;
                sensor.perturbation.p_ghost_given_none = probability;
                sensor.perturbation.ghost_cm = cm;
            })],
        },
    ],
};

parameters! {
    Ghost {
        /// Chance of it in a reading. Above 0.6 the sensor would measure little else.
        probability: Parameter::new("", 0.0, [0.0, 0.6]).prior_sd(0.2).from(Guesses::At(&[0.05])),
        /// The reading: parts of the robot itself and the floor lie between 5 and 80 cm. A ghost scatters by a centimetre, so
        /// a fit that starts farther off than 1.5 cm does not find it, and a change by as much is large.
        cm: Parameter::new("cm", 20.0, [5.0, 80.0]).scale(1.5).from(Guesses::Every(3.0)),
    }
}
