//! Exploration by beginnings of controllers. An archive holds for each cell of poses the first tuples that lead there with
//! the least scatter (MAP-Elites; Mouret and Clune 2015), and the search goes back to such a pose and tries commands from
//! there (Go-Explore; Ecoffet et al. 2021). Of each command every threshold is tried at once.
//!
//! A genetic algorithm on whole controllers has to find six tuples that work together; this one adds a tuple to others that
//! lead somewhere already, and those that a sensor steadies win their cells.

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
use mindgap_foundations::random::{Generator, derive, generator};
use mindgap_models::simulator::rollout::REACHED_CM;
use mindgap_workers as workers;

/// Rounds of all searches.
pub const ALL_ROUNDS: usize = SEARCHES * ROUNDS;

/// Searches side by side, each with its own archive.
const SEARCHES: usize = 4;
const ROUNDS: usize = 200;
/// Beginnings that are tried in a round.
const TRIED: usize = 256;
/// Runs of each.
const RUNS: usize = 8;
/// A cell is as wide as a target's radius.
const CELL_CM: f64 = REACHED_CM;
/// Directions that are told apart.
const SECTORS: f64 = 12.0;
/// A radian is as bad as this way, the usual one of a tuple, makes it.
const TUPLE_CM: f64 = 50.0;
/// What it is worth that no run is lost, cm of scatter.
const LOST_CM: f64 = 60.0;
/// So many runs may be lost of those that something is added to.
const MOST_LOST: f64 = 0.4;
/// Candidates of which mutants are tried, and that are left at the end.
const FOREMOST: usize = 100;
/// Shares of what is tried: mutants of candidates, and of elites; the rest is tuples that are added.
const CANDIDATES: f64 = 0.3;
const ELITES: f64 = 0.2;
const MUTATION: Mutation = Mutation { chance: 0.3, unit: Unit::Gene, deviation: 0.08 };
/// Of the tuples that are added so many drive nearly straight, and so many turn nearly on the spot: of random commands most
/// drive small circles.
const STRAIGHT: f64 = 0.2;
const ON_THE_SPOT: f64 = 0.2;
/// How nearly, in units of a gene.
const NEARLY: f32 = 0.03;
/// Fresh runs that tell how good a candidate is.
const JUDGED_RUNS: usize = 60;

/// A part of the poses: tuples until there, cell along x and y, and sector of the heading.
type Cell = (usize, i32, i32, i32);

/// First tuples of a controller.
#[derive(Clone)]
struct Beginning {
    tuples: Vec<Tuple>,
    /// The cell where the last of them begins.
    from: Cell,
}

/// Those that lead to a cell with the least scatter.
struct Elite {
    beginning: Beginning,
    cell: Cell,
    scatter_cm: f64,
    /// How often something was added.
    tries: u32,
}

/// The best ones whose last tuple begins in a cell.
struct Candidate {
    beginning: Beginning,
    score: f64,
}

/// One search.
struct Archive<'a> {
    task: &'a EvolutionTask<'a>,
    elites: Vec<Elite>,
    /// Where the elite of a cell is among them.
    places: BTreeMap<Cell, usize>,
    candidates: BTreeMap<Cell, Candidate>,
}

/// Controllers by falling success rate in fresh runs. `watch` receives the last round completed, of [`ALL_ROUNDS`], and the
/// fitness of the best controller of its search.
///
/// # Errors
/// When it cannot be computed by those to whom it is handed out.
pub fn explore(task: &EvolutionTask, mut watch: impl FnMut(usize, f64)) -> Result<Vec<Controller>> {
    let search = |number: usize| Ok(Archive::new(task).searched(derive(task.seed, &[number as u64])));
    let told = |number: usize, found: &Vec<Judged>| {
        let fitness = found.iter().map(|judged| judged.fitness);
        watch((number + 1) * ROUNDS - 1, fitness.fold(f64::NAN, f64::max));
    };
    let mut found = workers::map_watched(SEARCHES, search, told)?.concat();
    sort(&mut found);
    Ok(found.into_iter().map(|judged| judged.controller).collect())
}

impl<'a> Archive<'a> {
    fn new(task: &'a EvolutionTask<'a>) -> Self {
        let cell = Cell::default();
        let beginning = Beginning { tuples: Vec::new(), from: cell };
        let start = Elite { beginning, cell, scatter_cm: 0.0, tries: 0 };
        Archive { task, elites: vec![start], places: BTreeMap::from([(cell, 0)]), candidates: BTreeMap::new() }
    }

    /// Its best controllers after all rounds.
    fn searched(mut self, seed: u64) -> Vec<Judged> {
        for round in 0..ROUNDS as u64 {
            let tried = self.beginnings(&mut generator(seed, &[round]));
            let tuples: Vec<&[Tuple]> = tried.iter().map(|beginning| beginning.tuples.as_slice()).collect();
            let stops = stops::stops(self.task, &tuples, RUNS, derive(seed, &[round, 1]));
            for (beginning, stops) in tried.iter().zip(stops) {
                stops.iter().for_each(|stop| self.learn(beginning, stop));
            }
        }
        let judged =
            |candidate: Beginning| self.task.judged(stops::controller(self.task, &candidate.tuples), JUDGED_RUNS);
        self.foremost().into_iter().map(judged).collect()
    }

    /// The best candidates.
    fn foremost(&self) -> Vec<Beginning> {
        let mut all: Vec<&Candidate> = self.candidates.values().collect();
        all.sort_by(|a, b| b.score.total_cmp(&a.score));
        all.into_iter().take(FOREMOST).map(|candidate| candidate.beginning.clone()).collect()
    }

    /// What a round tries.
    fn beginnings(&mut self, rng: &mut Generator) -> Vec<Beginning> {
        let foremost = self.foremost();
        let mut one = || {
            let kind: f64 = rng.random();
            if kind < CANDIDATES && !foremost.is_empty() {
                self.mutant(&foremost[rng.random_range(0..foremost.len())], rng)
            } else if kind < CANDIDATES + ELITES && self.elites.len() > 1 {
                self.mutant(&self.elites[rng.random_range(1..self.elites.len())].beginning, rng)
            } else {
                self.longer(rng)
            }
        };
        (0..TRIED).map(|_| one()).collect()
    }

    /// A random tuple after the elite of two that was tried less often.
    fn longer(&mut self, rng: &mut Generator) -> Beginning {
        let picked = [0; 2].map(|_| rng.random_range(0..self.elites.len()));
        let least = picked.into_iter().min_by_key(|place| self.elites[*place].tries).unwrap_or(0);
        let elite = &mut self.elites[least];
        elite.tries += 1;
        let tuples = elite.beginning.tuples.iter().copied().chain([random_tuple(&self.task.decoder, rng)]).collect();
        Beginning { tuples, from: elite.cell }
    }

    fn mutant(&self, of: &Beginning, rng: &mut Generator) -> Beginning {
        let decoder = &self.task.decoder;
        let mut genes = decoder.genes(&stops::controller(self.task, &of.tuples));
        MUTATION.apply(&mut genes, rng);
        decoder.repair(&mut genes);
        Beginning { tuples: decoder.controller(&genes).tuples[..of.tuples.len()].to_vec(), from: of.from }
    }

    /// Takes up where a beginning leads, if that is better than what was known.
    fn learn(&mut self, beginning: &Beginning, stop: &Stop) {
        let length = beginning.tuples.len();
        let found = || {
            let before = &beginning.tuples[..length - 1];
            Beginning { tuples: before.iter().copied().chain([stop.tuple]).collect(), ..*beginning }
        };
        let score = stop.reached + NEARNESS * stop.nearness;
        if self.candidates.get(&beginning.from).is_none_or(|known| score > known.score) {
            self.candidates.insert(beginning.from, Candidate { beginning: found(), score });
        }
        if length == TUPLES || stop.lost > MOST_LOST {
            return;
        }
        let [x, y] = (stop.place_cm / CELL_CM).floor().as_ivec2().to_array();
        let sector = ((stop.heading_rad / TAU).rem_euclid(1.0) * SECTORS).floor() as i32;
        let cell = (length, x, y, sector);
        let scatter_cm = stop.scatter_cm + TUPLE_CM * stop.heading_scatter_rad + LOST_CM * stop.lost;
        let elite = || Elite { beginning: found(), cell, scatter_cm, tries: 0 };
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
