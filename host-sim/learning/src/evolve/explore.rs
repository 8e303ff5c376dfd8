//! Exploration by prefixes of controllers. An archive holds for each cell of poses the first tuples that lead there with the
//! least scatter (MAP-Elites; Mouret and Clune 2015). The search returns to such a pose and tries commands from there
//! (Go-Explore; Ecoffet et al. 2021). Every threshold of a command is tried at once.
//!
//! A genetic algorithm on whole controllers has to find six tuples that work together. This search instead appends a tuple
//! to a prefix that already leads somewhere, and prefixes whose scatter the sensor reduces win their cells.

use std::collections::BTreeMap;
use std::f64::consts::TAU;

use mindgap_core::controller::{Controller, TUPLES, Tuple};
use rand::RngExt;
use rand_distr::{Distribution, StandardNormal};

use super::genome::GenotypeDecoder;
use super::stops::{self, Stop};
use super::task::{EvolutionTask, Judged, NEARNESS, sort};
use crate::genetic::mutation::{Mutation, Unit};
use mindgap_foundations::error::Result;
use mindgap_foundations::executor;
use mindgap_foundations::random::{Generator, derive, generator};
use mindgap_models::simulator::rollout::REACHED_CM;

/// Number of rounds of all searches.
pub const ALL_ROUNDS: usize = SEARCHES * ROUNDS;

/// Number of independent searches, each with its own archive.
const SEARCHES: usize = 4;
/// Number of rounds of a search.
const ROUNDS: usize = 200;
/// Number of prefixes tried per round.
const TRIED: usize = 256;
/// Number of runs per prefix.
const RUNS: usize = 8;
/// Width of a cell, cm: the radius of a target.
const CELL_CM: f64 = REACHED_CM;
/// Number of sectors of the heading.
const SECTORS: f64 = 12.0;
/// Scatter in position that a radian of scatter in heading counts as, cm: its effect over the usual length of a tuple.
const TUPLE_CM: f64 = 50.0;
/// Scatter that the loss of all runs counts as, cm.
const LOST_CM: f64 = 60.0;
/// Largest share of lost runs of a prefix that is extended.
const MOST_LOST: f64 = 0.4;
/// Number of best candidates, which are mutated during the search and returned at its end.
const BEST: usize = 100;
/// Shares of the prefixes tried that are mutants of candidates and of elites; the others are extensions.
const CANDIDATES: f64 = 0.3;
const ELITES: f64 = 0.2;
const MUTATION: Mutation = Mutation { probability: 0.3, unit: Unit::Gene, deviation: 0.08 };
/// Shares of the appended tuples that drive nearly straight and that turn nearly on the spot: most random commands drive
/// small circles.
const STRAIGHT: f64 = 0.2;
const ON_THE_SPOT: f64 = 0.2;
/// Standard deviation of their commands from exactly straight or on the spot, in units of a gene.
const NEARLY: f32 = 0.03;
/// Number of fresh runs that score a candidate.
const SCORING_RUNS: usize = 60;

/// A cell of poses: number of tuples, cell along x and y, and sector of the heading.
type Cell = (usize, i32, i32, i32);

/// The first tuples of a controller.
#[derive(Clone)]
struct Prefix {
    tuples: Vec<Tuple>,
    /// The cell in which the last of them begins.
    from: Cell,
}

/// The prefix that leads to a cell with the least scatter.
struct Elite {
    prefix: Prefix,
    cell: Cell,
    scatter_cm: f64,
    /// Number of times it was extended.
    tries: u32,
}

/// The best prefix whose last tuple begins in a given cell.
struct Candidate {
    prefix: Prefix,
    score: f64,
}

/// One search.
struct Archive<'a> {
    task: &'a EvolutionTask<'a>,
    elites: Vec<Elite>,
    /// Index of the elite of each cell.
    places: BTreeMap<Cell, usize>,
    candidates: BTreeMap<Cell, Candidate>,
}

/// Returns controllers by descending success rate in fresh runs. `watch` receives the last round completed, of
/// [`ALL_ROUNDS`], and the fitness of the best controller of its search.
///
/// # Errors
/// If the executor fails.
pub fn explore(task: &EvolutionTask, mut watch: impl FnMut(usize, f64)) -> Result<Vec<Controller>> {
    let search = |number: usize| Ok(Archive::new(task).searched(derive(task.seed, &[number as u64])));
    let report = |number: usize, found: &Vec<Judged>| {
        let fitness = found.iter().map(|judged| judged.fitness);
        watch((number + 1) * ROUNDS - 1, fitness.fold(f64::NAN, f64::max));
    };
    let mut found = executor::map_watched(task.executor, SEARCHES, search, report)?.concat();
    sort(&mut found);
    Ok(found.into_iter().map(|judged| judged.controller).collect())
}

impl<'a> Archive<'a> {
    fn new(task: &'a EvolutionTask<'a>) -> Self {
        let cell = Cell::default();
        let prefix = Prefix { tuples: Vec::new(), from: cell };
        let start = Elite { prefix, cell, scatter_cm: 0.0, tries: 0 };
        Archive { task, elites: vec![start], places: BTreeMap::from([(cell, 0)]), candidates: BTreeMap::new() }
    }

    /// Runs all rounds and returns the best controllers.
    fn searched(mut self, seed: u64) -> Vec<Judged> {
        for round in 0..ROUNDS as u64 {
            let tried = self.prefixes(&mut generator(seed, &[round]));
            let tuples: Vec<&[Tuple]> = tried.iter().map(|prefix| prefix.tuples.as_slice()).collect();
            let stops = stops::stops(self.task, &tuples, RUNS, derive(seed, &[round, 1]));
            for (prefix, stops) in tried.iter().zip(stops) {
                stops.iter().for_each(|stop| self.learn(prefix, stop));
            }
        }
        let judged =
            |candidate: Prefix| self.task.judged(stops::controller(self.task, &candidate.tuples), SCORING_RUNS);
        self.best_candidates().into_iter().map(judged).collect()
    }

    /// Returns the best candidates.
    fn best_candidates(&self) -> Vec<Prefix> {
        let mut all: Vec<&Candidate> = self.candidates.values().collect();
        all.sort_by(|a, b| b.score.total_cmp(&a.score));
        all.into_iter().take(BEST).map(|candidate| candidate.prefix.clone()).collect()
    }

    /// Returns the prefixes that a round tries.
    fn prefixes(&mut self, rng: &mut Generator) -> Vec<Prefix> {
        let best_candidates = self.best_candidates();
        let mut one = || {
            let kind: f64 = rng.random();
            if kind < CANDIDATES && !best_candidates.is_empty() {
                self.mutant(&best_candidates[rng.random_range(0..best_candidates.len())], rng)
            } else if kind < CANDIDATES + ELITES && self.elites.len() > 1 {
                self.mutant(&self.elites[rng.random_range(1..self.elites.len())].prefix, rng)
            } else {
                self.extended(rng)
            }
        };
        (0..TRIED).map(|_| one()).collect()
    }

    /// Extends the less tried of two random elites by a random tuple.
    fn extended(&mut self, rng: &mut Generator) -> Prefix {
        let picked = [0; 2].map(|_| rng.random_range(0..self.elites.len()));
        let least = picked.into_iter().min_by_key(|place| self.elites[*place].tries).unwrap_or(0);
        let elite = &mut self.elites[least];
        elite.tries += 1;
        let tuples = elite.prefix.tuples.iter().copied().chain([random_tuple(&self.task.decoder, rng)]).collect();
        Prefix { tuples, from: elite.cell }
    }

    fn mutant(&self, of: &Prefix, rng: &mut Generator) -> Prefix {
        let decoder = &self.task.decoder;
        let mut genes = decoder.genes(&stops::controller(self.task, &of.tuples));
        MUTATION.apply(&mut genes, rng);
        decoder.repair(&mut genes);
        Prefix { tuples: decoder.controller(&genes).tuples[..of.tuples.len()].to_vec(), from: of.from }
    }

    /// Adds a prefix that leads to `stop` to the archive if it is better than the known one.
    fn learn(&mut self, prefix: &Prefix, stop: &Stop) {
        let length = prefix.tuples.len();
        let found = || {
            let before = &prefix.tuples[..length - 1];
            Prefix { tuples: before.iter().copied().chain([stop.tuple]).collect(), ..*prefix }
        };
        let score = stop.reached + NEARNESS * stop.nearness;
        if self.candidates.get(&prefix.from).is_none_or(|known| score > known.score) {
            self.candidates.insert(prefix.from, Candidate { prefix: found(), score });
        }
        if length == TUPLES || stop.lost > MOST_LOST {
            return;
        }
        let [x, y] = (stop.place_cm / CELL_CM).floor().as_ivec2().to_array();
        let sector = ((stop.heading_rad / TAU).rem_euclid(1.0) * SECTORS).floor() as i32;
        let cell = (length, x, y, sector);
        let scatter_cm = stop.scatter_cm + TUPLE_CM * stop.heading_scatter_rad + LOST_CM * stop.lost;
        let elite = || Elite { prefix: found(), cell, scatter_cm, tries: 0 };
        match self.places.get(&cell).map(|place| &mut self.elites[*place]) {
            Some(known) if known.scatter_cm <= scatter_cm => {}
            Some(known) => *known = elite(),
            None => {
                self.places.insert(cell, self.elites.len());
                self.elites.push(elite());
            }
        }
    }
}

fn random_tuple(decoder: &GenotypeDecoder, rng: &mut Generator) -> Tuple {
    let mut genes = decoder.random(rng);
    let (kind, off): (f64, f32) = (rng.random(), StandardNormal.sample(rng));
    if kind < STRAIGHT {
        genes[1] = genes[0] + NEARLY * off;
    } else if kind < STRAIGHT + ON_THE_SPOT {
        genes[1] = 1.0 - genes[0] + NEARLY * off;
    }
    decoder.repair(&mut genes);
    decoder.controller(&genes).tuples[0]
}

#[cfg(test)]
mod tests;
