//! Explanation: is there a gap, which effects cause it, how probable is each, and what cannot be told apart.

mod covariates;
pub mod evidence;
pub mod profile;
pub mod rollouts;
pub mod room_map;
pub mod strata;

use serde::Serialize;
use serde_json::{Map, Value};

use super::budget::{Part, SCATTER};
use super::calibration::Calibration;
use super::channel::Channel;
use super::compare::Comparison;
use super::remainder::Remainder;
use mindgap_foundations::statistics::rounding;
use mindgap_foundations::statistics::summary::{logistic, standard_error_of_sum};
use mindgap_logs::Robot;

/// An effect that explains the gap, or a part of it.
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
    /// Its share of the gap, where there is a budget.
    #[serde(serialize_with = "rounding::optional")]
    pub share: Option<f64>,
    /// 95 % intervals of those parameters that are numbers, by the jackknife over blocks of runs.
    pub intervals: Map<String, Value>,
    /// Parameters that lie at the end of what is physically possible.
    pub at_bound: Vec<&'static str>,
}

/// The share of what could be explained in a channel that effects explain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Explained {
    /// The share.
    pub fraction: f64,
    /// Its standard error.
    pub error: f64,
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
    /// Effects explain a part of the gap, and something is left that they do not explain.
    PartlyKnown {
        /// The effects.
        effects: Vec<NamedEffect>,
    },
    /// There is a gap and no effect explains it.
    Unknown,
}

/// Probabilities that differ by less are as good as equal: hundreds of calibrating cases tell no finer.
const AS_PROBABLE: f64 = 0.05;

/// The scale of the logistic law whose standard deviation is one: the root of 3 over pi.
const LOGISTIC_SCALE: f64 = 0.551_328_895_421_792_1;

/// A parameter at its bound has no likeliest value, and of what steps and rollouts say only one can be true: such an effect is as
/// likely wrong as right.
const AS_LIKELY_WRONG: f64 = 0.5;

impl NamedEffect {
    /// Its strength in words, each number with its interval.
    pub fn strength(&self) -> String {
        let interval = |name: &str| {
            let ends = self.intervals.get(name)?.as_array()?;
            let at_bound = if self.at_bound.contains(&name) { ", at the end of what is possible" } else { "" };
            Some(format!(" ({} to {}{at_bound})", ends.first()?, ends.get(1)?))
        };
        let told = self.parameters.iter().map(|(name, value)| {
            let value = value.as_str().map_or_else(|| value.to_string(), String::from);
            format!("{name} {value}{}", interval(name).unwrap_or_default())
        });
        told.collect::<Vec<String>>().join(", ")
    }
}

impl Judged {
    /// Judges what was confirmed.
    pub fn of(found: &Comparison, robot: &Robot, calibration: &Calibration) -> Self {
        let unexplained = unexplained_nats(found);
        // Scatter that grows with speed or comes back follows a cause that is not named.
        let scatters_unevenly = found.scatter.iter().any(|s| !s.is_even);
        let least = Explained::at_least(found);
        let effects = named(found, least, robot, calibration);
        let doubt = gap(found, calibration) * (1.0 - probability(least, std::iter::empty(), calibration));
        let likeliest = effects.first().is_some_and(|first| first.probability >= doubt);
        let is_whole = least.fraction >= calibration.adequate
            && !scatters_unevenly
            && rollouts::refuting(found, calibration).is_none();
        if likeliest && is_whole {
            return Judged::Known { effects };
        }
        // A wrong effect leaves something over wherever it explains something; a right one beside which there is another
        // cause explains the channels that the other one does not touch. Where few runs leave open whether it does, it is told.
        let most = Explained::at_most(found, calibration);
        let effects = named(found, most, robot, calibration);
        if !effects.is_empty() && most.possible_fraction(calibration) >= calibration.adequate {
            return Judged::PartlyKnown { effects };
        }
        if !effects.is_empty() || unexplained > 0.0 || scatters_unevenly {
            return Judged::Unknown;
        }
        match scattered(found, calibration) {
            Some(scatter) => Judged::Known { effects: vec![scatter] },
            None => Judged::NoGap,
        }
    }
}

/// The same effects with their shares of a budget, the most probable first, and of those that are as probable the one that
/// takes most of the gap.
pub fn with_shares(effects: Vec<NamedEffect>, budget: &[Part]) -> Vec<NamedEffect> {
    let share = |id: &str| budget.iter().find(|part| part.id == id).map(|part| part.share);
    let with_share = |effect: NamedEffect| NamedEffect { share: share(effect.id), ..effect };
    let mut effects: Vec<NamedEffect> = effects.into_iter().map(with_share).collect();
    let key = |effect: &NamedEffect| ((effect.probability / AS_PROBABLE).round(), effect.share.unwrap_or(0.0));
    effects.sort_by(|a, b| {
        let ((p, s), (q, t)) = (key(a), key(b));
        q.total_cmp(&p).then(t.total_cmp(&s))
    });
    effects
}

impl Explained {
    /// By the chosen effects, in the channel where they leave most of it. What a right effect leaves is what its form lacks, a
    /// share of what it explains there, and what is left where it explains little is another cause's. Sideways a robot of two
    /// wheels gets by its way and its turn alone, so that forms of these leave something there.
    pub fn at_least(found: &Comparison) -> Self {
        let in_channel = |channel| match channel {
            Channel::Lateral => Explained::beside(explained_nats(&Channel::MOTION, found), channel, found),
            _ => Explained::of_channel(channel, found),
        };
        let least = Channel::ALL.map(in_channel).into_iter().min_by(|a, b| a.fraction.total_cmp(&b.fraction));
        least.unwrap_or(Explained { fraction: 1.0, error: 0.0 })
    }

    /// In the channel of which they explain most; nothing where they explain no more than chance does in any.
    fn at_most(found: &Comparison, calibration: &Calibration) -> Self {
        let touched = Channel::ALL.into_iter().filter(|c| explained_nats(&[*c], found) >= calibration.effect_nats);
        let by_channel = touched.map(|channel| Explained::of_channel(channel, found));
        let possible = |explained: &Explained| explained.possible_fraction(calibration);
        by_channel.max_by(|a, b| possible(a).total_cmp(&possible(b))).unwrap_or(Explained { fraction: 0.0, error: 0.0 })
    }

    /// The largest share that few runs leave open.
    fn possible_fraction(&self, calibration: &Calibration) -> f64 {
        self.fraction + calibration.judgement.rival_z * self.error
    }

    fn of_channel(channel: Channel, found: &Comparison) -> Self {
        Explained::beside(explained_nats(&[channel], found), channel, found)
    }

    /// Where so many nats are explained, beside what is left in a channel.
    fn beside(explained: f64, channel: Channel, found: &Comparison) -> Self {
        let remainder = found.beyond_chosen.iter().find(|r| r.channel() == channel);
        let (nats, error) = remainder.map_or((0.0, 0.0), |r| (r.nats(), standard_error_of_sum(&r.by_block)));
        let (explained, left) = (explained.max(0.0), nats.max(0.0));
        let all = explained + left;
        if all > 0.0 {
            // By the derivative of the share: what is explained is known better than what is left.
            Explained { fraction: explained / all, error: explained * error / (all * all) }
        } else {
            Explained { fraction: 1.0, error: 0.0 }
        }
    }
}

/// How probable an answer is whose effects explain this much, and whose rivals have these relative likelihoods.
pub fn probability(explained: Explained, rivals: impl Iterator<Item = f64>, calibration: &Calibration) -> f64 {
    let width = libm::hypot(calibration.adequacy_width, LOGISTIC_SCALE * explained.error);
    let known = logistic((explained.fraction - calibration.adequate) / width);
    let doubt: f64 = rivals.map(|likelihood| libm::pow(likelihood, 1.0 / calibration.temperature)).sum();
    calibration.accuracy_cap * known / (1.0 + doubt)
}

fn named(found: &Comparison, explained: Explained, robot: &Robot, calibration: &Calibration) -> Vec<NamedEffect> {
    let gap = gap(found, calibration);
    let is_refuted = rollouts::refuting(found, calibration).is_some();
    let one = |(place, candidate): (usize, &mindgap_models::effects::Candidate)| {
        let rivals = found.likelihoods_in_place_of(place, calibration);
        let ambiguous = rivals.iter().filter(|(_, likelihood)| *likelihood >= calibration.judgement.rival_likelihood());
        let at_bound = found.chosen.at_bound(place);
        let beside = found.probability_beside_others(place, calibration);
        let is_doubtful = !at_bound.is_empty() || is_refuted && candidate.variant.moves();
        let most = if is_doubtful { AS_LIKELY_WRONG } else { 1.0 };
        NamedEffect {
            id: candidate.effect,
            probability: (gap * beside * probability(explained, rivals.iter().map(|r| r.1), calibration)).min(most),
            parameters: candidate.variant.reported(found.chosen.values_of(place), robot),
            ambiguous_with: ambiguous.map(|(id, _)| *id).collect(),
            share: None,
            intervals: intervals(found, place, robot),
            at_bound,
        }
    };
    let mut named: Vec<NamedEffect> = found.chosen.hypothesis.candidates.iter().enumerate().map(one).collect();
    named.sort_by(|a, b| b.probability.total_cmp(&a.probability));
    named
}

/// The intervals of the reported numbers.
fn intervals(found: &Comparison, place: usize, robot: &Robot) -> Map<String, Value> {
    let variant = found.chosen.hypothesis.candidates[place].variant;
    let ends: Vec<[f64; 2]> = found.chosen.parameters_of(place).map(|i| found.chosen.interval(i)).collect();
    variant.reported_between(found.chosen.values_of(place), &ends, robot)
}

/// Scatter as the one thing that differs; none where steps scatter as the simulator assumes.
fn scattered(found: &Comparison, calibration: &Calibration) -> Option<NamedEffect> {
    if found.scatter.is_empty() {
        return None;
    }
    let told = |s: &super::scatter::WiderScatter| match s.axis {
        0 => ("forward_cm", s.own),
        1 => ("lateral_cm", s.own),
        _ => ("turn_deg", s.own.to_degrees()),
    };
    let parameters = found
        .scatter
        .iter()
        .map(told)
        .map(|(name, value)| (name.into(), rounding::three_digits(value).into()))
        .collect();
    Some(NamedEffect {
        id: SCATTER,
        probability: calibration.accuracy_cap,
        parameters,
        ambiguous_with: Vec::new(),
        share: None,
        intervals: Map::new(),
        at_bound: Vec::new(),
    })
}

fn explained_nats(channels: &[Channel], found: &Comparison) -> f64 {
    channels.iter().map(|channel| found.chosen.gained_in(*channel, &found.none)).sum()
}

fn unexplained_nats(found: &Comparison) -> f64 {
    found.beyond_chosen.iter().map(Remainder::nats).sum::<f64>().max(0.0)
}

/// How probable a gap is that is none of chance: half where the effects gain just what the gate asks for, and nearly
/// certain from strong evidence beyond it on.
fn gap(found: &Comparison, calibration: &Calibration) -> f64 {
    let beyond = found.chosen.gain_over(&found.none).nats - calibration.effect_nats;
    logistic(beyond / calibration.judgement.strong_nats)
}

#[cfg(test)]
mod tests;
