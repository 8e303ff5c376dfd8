//! Surfaces return less.

use super::parameters;
use crate::effects::parameter::{Guesses, Report};
use crate::effects::{Effect, Hook, Parameter, Variant};

pub const EFFECT: Effect = Effect {
    id: "sonar_absorption",
    name: "absorbing surfaces",
    what: "Surfaces return less sound, so that echoes are missing.",
    check: "Hold a hard board before the wall that gives no reading: if it gives one, the wall swallows the sound.",
    variants: &[
        Variant {
            id: "everywhere",
            parameters: Absorption::PARAMETERS,
            hooks: &[Hook::Sensor(&|v, _, s| s.perturbation.attenuation += Absorption::read(v).log_odds_loss)],
        },
        Variant {
            id: "with_distance",
            parameters: Absorption::PARAMETERS,
            hooks: &[Hook::Sensor(&|v, _, s| s.perturbation.attenuation_per_m += Absorption::read(v).log_odds_loss)],
        },
        Variant {
            id: "with_incidence",
            parameters: Absorption::PARAMETERS,
            hooks: &[Hook::Sensor(&|v, _, s| {
                s.perturbation.attenuation_per_incidence += Absorption::read(v).log_odds_loss
            })],
        },
    ],
};

parameters! {
    Absorption {
        /// Log-odds of an echo that are lost: everywhere, a metre of distance, or 45 degrees of incidence. Eight turn a
        /// sure echo into a rare one; below zero surfaces return more.
        log_odds_loss: Parameter::new("", 0.0, [-4.0, 8.0])
            .prior_sd(2.0)
            .from(Guesses::At(&[0.3, -0.3, 1.5]))
            .report(Report::OddsFactor),
    }
}
