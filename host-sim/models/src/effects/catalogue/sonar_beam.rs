//! The beam is wider or narrower.

use super::parameters;
use crate::effects::parameter::{Guesses, Report};
use crate::effects::{Effect, Hook, Parameter, Place, Variant};

pub const EFFECT: Effect = Effect {
    id: "sonar_beam",
    name: "beam width",
    what: "The beam is wider or narrower than assumed, so that it meets edges earlier or later.",
    in_logs: "Edges and corners are seen too early or too late; walls that are met squarely agree.",
    imitated_by: &["sonar_yaw", "sonar_multipath"],
    check: "Move a post across in front of the sensor at one metre and measure how far to each side it is still seen.",
    place: Some(Place::Sensor),
    needs_known_robot: false,
    variants: &[
        Variant {
            id: "width",
            parameters: Width::PARAMETERS,
            hooks: &[Hook::Sensor(&|v, _, sensor| sensor.perturbation.width *= Width::read(v).factor)],
        },
        Variant {
            id: "width_and_strength",
            parameters: WidthAndStrength::PARAMETERS,
            hooks: &[Hook::Sensor(&|v, _, sensor| {
                let WidthAndStrength { factor, log_odds_loss } = WidthAndStrength::read(v);
                sensor.perturbation.width *= factor;
                sensor.perturbation.attenuation += log_odds_loss;
            })],
        },
        Variant {
            id: "beam_for_ray",
            parameters: BeamForRay::PARAMETERS,
            hooks: &[Hook::Sensor(&|v, _, sensor| sensor.perturbation.width *= BeamForRay::read(v).factor)],
        },
    ],
};

/// Factor on the beam's angle. Reported beams of one and the same sensor reach from 10 to 90 degrees.
const FACTOR: Parameter = Parameter::new("", 1.0, [0.2, 4.0]).prior_sd(0.8).from(Guesses::At(&[0.7, 1.3, 2.0]));

parameters! {
    Width {
        /// See [`FACTOR`].
        factor: FACTOR,
    }
}

parameters! {
    WidthAndStrength {
        /// See [`FACTOR`].
        factor: FACTOR,
        /// What a beam of another width lacks in strength; four is a factor of 55 on the odds of an echo.
        log_odds_loss: Parameter::new("", 0.0, [-4.0, 4.0]).prior_sd(1.5).report(Report::Hidden),
    }
}

parameters! {
    BeamForRay {
        /// Factor on the angle of the textbook's narrow ray, which is a twentieth of a usual beam.
        factor: Parameter::new("", 1.0, [1.0, 30.0]).from(Guesses::At(&[6.0, 12.0, 20.0])),
    }
}
