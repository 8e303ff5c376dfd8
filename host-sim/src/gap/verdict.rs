//! What an explanation is worth: is there a gap, which effects, with what probability, and what cannot be told apart.

use serde::{Deserialize, Serialize};

use super::explanation::{Explanation, LEAST_NATS, Leftover};
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

/// Of what could be explained the effects have to explain this share to be the cause.
const ADEQUATE: f64 = 0.68;
/// How sharply adequacy decides.
const ADEQUACY_WIDTH: f64 = 0.06;
/// Nats over which a gap turns from doubtful to certain.
const GAP_WIDTH: f64 = 4.0;
/// A rival with at least this share of the winner's weight is named beside it.
pub const RIVAL: f64 = 0.12;
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
        let named = !self.chosen.ids().is_empty();
        let vague = self.named().iter().any(|n| n.ambiguous_with.len() > MOST_AMBIGUOUS);
        if named && !vague && self.adequacy() >= ADEQUATE {
            Verdict::Known
        } else if named || self.unexplained() > 0.0 {
            Verdict::Unknown
        } else {
            Verdict::NoGap
        }
    }

    /// The chosen effects, the most certain first.
    pub fn named(&self) -> Vec<Named> {
        let known = logistic((self.adequacy() - ADEQUATE) / ADEQUACY_WIDTH);
        let gap = logistic((self.explained() - LEAST_NATS) / GAP_WIDTH);
        let ids = self.chosen.ids();
        let mut named: Vec<Named> =
            (0..ids.len()).map(|place| named(ids[place], &self.chosen, &self.rivals_of(place), known * gap)).collect();
        named.sort_by(|a, b| b.probability.total_cmp(&a.probability));
        named
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
            (weight >= RIVAL).then_some((weight, rival, [ids[place], other]))
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

fn named(id: &'static str, chosen: &Fitted, rivals: &[&Fitted], certain: f64) -> Named {
    let weights: Vec<(&'static str, f64)> = rivals
        .iter()
        .filter_map(|r| {
            let other = r.ids().into_iter().find(|i| !chosen.ids().contains(i))?;
            Some((other, weight(chosen, r)))
        })
        .collect();
    let total: f64 = 1.0 + weights.iter().map(|w| w.1).sum::<f64>();
    let mut ambiguous_with: Vec<&'static str> = Vec::new();
    for (other, w) in &weights {
        if *w >= RIVAL && !ambiguous_with.contains(other) {
            ambiguous_with.push(other);
        }
    }
    Named { id, probability: certain / total, ambiguous_with }
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
