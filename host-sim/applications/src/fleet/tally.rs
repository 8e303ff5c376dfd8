//! Running statistics over the robots: sums, and for each robot its name, gap, budget and effect strengths, in a few
//! hundred bytes.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Serialize;

use super::robot::Robot;
use mindgap_diagnosis::budget::{SCATTER, UNEXPLAINED};
use mindgap_diagnosis::verdict::Verdict;
use mindgap_models::effects::Effect;

/// Running statistics of a fleet.
pub struct Tally {
    /// Effects that competed.
    pub catalogue: &'static [&'static Effect],
    /// Parts of the budget: the effects in the order of the catalogue, scatter, unexplained.
    pub parts: Vec<&'static str>,
    /// The dimensions of the first robot.
    pub measures: Option<mindgap_logs::Robot>,
    /// Names of the diagnosed robots; the following fields have the same order.
    pub names: Vec<String>,
    /// Verdicts.
    pub verdicts: Vec<Verdict>,
    /// Gaps, nats per step.
    pub gaps_nats: Vec<Option<f64>>,
    /// Budgets: shares of the gap by part; all zero if there is no gap.
    pub budgets: Vec<Vec<f32>>,
    /// Counts of each part.
    pub sightings: Vec<Sightings>,
    /// Robots that could not be diagnosed.
    pub refused: Vec<Refused>,
}

/// Counts and strengths of a part of the budget.
#[derive(Clone, Default)]
pub struct Sightings {
    /// Number of robots in whose logs it is testable.
    pub testable: usize,
    /// Number of robots in which it is named.
    pub named: usize,
    /// The same, each weighted by its probability.
    pub expected: f64,
    /// Robots by variant of the effect.
    pub strengths: BTreeMap<&'static str, Seen>,
}

/// Robots with a variant of an effect, as indices into [`Tally::names`], each with the values of its parameters in order.
pub type Seen = Vec<(usize, Vec<f64>)>;

/// A robot that could not be diagnosed.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Refused {
    /// Its name.
    pub robot: String,
    /// Reason.
    pub reason: String,
}

impl Tally {
    /// Returns an empty tally.
    pub fn new(catalogue: &'static [&'static Effect]) -> Self {
        let parts: Vec<&'static str> = catalogue.iter().map(|effect| effect.id).chain([SCATTER, UNEXPLAINED]).collect();
        Tally {
            catalogue,
            sightings: vec![Sightings::default(); parts.len()],
            parts,
            measures: None,
            names: Vec::new(),
            verdicts: Vec::new(),
            gaps_nats: Vec::new(),
            budgets: Vec::new(),
            refused: Vec::new(),
        }
    }

    /// Adds a diagnosed robot.
    pub fn add(&mut self, name: String, robot: &Robot) {
        let place = self.names.len();
        self.names.push(name);
        self.measures.get_or_insert(robot.measures);
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
                Some((variant.id, variant.values(parameters, &robot.measures)?))
            });
            let sightings = &mut self.sightings[part];
            sightings.named += 1;
            sightings.expected += cause.probability;
            if let Some((variant, values)) = strength {
                sightings.strengths.entry(variant).or_default().push((place, values));
            }
        }
    }

    /// Adds a robot that could not be diagnosed.
    pub fn refuse(&mut self, robot: String, reason: String) {
        self.refused.push(Refused { robot, reason });
    }

    fn part(&self, id: &str) -> Option<usize> {
        self.parts.iter().position(|part| *part == id)
    }
}

impl Sightings {
    /// Returns the most common variant with its robots.
    pub fn main_form(&self) -> Option<(&'static str, &Seen)> {
        let most = self.strengths.iter().max_by_key(|(variant, seen)| (seen.len(), std::cmp::Reverse(**variant)));
        most.map(|(variant, seen)| (*variant, seen))
    }
}
