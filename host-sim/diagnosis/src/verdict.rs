//! The verdict: is there a gap, which effects cause it, and how probable is each.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use super::budget::{Part, SCATTER};
use super::calibration::Calibration;
use super::confirm::Confirmed;
use super::explanation::Explanation;
use super::fit::FitContext;
use super::interval::intervals;
use super::predictive_check;
use super::remainder::Remainder;
use super::ruler::by_ruler;
use super::wider_noise::WiderNoise;
use mindgap_foundations::channel::Channel;
use mindgap_foundations::statistics::rounding;
use mindgap_foundations::statistics::summary::{logistic, standard_error_of_sum};
use mindgap_logs::Robot;
use mindgap_models::effects::parameter::Settings;
use mindgap_models::effects::{Candidate, Place, catalogue};

/// The answer in one word.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// The logs agree with the simulator within its own error.
    NoGap,
    /// Effects of the catalogue explain the gap, or only the noise of steps is wider.
    Known,
    /// Effects explain a part of the gap, and a remainder is confirmed that they do not explain.
    PartlyKnown,
    /// There is a gap, and no effect explains it.
    Unknown,
}

/// A verdict with the effects that it names.
#[derive(Clone, Debug)]
pub struct Conclusion {
    /// The verdict.
    pub verdict: Verdict,
    /// The effects, most probable first; none unless the gap is known or partly known.
    pub effects: Vec<NamedEffect>,
}

/// An effect that explains the gap or a part of it.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct NamedEffect {
    /// Its id.
    pub id: &'static str,
    /// Where in the robot it acts, if that is known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub place: Option<Place>,
    /// The range sensor concerned, where there are several.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sensor: Option<String>,
    /// Its probability.
    #[serde(serialize_with = "rounding::number")]
    pub probability: f64,
    /// Its strength, by the names in docs/reference/effects.md.
    #[schemars(with = "Settings")]
    pub parameters: Map<String, Value>,
    /// Ids of effects that these logs cannot distinguish from it.
    pub ambiguous_with: Vec<&'static str>,
    /// Its share of the gap, if there is a budget.
    #[serde(serialize_with = "rounding::optional")]
    pub share: Option<f64>,
    /// 95 % intervals of the numeric parameters; null at a physical bound.
    #[schemars(with = "BTreeMap<String, Option<[f64; 2]>>")]
    pub intervals: Map<String, Value>,
    /// Names of the parameters that lie at a physical bound.
    pub at_bound: Vec<&'static str>,
    /// The columns beyond commands and poses that show that it acts here and not elsewhere in the robot.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub witness: Vec<&'static str>,
    /// What a ruler, a scale or a stopwatch would show, with its 95 % interval, where one would show it.
    pub ruler: Option<String>,
}

/// The fraction of the explainable gap in a channel that effects explain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Explained {
    /// The fraction.
    pub fraction: f64,
    /// Its standard error.
    pub error: f64,
}

/// Probabilities that differ by less count as equal: a few hundred calibration cases resolve no less.
const EQUALLY_PROBABLE: f64 = 0.05;

/// A smaller share of the gap may be what the form of the other effects lacks: next to a single injected effect, false ones had
/// up to 5.8 %.
const LEAST_SHARE: f64 = 0.06;

/// Scale of the logistic distribution with standard deviation one: √3 / π.
const LOGISTIC_SCALE: f64 = 0.551_328_895_421_792_1;

/// Maximum probability of an effect with a parameter at its bound, whose likelihood has no maximum within it, of effects that
/// open-loop paths refute, and of one of several that explains next to nothing.
const DOUBTFUL: f64 = 0.5;

impl Verdict {
    /// Returns its name in diagnosis.json.
    pub fn id(self) -> &'static str {
        match self {
            Verdict::NoGap => "no_gap",
            Verdict::Known => "known",
            Verdict::PartlyKnown => "partly_known",
            Verdict::Unknown => "unknown",
        }
    }

    /// Returns whether it names effects.
    pub fn names_effects(self) -> bool {
        matches!(self, Verdict::Known | Verdict::PartlyKnown)
    }
}

impl Conclusion {
    /// Concludes from what was confirmed.
    pub fn of(found: &Confirmed, robot: &Robot, calibration: &Calibration) -> Self {
        let conclusion = |verdict, effects| Conclusion { verdict, effects };
        // Noise that grows with speed or is autocorrelated has a cause that is not named.
        let has_structured_noise = found.wider_noise.iter().any(|noise| !noise.is_uniform);
        let least = Explained::at_least(found);
        let effects = named(found, least, robot, calibration);
        let doubt = gap_probability(found, calibration) * (1.0 - probability(least, std::iter::empty(), calibration));
        let is_probable = effects.first().is_some_and(|first| first.probability >= doubt);
        let is_whole = least.fraction >= calibration.adequate
            && !has_structured_noise
            && predictive_check::refuted(found, calibration).is_none();
        if is_probable && is_whole {
            return conclusion(Verdict::Known, effects);
        }
        // A wrong effect leaves a remainder wherever it explains something. A right effect next to another cause fully explains
        // the channels that the other cause does not touch. If few runs leave open whether it does, it is named.
        let most = Explained::at_most(found, calibration);
        let effects = named(found, most, robot, calibration);
        if !effects.is_empty() && most.possible_fraction(calibration) >= calibration.adequate {
            return conclusion(Verdict::PartlyKnown, effects);
        }
        let remaining_nats = found.beyond_chosen.iter().map(Remainder::nats).sum::<f64>();
        if !effects.is_empty() || remaining_nats > 0.0 || has_structured_noise {
            return conclusion(Verdict::Unknown, Vec::new());
        }
        if !found.unconfirmed.is_empty() || !found.outliers.is_empty() {
            return conclusion(Verdict::Unknown, Vec::new());
        }
        match noise_alone(&found.wider_noise, calibration) {
            Some(noise) => conclusion(Verdict::Known, vec![noise]),
            None => conclusion(Verdict::NoGap, Vec::new()),
        }
    }
}

/// Adds the columns that decided between places in the robot to effects.
pub fn with_witnesses(mut effects: Vec<NamedEffect>, found: &Confirmed, context: &FitContext) -> Vec<NamedEffect> {
    let ids = found.chosen.ids();
    for named in &mut effects {
        if let Some(effect) = ids.iter().position(|id| *id == named.id) {
            named.witness = found.chosen.witness(effect, context.calibration.judgement.strong_nats, context.rows);
        }
    }
    effects
}

/// Adds the shares of a budget to effects and sorts them by probability. Those of equal probability are sorted by share. One of
/// several that explains next to nothing is doubtful.
pub fn with_shares(effects: Vec<NamedEffect>, budget: &[Part]) -> Vec<NamedEffect> {
    let share = |id: &str| budget.iter().find(|part| part.id == id).map(|part| part.share);
    let has_others = effects.len() > 1;
    let with_share = |effect: NamedEffect| {
        let share = share(effect.id);
        let is_doubtful = has_others && share.is_some_and(|share| share < LEAST_SHARE);
        let most = if is_doubtful { DOUBTFUL } else { 1.0 };
        NamedEffect { share, probability: effect.probability.min(most), ..effect }
    };
    in_order(effects.into_iter().map(with_share).collect())
}

/// Sorts effects as [`with_shares`] does.
pub fn in_order(mut effects: Vec<NamedEffect>) -> Vec<NamedEffect> {
    let key = |effect: &NamedEffect| ((effect.probability / EQUALLY_PROBABLE).round(), effect.share.unwrap_or(0.0));
    effects.sort_by(|a, b| {
        let ((p, s), (q, t)) = (key(a), key(b));
        q.total_cmp(&p).then(t.total_cmp(&s))
    });
    effects
}

impl Explained {
    /// Returns the fraction in the channel of which the effects explain least. A right effect leaves what its form lacks, a
    /// fraction of what it explains there; a remainder where it explains little has another cause. A robot with two wheels moves
    /// sideways only by driving and turning, so imperfect forms of these leave something there.
    pub fn at_least(found: &Confirmed) -> Self {
        let in_channel = |channel| match channel {
            Channel::Lateral => Explained::of_nats(explained_nats(&Channel::MOTION, found), channel, found),
            _ => Explained::of_channel(channel, found),
        };
        let least = Channel::SIMULATED.map(in_channel).into_iter().min_by(|a, b| a.fraction.total_cmp(&b.fraction));
        least.unwrap_or(Explained { fraction: 1.0, error: 0.0 })
    }

    /// Returns the fraction in the channel of which the effects may explain most, zero if they explain no more than chance in
    /// any.
    fn at_most(found: &Confirmed, calibration: &Calibration) -> Self {
        let touched =
            Channel::SIMULATED.into_iter().filter(|c| explained_nats(&[*c], found) >= calibration.effect_nats);
        let by_channel = touched.map(|channel| Explained::of_channel(channel, found));
        let possible = |explained: &Explained| explained.possible_fraction(calibration);
        by_channel.max_by(|a, b| possible(a).total_cmp(&possible(b))).unwrap_or(Explained { fraction: 0.0, error: 0.0 })
    }

    /// Returns the largest fraction within the error.
    fn possible_fraction(&self, calibration: &Calibration) -> f64 {
        self.fraction + calibration.judgement.rival_z * self.error
    }

    fn of_channel(channel: Channel, found: &Confirmed) -> Self {
        Explained::of_nats(explained_nats(&[channel], found), channel, found)
    }

    /// Compares explained nats with the remainder of a channel.
    fn of_nats(explained: f64, channel: Channel, found: &Confirmed) -> Self {
        let remainder = found.beyond_chosen.iter().find(|r| r.channel() == channel);
        let (nats, error) = remainder.map_or((0.0, 0.0), |r| (r.nats(), standard_error_of_sum(&r.by_block)));
        let (explained, left) = (explained.max(0.0), nats.max(0.0));
        let all = explained + left;
        if all > 0.0 {
            // By the derivative of the fraction: the remainder has the larger error.
            Explained { fraction: explained / all, error: explained * error / (all * all) }
        } else {
            Explained { fraction: 1.0, error: 0.0 }
        }
    }
}

/// Returns the probability of an effect if the effects explain this fraction and its rivals have these relative likelihoods.
pub fn probability(explained: Explained, rivals: impl Iterator<Item = f64>, calibration: &Calibration) -> f64 {
    let width = libm::hypot(calibration.adequacy_width, LOGISTIC_SCALE * explained.error);
    let adequacy = logistic((explained.fraction - calibration.adequate) / width);
    let doubt: f64 = rivals.map(|likelihood| libm::pow(likelihood, 1.0 / calibration.temperature)).sum();
    calibration.accuracy_cap * adequacy / (1.0 + doubt)
}

/// Without readings a late command and an old pose are one cause, which goes by the first name: the other is listed as ambiguous,
/// and the delay itself is not in doubt.
const ONE_NAME: [&str; 2] = ["latency", "tracker_delay"];

fn named(found: &Confirmed, explained: Explained, robot: &Robot, calibration: &Calibration) -> Vec<NamedEffect> {
    let gap = gap_probability(found, calibration);
    let is_refuted = predictive_check::refuted(found, calibration).is_some();
    let name = |(effect, candidate): (usize, &Candidate)| {
        let rivals = found.rival_likelihoods(effect, calibration);
        let ambiguous = rivals.iter().filter(|(_, likelihood)| *likelihood >= calibration.judgement.rival_likelihood());
        let at_bound = found.chosen.at_bound(effect);
        let next_to_others = found.probability_next_to_others(effect, calibration);
        let is_doubtful = !at_bound.is_empty() || is_refuted && candidate.variant.moves();
        let most = if is_doubtful { DOUBTFUL } else { 1.0 };
        let parameters = candidate.variant.reported(found.chosen.values_of(effect), robot);
        let mut intervals = intervals(&found.chosen, effect, robot);
        at_bound.iter().for_each(|name| drop(intervals.insert((*name).into(), Value::Null)));
        let doubted = rivals
            .iter()
            .filter(|(rival, _)| [candidate.effect, *rival] != ONE_NAME)
            .map(|(_, likelihood)| *likelihood);
        let probability = gap * next_to_others * probability(explained, doubted, calibration);
        NamedEffect {
            id: candidate.effect,
            place: catalogue::place(candidate.effect),
            sensor: None,
            probability: probability.min(most),
            ruler: by_ruler(candidate.effect, &parameters, &intervals, robot),
            parameters,
            ambiguous_with: ambiguous.map(|(id, _)| *id).collect(),
            share: None,
            intervals,
            at_bound,
            witness: Vec::new(),
        }
    };
    let mut effects: Vec<NamedEffect> = found.chosen.hypothesis.candidates.iter().enumerate().map(name).collect();
    effects.sort_by(|a, b| b.probability.total_cmp(&a.probability));
    effects
}

/// Names wider noise as the only difference, if there is any.
fn noise_alone(noise: &[WiderNoise], calibration: &Calibration) -> Option<NamedEffect> {
    let parameter = |noise: &WiderNoise| match noise.axis {
        0 => ("forward_cm", noise.fitted),
        1 => ("lateral_cm", noise.fitted),
        _ => ("turn_deg", noise.fitted.to_degrees()),
    };
    let parameters = noise.iter().map(parameter).map(|(name, value)| (name.into(), value.into()));
    (!noise.is_empty()).then(|| NamedEffect {
        id: SCATTER,
        place: None,
        sensor: None,
        probability: calibration.accuracy_cap,
        parameters: parameters.collect(),
        ambiguous_with: Vec::new(),
        share: None,
        intervals: Map::new(),
        at_bound: Vec::new(),
        witness: Vec::new(),
        ruler: None,
    })
}

fn explained_nats(channels: &[Channel], found: &Confirmed) -> f64 {
    channels.iter().map(|channel| found.chosen.gained_in(*channel, &found.fits.null)).sum()
}

/// Returns the probability that the gap is not chance: one half if the effects gain exactly what the gate requires, and nearly one
/// from strong evidence beyond it on.
fn gap_probability(found: &Confirmed, calibration: &Calibration) -> f64 {
    let beyond = found.chosen.gain_over(&found.fits.null).nats - calibration.effect_nats;
    logistic(beyond / calibration.judgement.strong_nats)
}

#[cfg(test)]
mod tests;
