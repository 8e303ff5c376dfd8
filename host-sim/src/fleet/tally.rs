//! What is kept of all robots while they come: sums, and of each robot its name, the size of its gap, its budget and the
//! strengths of its effects, a few hundred bytes.

use std::collections::BTreeMap;

use serde::Serialize;

use super::robot::Robot;
use crate::effects::Effect;
use crate::gap::budget::{SCATTER, UNEXPLAINED};
use crate::gap::verdict::Verdict;

/// Robots so far.
pub struct Tally {
    /// The effects that competed.
    pub catalogue: &'static [&'static Effect],
    /// Parts of budgets: the effects in the order of the catalogue, scatter, unexplained.
    pub parts: Vec<&'static str>,
    /// Names of the robots that were diagnosed; what follows is in their order.
    pub names: Vec<String>,
    /// Their answers in one word.
    pub verdicts: Vec<Verdict>,
    /// The sizes of their gaps, nats a step.
    pub gaps_nats: Vec<Option<f64>>,
    /// Their budgets: shares of the gap, part by part; all zero where there is no gap.
    pub budgets: Vec<Vec<f32>>,
    /// How often each part was named.
    pub sightings: Vec<Sightings>,
    /// Robots that could not be diagnosed.
    pub refused: Vec<Refused>,
}

/// How often a part of budgets was named, and how strong it was.
#[derive(Clone, Default)]
pub struct Sightings {
    /// Robots whose logs could have shown it.
    pub testable: usize,
    /// Robots in which it is named.
    pub named: usize,
    /// The same, each counted by the probability that it is there.
    pub expected: f64,
    /// By the form of the effect.
    pub strengths: BTreeMap<&'static str, Seen>,
}

/// Robots in which a form of an effect is seen, as places in [`Tally::names`], each with the values of its parameters in their
/// order.
pub type Seen = Vec<(usize, Vec<f64>)>;

/// A robot that could not be diagnosed.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Refused {
    /// Its name.
    pub robot: String,
    /// Why.
    pub reason: String,
}

impl Tally {
    /// Of no robot yet.
    pub fn new(catalogue: &'static [&'static Effect]) -> Self {
        let parts: Vec<&'static str> = catalogue.iter().map(|effect| effect.id).chain([SCATTER, UNEXPLAINED]).collect();
        Tally {
            catalogue,
            sightings: vec![Sightings::default(); parts.len()],
            parts,
            names: Vec::new(),
            verdicts: Vec::new(),
            gaps_nats: Vec::new(),
            budgets: Vec::new(),
            refused: Vec::new(),
        }
    }

    /// With a robot that was diagnosed.
    pub fn add(&mut self, name: String, robot: &Robot) {
        let place = self.names.len();
        self.names.push(name);
        self.verdicts.push(robot.verdict);
        self.gaps_nats.push(robot.gap_nats);
        let mut budget = vec![0.0; self.parts.len()];
        for (id, share, _) in &robot.budget {
            if let Some(part) = self.part(id) {
                budget[part] = *share as f32;
            }
        }
        self.budgets.push(budget);
        for (sightings, id) in self.sightings.iter_mut().zip(&self.parts) {
            sightings.testable += usize::from(robot.untestable.iter().all(|untestable| untestable != id));
        }
        for cause in &robot.effects {
            let Some(part) = self.part(&cause.id) else { continue };
            let strength = cause.strength.as_ref().and_then(|(variant, parameters)| {
                let variant = self.catalogue.get(part)?.variants.iter().find(|known| known.id == variant)?;
                let values = variant.parameters.iter().map(|parameter| parameters.get(parameter.name).copied());
                Some((variant.id, values.collect::<Option<Vec<f64>>>()?))
            });
            let sightings = &mut self.sightings[part];
            sightings.named += 1;
            sightings.expected += cause.probability;
            if let Some((variant, values)) = strength {
                sightings.strengths.entry(variant).or_default().push((place, values));
            }
        }
    }

    /// With a robot that could not be diagnosed.
    pub fn refuse(&mut self, robot: String, reason: String) {
        self.refused.push(Refused { robot, reason });
    }

    fn part(&self, id: &str) -> Option<usize> {
        self.parts.iter().position(|part| *part == id)
    }
}

impl Sightings {
    /// The form in which it was seen in most robots.
    pub fn main_form(&self) -> Option<(&'static str, &Seen)> {
        let most = self.strengths.iter().max_by_key(|(variant, seen)| (seen.len(), std::cmp::Reverse(**variant)));
        most.map(|(variant, seen)| (*variant, seen))
    }
}
