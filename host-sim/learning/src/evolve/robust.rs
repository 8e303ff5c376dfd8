//! Robust evolution, the default. A single run of the paper's procedure often stagnates at a poor controller, or selects one
//! that was lucky in its five runs. Here every run has the learned noise. There are three stages:
//!
//! 1. exploration: controllers from [prefixes](super::explore) that lead somewhere with little scatter;
//! 2. refinement: the genetic algorithm on mutants of each of the best, with small mutations and many runs per individual;
//! 3. selection: from each last population, the individual that succeeds most often in many fresh runs.

use mindgap_core::controller::Controller;

use super::explore;
use super::paper::Evolved;
use super::task::{EvolutionTask, Judged, sort};
use crate::genetic::mutation::{Mutation, Unit};
use crate::genetic::{self, Lineage, Settings};
use mindgap_foundations::error::Result;
use mindgap_foundations::executor;
use mindgap_foundations::random::{derive, generator};

/// Number of rounds and generations of all stages.
pub const GENERATIONS: usize = explore::ALL_ROUNDS + REFINING_GENERATIONS;
/// Number of generations of [`refine`].
pub const REFINING_GENERATIONS: usize = REFINING.max_generations;
/// Number of explored controllers that are refined.
pub const REFINED: usize = 6;

const REFINING: Settings = Settings {
    population: 100,
    tournament: 5,
    crossover_probability: 0.8,
    sbx_index: 15.0,
    mutation: Mutation { probability: 0.1, unit: Unit::Gene, deviation: 0.05 },
    elite: 5,
    stagnation: None,
    max_generations: 60,
};
/// Number of fresh runs of each individual of a last population.
const CHOOSING_RUNS: usize = 200;
/// Stream key of the draws of the genetic algorithm.
const REFINEMENT: u64 = 3;

/// Returns [`REFINED`] controllers by descending success rate in fresh runs. They may take different routes to the target.
/// `watch` receives the last round or generation completed, of [`GENERATIONS`], and the best fitness in it.
///
/// # Errors
/// As [`genetic::run`].
pub fn candidates(task: &EvolutionTask, mut watch: impl FnMut(usize, f64)) -> Result<Vec<Evolved>> {
    let explored = explore::explore(task, &mut watch)?;
    let explored: Vec<Controller> = explored.into_iter().take(REFINED).collect();
    let refined = refine(task, &explored, |generation, best| watch(explore::ALL_ROUNDS + generation, best))?;
    let mut chosen: Vec<Judged> = refined.into_iter().map(|mut ranked| ranked.swap_remove(0)).collect();
    sort(&mut chosen);
    let evolved = |Judged { controller, fitness, .. }| Evolved { controller, fitness, generations: GENERATIONS };
    Ok(chosen.into_iter().map(evolved).collect())
}

/// Runs the second and third stage from given controllers, side by side. Returns for each controller its last population, by
/// descending success rate in fresh runs. `watch` receives the generation and the best fitness in it.
///
/// # Errors
/// As [`genetic::run`].
pub fn refine(
    task: &EvolutionTask,
    controllers: &[Controller],
    watch: impl FnMut(usize, f64),
) -> Result<Vec<Vec<Judged>>> {
    let evaluator = task.evaluator();
    let lineage = |(controller, number): (&Controller, u64)| {
        let seed = derive(task.seed, &[REFINEMENT, number]);
        Lineage::from(&evaluator, mutants(task, controller, seed), seed)
    };
    let lineages = controllers.iter().zip(0..).map(lineage).collect();
    let refined = genetic::run_side_by_side(task.executor, &REFINING, lineages, watch)?;
    refined.into_iter().map(|refined| ranked(task, &refined.population)).collect()
}

/// Returns a population of a controller and its mutants.
fn mutants(task: &EvolutionTask, controller: &Controller, seed: u64) -> Vec<Vec<f32>> {
    let mut rng = generator(seed, &[]);
    let mutant = |of: usize| {
        let mut genes = task.decoder.genes(controller);
        if of > 0 {
            REFINING.mutation.apply(&mut genes, &mut rng);
            task.decoder.repair(&mut genes);
        }
        genes
    };
    (0..REFINING.population).map(mutant).collect()
}

/// Returns individuals by descending success rate in fresh runs.
fn ranked(task: &EvolutionTask, population: &[Vec<f32>]) -> Result<Vec<Judged>> {
    let judged = |number: usize| Ok(task.judged(task.decoder.controller(&population[number]), CHOOSING_RUNS));
    let mut ranked = executor::map(task.executor, population.len(), judged)?;
    sort(&mut ranked);
    Ok(ranked)
}
