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
        Variant {
            id: "as_mirrors",
            parameters: Mirrors::PARAMETERS,
            hooks: &[Hook::Ray(&|v, _, s| {
                let Mirrors { share, log_odds_loss } = Mirrors::read(v);
                s.perturbation.mirroring += share;
                s.perturbation.spreading += SPREADING * share;
                s.perturbation.attenuation += log_odds_loss;
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

/// n of the first-echo law, the median over eleven sensors: log-odds per unit of the natural logarithm of the distance.
const SPREADING: f64 = 3.65;

parameters! {
    Mirrors {
        /// Share of what walls usually send elsewhere and air usually spreads (docs/sonar.md, the first-echo law): nothing in
        /// a textbook, one of a usual sensor, and seldom much more.
        share: Parameter::new("", 0.0, [0.0, 1.5]).from(Guesses::At(&[1.0])).report(Report::Hidden),
        /// Log-odds of an echo that are lost squarely before a wall at a metre: usual sensors differ by 2 in that.
        log_odds_loss: Parameter::new("", 0.0, [-4.0, 8.0])
            .prior_sd(3.0)
            .from(Guesses::At(&[0.0, 3.0]))
            .report(Report::OddsFactor),
    }
}
