//! Explanation: is there a gap, which effects cause it, how probable is each, and what cannot be told apart.

mod covariates;
pub mod profile;
pub mod strata;

use serde::Serialize;
use serde_json::{Map, Value};

use super::calibration::Calibration;
use super::compare::Comparison;
use super::remainder::Remainder;
use crate::logs::Robot;
use crate::statistics::rounding;
use crate::statistics::summary::logistic;

/// An effect that explains the gap.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NamedEffect {
    /// Its id.
    pub id: &'static str,
    /// How probable it is.
    #[serde(serialize_with = "rounding::number")]
    pub probability: f64,
    /// How strong it is, by the names of docs/formats.md.
    pub parameters: Map<String, Value>,
    /// Effects that these logs cannot tell from it.
    pub ambiguous_with: Vec<&'static str>,
}

/// What was found, worked out once.
pub enum Judged {
    /// The logs agree with the simulator within its own error.
    NoGap,
    /// Effects explain the gap, the most probable first.
    Known {
        /// The effects.
        effects: Vec<NamedEffect>,
    },
    /// There is a gap and no effect explains it.
    Unknown,
}

impl Judged {
    /// Judges what was confirmed.
    pub fn of(found: &Comparison, robot: &Robot, calibration: &Calibration) -> Self {
        let unexplained = unexplained_nats(found);
        let effects = named(found, robot, calibration);
        let vague = effects.iter().any(|e| e.ambiguous_with.len() > calibration.judgement.most_ambiguous);
        let likeliest = effects.first().is_some_and(|first| first.probability >= unknown(found, calibration));
        if likeliest && !vague && explained_fraction(found) >= calibration.adequate {
            Judged::Known { effects }
        } else if !effects.is_empty() || unexplained > 0.0 {
            Judged::Unknown
        } else {
            Judged::NoGap
        }
    }
}

/// The share of what could be explained that the chosen effects explain.
pub fn explained_fraction(found: &Comparison) -> f64 {
    let explained = explained_nats(found).max(0.0);
    let all = explained + unexplained_nats(found);
    if all > 0.0 { explained / all } else { 1.0 }
}

/// How probable an answer is whose effects explain this fraction, and whose rivals have these relative likelihoods.
pub fn probability(explained_fraction: f64, rivals: impl Iterator<Item = f64>, calibration: &Calibration) -> f64 {
    let known = logistic((explained_fraction - calibration.adequate) / calibration.adequacy_width);
    let doubt: f64 = rivals.map(|likelihood| libm::pow(likelihood, 1.0 / calibration.temperature)).sum();
    calibration.accuracy_cap * known / (1.0 + doubt)
}

fn named(found: &Comparison, robot: &Robot, calibration: &Calibration) -> Vec<NamedEffect> {
    let (gap, fraction) = (gap(found, calibration), explained_fraction(found));
    let one = |(place, candidate): (usize, &crate::effects::Candidate)| {
        let rivals = found.likelihoods_in_place_of(place, calibration);
        let ambiguous = rivals.iter().filter(|(_, likelihood)| *likelihood >= calibration.judgement.rival_likelihood());
        NamedEffect {
            id: candidate.effect,
            probability: gap * probability(fraction, rivals.iter().map(|r| r.1), calibration),
            parameters: candidate.variant.reported(found.chosen.values_of(place), robot),
            ambiguous_with: ambiguous.map(|(id, _)| *id).collect(),
        }
    };
    let mut named: Vec<NamedEffect> = found.chosen.hypothesis.candidates.iter().enumerate().map(one).collect();
    named.sort_by(|a, b| b.probability.total_cmp(&a.probability));
    named
}

fn explained_nats(found: &Comparison) -> f64 {
    found.chosen.gain_over(&found.none).nats
}

fn unexplained_nats(found: &Comparison) -> f64 {
    let of = |remainder: &Remainder| remainder.by_block.iter().sum::<f64>();
    found.beyond_chosen.iter().map(of).sum::<f64>().max(0.0)
}

/// How probable a gap is that is none of chance: half where the effects gain just what the gate asks for, and nearly
/// certain from strong evidence beyond it on.
fn gap(found: &Comparison, calibration: &Calibration) -> f64 {
    let beyond = explained_nats(found) - calibration.effect.nats;
    logistic(beyond / calibration.judgement.strong_nats)
}

/// How probable a gap is whose cause is none that is known.
fn unknown(found: &Comparison, calibration: &Calibration) -> f64 {
    gap(found, calibration) * (1.0 - probability(explained_fraction(found), std::iter::empty(), calibration))
}

#[cfg(test)]
mod tests;
