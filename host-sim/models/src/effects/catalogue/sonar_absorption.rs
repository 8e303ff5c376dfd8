//! Surfaces return less.

use super::parameters;
use crate::effects::parameter::{Guesses, Report};
use crate::effects::{Effect, Hook, Parameter, Place, Variant};

pub const EFFECT: Effect = Effect {
    id: "sonar_absorption",
    name: "absorbing surfaces",
    what: "Surfaces return less sound, so that echoes are missing.",
    in_logs: "Echoes are missing at distances and incidence angles at which the simulator expects them.",
    imitated_by: &["sonar_dropout", "sonar_beam"],
    check: "Hold a hard board before the wall that gives no reading: if it gives one, the wall swallows the sound.",
    place: Some(Place::Sensor),
    needs_known_robot: false,
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
            id: "weak_echoes",
            parameters: WeakEchoes::PARAMETERS,
            hooks: &[Hook::Sensor(&|v, _, s| {
                let WeakEchoes { log_odds_loss, obliquely } = WeakEchoes::read(v);
                s.perturbation.attenuation_per_m += log_odds_loss;
                s.perturbation.attenuation_per_incidence += obliquely * log_odds_loss;
            })],
        },
        Variant {
            id: "specular",
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

/// Log-odds of an echo that are lost. Eight turn a sure echo into a rare one; below zero surfaces return more.
const LOG_ODDS_LOSS: Parameter =
    Parameter::new("", 0.0, [-4.0, 8.0]).prior_sd(2.0).from(Guesses::At(&[0.3, -0.3, 1.5])).report(Report::OddsFactor);

parameters! {
    Absorption {
        /// Everywhere, a metre of distance, or 45 degrees of incidence; see [`LOG_ODDS_LOSS`].
        log_odds_loss: LOG_ODDS_LOSS,
    }
}

parameters! {
    WeakEchoes {
        /// A metre of distance; see [`LOG_ODDS_LOSS`].
        log_odds_loss: LOG_ODDS_LOSS,
        /// Beside that, per 45 degrees of incidence, as a multiple of it: what a surface swallows of an echo that was loud goes
        /// unnoticed, and slanted surfaces return weak ones as distant surfaces do.
        obliquely: Parameter::new("", 1.0, [0.0, 4.0]).prior_sd(1.0).report(Report::Hidden),
    }
}

/// n of the first-echo law, the median over eleven sensors: log-odds per unit of the natural logarithm of the distance.
const SPREADING: f64 = 3.65;

parameters! {
    Mirrors {
        /// Share of what walls usually send elsewhere and air usually spreads (docs/explanation/sonar.md, the first-echo law): nothing in
        /// a textbook, one of a usual sensor, and seldom much more.
        share: Parameter::new("", 0.0, [0.0, 1.5]).from(Guesses::At(&[1.0])).report(Report::Hidden),
        /// Log-odds of an echo that are lost squarely before a wall at a metre: usual sensors differ by 2 in that.
        log_odds_loss: Parameter::new("", 0.0, [-4.0, 8.0])
            .prior_sd(3.0)
            .from(Guesses::At(&[0.0, 3.0]))
            .report(Report::OddsFactor),
    }
}
