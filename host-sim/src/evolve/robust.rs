//! Evolution that does not stick, the default. A single run of the paper's procedure often ends in a poor controller,
//! or in one that was lucky in its five runs. So here, always under the noise that was learned, and with either of two
//! sensors by turns, since what helps with one alone will hardly help on the floor:
//!
//! 1. a large population, gentler in selection and bolder in mutation, with few runs an individual: it finds a way. Its
//!    elite is judged again in each generation;
//! 2. a run that goes on from the best of it with small mutations and many runs an individual;
//! 3. a choice among the last population by many fresh runs;
//!
//! and all of that several times, for other ways.

use glam::DVec2;
use mindgap_core::controller::Controller;
use rayon::prelude::*;

use super::fitness::{FitnessEvaluator, REACHED_CM, RandomNumbers, Success};
use super::genome::GenotypeDecoder;
use super::paper::Evolved;
use crate::chance::derive;
use crate::genetic::mutation::{Mutation, Unit};
use crate::genetic::{self, Settings};
use crate::simulator::course::Course;

/// Generations of all runs of the genetic algorithm together.
pub const GENERATIONS: usize = RESTARTS * (EXPLORING.max_generations + REFINING.max_generations);
/// So many times all of it is done.
pub const RESTARTS: usize = 3;

const EXPLORING: Settings = Settings {
    population: 1000,
    tournament: 5,
    crossover_chance: 0.8,
    sbx_index: 15.0,
    mutation: Mutation { chance: 0.1, unit: Unit::Gene, deviation: 0.2 },
    elite: 20,
    stagnation: None,
    max_generations: 120,
};
const EXPLORING_RUNS: usize = 4;
const REFINING: Settings = Settings {
    population: 100,
    mutation: Mutation { deviation: 0.05, ..EXPLORING.mutation },
    elite: 5,
    max_generations: 60,
    ..EXPLORING
};
const REFINING_RUNS: usize = 20;
/// So many of the last population come into the final choice, each with so many fresh runs.
const CANDIDATES: usize = 100;
const CHOOSING_RUNS: usize = 200;
/// Set the choosing and the judging runs apart from all others.
const CHOOSING: u64 = 2;
const JUDGING: u64 = 1;

/// What a controller is evolved for.
pub struct EvolutionTask<'a> {
    /// Where it has to do well.
    pub course: &'a Course<'a>,
    /// Where it has to stop, cm.
    pub target_cm: DVec2,
    /// What its genes stand for.
    pub decoder: GenotypeDecoder,
    /// Which random numbers individuals meet.
    pub random_numbers: RandomNumbers,
    /// Fixes every draw.
    pub seed: u64,
}

/// Evolves a controller: of [`candidates`] the first. `watch` is told the generations so far of all [`GENERATIONS`], and
/// the best fitness of the run that is under way.
pub fn evolve(task: &EvolutionTask, watch: impl FnMut(usize, f64)) -> Evolved {
    candidates(task, watch).swap_remove(0)
}

/// A controller of each restart, which are different ways to the target if there are several; that which reaches it most
/// often in fresh runs comes first.
pub fn candidates(task: &EvolutionTask, mut watch: impl FnMut(usize, f64)) -> Vec<Evolved> {
    let mut chosen: Vec<(f64, Evolved)> = (0..RESTARTS)
        .map(|restart| {
            let seed = derive(task.seed, &[restart as u64]);
            let before = restart * (EXPLORING.max_generations + REFINING.max_generations);
            let mut tell = |generation, best| watch(before + generation, best);
            let explored = genetic::run(&EXPLORING, &task.evaluator(EXPLORING_RUNS, seed), seed, &mut tell);
            let ways = explored.population.into_iter().take(REFINING.population).collect();
            let before = before + EXPLORING.max_generations;
            let tell = |generation, best| watch(before + generation, best);
            // All restarts are judged by the same runs.
            let evaluator = task.evaluator(REFINING_RUNS, task.seed);
            choose(&evaluator, &genetic::run_from(ways, &REFINING, &evaluator, seed, tell).population)
        })
        .collect();
    chosen.sort_by(|a, b| b.0.total_cmp(&a.0));
    chosen.into_iter().map(|(_, evolved)| evolved).collect()
}

/// The individual that reaches the target most often in fresh runs, and of equals the fitter; and how often it does.
fn choose(evaluator: &FitnessEvaluator, population: &[Vec<f32>]) -> (f64, Evolved) {
    let judged: Vec<(f64, f64, Controller)> = population
        .par_iter()
        .take(CANDIDATES)
        .map(|genes| {
            let controller = evaluator.decoder.controller(genes);
            let outcomes = evaluator.outcomes(&controller, CHOOSING_RUNS, CHOOSING);
            let (rate, fitness) = (evaluator.success_of(&outcomes).rate, evaluator.fitness_of(&outcomes));
            (rate, fitness * evaluator.runs as f64 / CHOOSING_RUNS as f64, controller)
        })
        .collect();
    let better = |a: &(f64, f64, Controller), b: &(f64, f64, Controller)| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1));
    let (rate, fitness, controller) = judged.into_iter().max_by(better).expect("a population is never empty");
    (rate, Evolved { controller, fitness, generations: GENERATIONS })
}

impl<'a> EvolutionTask<'a> {
    /// How a controller does in so many fresh runs, which played no part in its evolution.
    pub fn success(&self, controller: &Controller, runs: usize) -> Success {
        self.evaluator(REFINING_RUNS, self.seed).success(controller, runs, JUDGING)
    }

    fn evaluator(&self, runs: usize, seed: u64) -> FitnessEvaluator<'a> {
        FitnessEvaluator {
            course: self.course,
            target_cm: self.target_cm,
            decoder: self.decoder,
            runs,
            // Once there, nearer is no better: what counts is to arrive often.
            floor_cm: REACHED_CM,
            random_numbers: self.random_numbers,
            seed,
        }
    }
}
