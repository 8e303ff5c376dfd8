//! What an explanation is worth: is there a gap, which effects, with what probability, and what cannot be told apart.

use serde::{Deserialize, Serialize};

use super::calibration::Calibration;
use super::explanation::{Explanation, Leftover};
use super::search::{Fitted, Gain};

/// The answer in one word.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// The logs agree with the simulator within its own error.
    NoGap,
    /// Effects of the table explain the gap.
    Known,
    /// There is a gap and none of them does.
    Unknown,
}

/// An effect that is named, with its rivals.
#[derive(Clone, Debug)]
pub struct Named {
    /// Its name.
    pub id: &'static str,
    /// Its probability.
    pub probability: f64,
    /// Effects that these logs cannot tell from it.
    pub ambiguous_with: Vec<&'static str>,
}

/// Nats over which a gap turns from doubtful to certain.
const GAP_WIDTH: f64 = 4.0;
/// An effect that more others than these could stand for is no cause that anybody could act on.
const MOST_AMBIGUOUS: usize = 5;
/// Differences below this are nothing, nats.
const INDIFFERENT: f64 = 3.0;

impl Explanation {
    /// Nats that the chosen effects gain over none.
    pub fn explained(&self) -> f64 {
        self.chosen.gain_over(&self.none).nats
    }

    /// Nats that remain to be explained beyond the chosen effects.
    pub fn unexplained(&self) -> f64 {
        sum(&self.beyond_chosen)
    }

    /// The share of what could be explained that the chosen effects explain.
    pub fn adequacy(&self) -> f64 {
        let explained = self.explained().max(0.0);
        let all = explained + self.unexplained();
        if all > 0.0 { explained / all } else { 1.0 }
    }

    /// The answer.
    pub fn verdict(&self) -> Verdict {
        let named = self.named();
        let vague = named.iter().any(|n| n.ambiguous_with.len() > MOST_AMBIGUOUS);
        let likeliest = named.first().is_some_and(|first| first.probability >= self.probability_of_unknown());
        if likeliest && !vague && self.adequacy() >= self.calibration.adequate {
            Verdict::Known
        } else if !named.is_empty() || self.unexplained() > 0.0 {
            Verdict::Unknown
        } else {
            Verdict::NoGap
        }
    }

    /// The chosen effects, the most certain first.
    pub fn named(&self) -> Vec<Named> {
        let named = |place: usize| {
            let weights = self.weights_in_place_of(place);
            let rivals = weights.iter().filter(|(_, weight)| *weight >= self.calibration.rival);
            let probability = self.probability_of_gap()
                * probability(self.adequacy(), weights.iter().map(|w| w.1), &self.calibration);
            Named { id: self.chosen.ids()[place], probability, ambiguous_with: rivals.map(|(id, _)| *id).collect() }
        };
        let mut named: Vec<Named> = (0..self.chosen.ids().len()).map(named).collect();
        named.sort_by(|a, b| b.probability.total_cmp(&a.probability));
        named
    }

    /// How likely there is a gap that is none of chance.
    fn probability_of_gap(&self) -> f64 {
        logistic((self.explained() - self.calibration.effect.nats) / GAP_WIDTH)
    }

    /// How likely there is one, and its cause none that is known.
    fn probability_of_unknown(&self) -> f64 {
        self.probability_of_gap() * (1.0 - probability(self.adequacy(), std::iter::empty(), &self.calibration))
    }

    /// The effects that could be in the place of one of the chosen, with their weights against its one, best first.
    pub fn weights_in_place_of(&self, place: usize) -> Vec<(&'static str, f64)> {
        let ids = self.chosen.ids();
        let mut weights: Vec<(&'static str, f64)> = Vec::new();
        for rival in self.rivals_of(place) {
            let other = rival.ids().into_iter().find(|id| !ids.contains(id));
            if let Some(other) = other.filter(|id| weights.iter().all(|(known, _)| known != id)) {
                weights.push((other, weight(&self.chosen, rival)));
            }
        }
        weights
    }

    /// The best fit in which the most certain effects give way to others.
    pub fn runner_up(&self) -> Option<&Fitted> {
        let ids = self.chosen.ids();
        let others = self.rivals.iter().flatten().filter(|r| ids.iter().any(|id| !r.ids().contains(id)));
        others.max_by(|a, b| a.score().total_cmp(&b.score()))
    }

    /// The fit with the effect that is confused most with one of the chosen, and the two effects; none when the answer
    /// is plain.
    pub fn closest_rival(&self) -> Option<(&Fitted, [&'static str; 2])> {
        let ids = self.chosen.ids();
        let confused = |place: usize| {
            let rival = *self.rivals_of(place).first()?;
            let other = rival.ids().into_iter().find(|id| !ids.contains(id))?;
            let weight = weight(&self.chosen, rival);
            (weight >= self.calibration.rival).then_some((weight, rival, [ids[place], other]))
        };
        let closest = (0..ids.len()).filter_map(confused).max_by(|a, b| a.0.total_cmp(&b.0));
        closest.map(|(_, rival, between)| (rival, between))
    }

    /// Fits with another effect in place of one, best first.
    fn rivals_of(&self, place: usize) -> Vec<&Fitted> {
        let ids = self.chosen.ids();
        let id = ids[place];
        let in_place = |r: &&Fitted| !r.ids().contains(&id);
        self.rivals.iter().flatten().filter(in_place).filter(|r| r.ids().len() == ids.len()).collect()
    }
}

/// How likely an answer is right whose effects explain the share `adequacy` of what could be explained, and whose
/// rivals have these weights.
pub fn probability(adequacy: f64, rivals: impl Iterator<Item = f64>, calibration: &Calibration) -> f64 {
    let known = logistic((adequacy - calibration.adequate) / calibration.adequacy_width);
    let doubt: f64 = rivals.map(|weight| libm::pow(weight, 1.0 / calibration.temperature)).sum();
    calibration.trust * known / (1.0 + doubt)
}

/// The weight of a rival against the winner's of one: how likely so small a lead is chance.
pub fn weight(winner: &Fitted, rival: &Fitted) -> f64 {
    let lead = winner.score() - rival.score();
    let error = Gain::of(&winner.gains_over(rival)).error;
    let z = lead.max(0.0) / (error * error + INDIFFERENT * INDIFFERENT).sqrt();
    libm::exp(-0.5 * z * z)
}

fn sum(leftovers: &[Leftover]) -> f64 {
    leftovers.iter().flat_map(|l| &l.by_block).sum::<f64>().max(0.0)
}

fn logistic(x: f64) -> f64 {
    1.0 / (1.0 + libm::exp(-x))
}
