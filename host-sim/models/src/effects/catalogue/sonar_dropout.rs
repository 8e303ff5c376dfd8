//! Missing readings come in bursts.

use super::parameters;
use crate::effects::parameter::Guesses;
use crate::effects::{Effect, Hook, Parameter, Place, Variant};

pub const EFFECT: Effect = Effect {
    id: "sonar_dropout",
    name: "bursts of missing readings",
    what: "Missing readings come one after the other.",
    in_logs: "Missing readings follow each other, at any distance and incidence angle.",
    imitated_by: &["sonar_absorption"],
    check: "Let the robot stand before a wall, log a few hundred readings, and see whether the missing ones come in \
            rows; wiggle the sensor's cable meanwhile.",
    place: Some(Place::Sensor),
    needs_known_robot: false,
    variants: &[Variant {
        id: "lost_share",
        parameters: Dropout::PARAMETERS,
        hooks: &[Hook::Sensor(&|v, context, sensor| {
            let Dropout { persistence, probability } = Dropout::read(v);
            // Over many readings the chain loses the share that a first reading loses.
            let lost = match context.echo_before {
                Some(false) => persistence,
                Some(true) => probability * (1.0 - persistence) / (1.0 - probability),
                None => probability,
            };
            sensor.perturbation.p_dropout = 1.0 - (1.0 - sensor.perturbation.p_dropout) * (1.0 - lost);
        })],
    }],
};

parameters! {
    Dropout {
        /// Chance that a missing reading is followed by another, as a two-state chain has it: anything from none to all.
        persistence: Parameter::new("", 0.0, [0.0, 1.0]).from(Guesses::At(&[0.3, 0.6])),
        /// Share of readings that are lost. A sensor that loses every second reading is broken.
        probability: Parameter::new("", 0.0, [0.0, 0.5]).prior_sd(0.2).from(Guesses::At(&[0.05, 0.1])),
    }
}
