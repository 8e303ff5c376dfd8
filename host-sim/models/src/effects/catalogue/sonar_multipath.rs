//! Now and then a reading longer than what the axis meets: sound that a surface mirrors away and that comes back by way of
//! another. Where the simulator knows rays that walls mirror on, more of them come back, and the room says how long their
//! ways are; where it does not, as in the textbook, the reading is anywhere beyond.

use super::parameters;
use crate::effects::parameter::{Guesses, Report};
use crate::effects::{Effect, Hook, Parameter, Place, SensorState, StepContext, Variant};

pub const EFFECT: Effect = Effect {
    id: "sonar_multipath",
    name: "sound by way of other walls",
    what: "Now and then a reading is too long: a slanted surface mirrors the sound away and it comes back by way of \
           another.",
    in_logs: "Readings at oblique incidence are now and then much too long.",
    imitated_by: &["sonar_noise", "sonar_beam"],
    check: "Stand the robot at 45 degrees to a wall: too long readings become right when a soft cloth covers the \
            opposite wall.",
    place: Some(Place::Sensor),
    needs_known_robot: false,
    variants: &[
        Variant {
            id: "mirrored",
            parameters: MirroredSound::PARAMETERS,
            hooks: &[Hook::Sensor(&|v, _, sensor| {
                let MirroredSound { mirrored_log_odds_loss, log_odds_loss } = MirroredSound::read(v);
                sensor.perturbation.attenuation_mirrored += mirrored_log_odds_loss;
                sensor.perturbation.attenuation_per_incidence += log_odds_loss;
            })],
        },
        Variant {
            id: "detours",
            parameters: Detours::PARAMETERS,
            hooks: &[Hook::Ray(&|v, _, sensor| {
                let Detours { probability, share } = Detours::read(v);
                sensor.perturbation.p_long_given_none = probability;
                sensor.perturbation.mirroring += share;
            })],
        },
        Variant {
            id: "oblique",
            parameters: Multipath::PARAMETERS,
            hooks: &[Hook::SensorHere(&|v, context, sensor| {
                let Multipath { probability } = Multipath::read(v);
                lengthen(probability, context, sensor);
            })],
        },
        Variant {
            id: "oblique_and_strength",
            parameters: MirroringSurfaces::PARAMETERS,
            hooks: &[Hook::SensorHere(&|v, context, sensor| {
                let MirroringSurfaces { probability, log_odds_loss } = MirroringSurfaces::read(v);
                lengthen(probability, context, sensor);
                sensor.perturbation.attenuation_per_incidence += log_odds_loss;
            })],
        },
    ],
};

/// Chance of it in a reading of a surface at 45 degrees; it is twice that at grazing incidence, and almost sure at most.
const PROBABILITY: Parameter = Parameter::new("", 0.0, [0.0, 0.45]).prior_sd(0.2).from(Guesses::At(&[0.05, 0.2]));

parameters! {
    MirroredSound {
        /// Log-odds of an echo by way of a second wall that are lost where the first one mirrors it; how long the way is
        /// follows from the room. Below zero more comes by such ways; eight turn the rare into the sure.
        mirrored_log_odds_loss: Parameter::new("", 0.0, [-8.0, 8.0])
            .prior_sd(2.0)
            .from(Guesses::At(&[-1.0, -3.0]))
            .report(Report::OddsFactor),
        /// Log-odds of an echo that are lost per 45 degrees: reflected sound does not come straight back.
        log_odds_loss: Parameter::new("", 0.0, [-4.0, 4.0]).prior_sd(1.5).report(Report::Hidden),
    }
}

parameters! {
    Detours {
        /// Chance that sound of which nothing comes straight back is heard by way of another wall: filters and rooms differ in
        /// that from next to none to more than half.
        probability: Parameter::new("", 0.0, [0.0, 0.98]).from(Guesses::At(&[0.3])),
        /// Share of what walls usually send on rather than back (docs/explanation/sonar.md, the first-echo law): one of usual walls.
        share: Parameter::new("", 0.0, [0.0, 1.5]).from(Guesses::At(&[1.0])).report(Report::Hidden),
    }
}

parameters! {
    Multipath {
        /// See [`PROBABILITY`].
        probability: PROBABILITY,
    }
}

parameters! {
    MirroringSurfaces {
        /// See [`PROBABILITY`].
        probability: PROBABILITY,
        /// Log-odds of an echo that are lost per 45 degrees: less comes back directly, and more by way of another surface.
        log_odds_loss: Parameter::new("", 0.0, [-4.0, 4.0]).prior_sd(1.5).report(Report::Hidden),
    }
}

/// The square of the incidence's sine is the share of sound that a surface sends on rather than back, in the simplest
/// law: none at normal incidence, half at 45 degrees and all at grazing.
fn lengthen(probability: f64, context: &StepContext, sensor: &mut SensorState) {
    let Some([_, incidence_rad]) = context.faced else { return };
    let sine = libm::sin(incidence_rad);
    let p_long = 2.0 * probability * sine * sine;
    sensor.perturbation.p_long = 1.0 - (1.0 - sensor.perturbation.p_long) * (1.0 - p_long);
}
