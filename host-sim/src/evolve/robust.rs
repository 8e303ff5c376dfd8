//! Evolution with restarts, the default. A single run of the paper's procedure often stagnates at a poor controller, or
//! selects one that was lucky in its five runs. Here every run has the learned noise and alternates between two sensor
//! models, since a behaviour that exploits one of them rarely transfers to the robot. Each restart has three stages:
//!
//! 1. exploration: a large population with weak selection, strong mutation and few runs an individual, whose elite is
//!    evaluated anew in each generation;
//! 2. refinement: a run from the best individuals of the first stage, with small mutations and many runs an individual;
//! 3. selection: the individual of the last population that succeeds most often in many fresh runs.

use glam::DVec2;
use mindgap_core::controller::Controller;

use super::fitness::{FitnessEvaluator, RandomNumbers, Success};
use super::genome::GenotypeDecoder;
use super::paper::Evolved;
use super::way::WayMap;
use crate::chance::{derive, generator};
use crate::error::Result;
use crate::genetic::mutation::{Mutation, Unit};
use crate::genetic::{self, Lineage, RunResult, Settings};
use crate::simulator::environment::Environment;
use crate::simulator::rollout::REACHED_CM;
use crate::workers;

/// Total number of generations of all restarts.
pub const GENERATIONS: usize = RESTARTS * (EXPLORING.max_generations + REFINING_GENERATIONS);
/// Those of [`refine`].
pub const REFINING_GENERATIONS: usize = REFINING.max_generations;
/// Number of independent restarts.
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
/// Number of individuals of the last population in the final selection.
const CANDIDATES: usize = 100;
/// Number of fresh runs of each.
const CHOOSING_RUNS: usize = 200;
/// Worth of ending at the target in every run against that of reaching it in all: it tells controllers apart none of which
/// reaches it.
pub const NEARNESS: f64 = 0.1;
/// Stream keys of the runs that select a controller, and of those that measure its success.
const CHOOSING: u64 = 2;
const JUDGING: u64 = 1;

/// The task that a controller is evolved for.
pub struct EvolutionTask<'a> {
    /// Where it runs.
    pub environment: &'a Environment<'a>,
    /// Where it has to stop, cm.
    pub target_cm: DVec2,
    /// The way to there round the obstacles.
    pub way: &'a WayMap,
    /// Decodes genotypes into controllers.
    pub decoder: GenotypeDecoder,
    /// Which random numbers individuals are evaluated with.
    pub random_numbers: RandomNumbers,
    /// Seed of all draws.
    pub seed: u64,
}

/// The controller of each restart, by falling success rate in fresh runs. They may take different routes to the target.
/// `watch` receives the number of generations completed, of [`GENERATIONS`], and the best fitness of them.
///
/// # Errors
/// As [`genetic::run`].
pub fn candidates(task: &EvolutionTask, mut watch: impl FnMut(usize, f64)) -> Result<Vec<Evolved>> {
    let mut watch = |generation, best| watch(RESTARTS * generation, best);
    let seeds: Vec<u64> = (0..RESTARTS).map(|restart| derive(task.seed, &[restart as u64])).collect();
    let evaluators: Vec<FitnessEvaluator> = seeds.iter().map(|seed| task.evaluator(EXPLORING_RUNS, *seed)).collect();
    let lineages = evaluators.iter().zip(&seeds).map(|(evaluator, seed)| Lineage::random(&EXPLORING, evaluator, *seed));
    let explored = genetic::run_beside(&EXPLORING, lineages.collect(), &mut watch)?;
    let best = |explored: RunResult| explored.population.into_iter().take(REFINING.population).collect();
    let begun = explored.into_iter().map(best).zip(seeds).collect();
    let refined = refine(task, begun, |generation, best| watch(EXPLORING.max_generations + generation, best))?;
    let mut chosen: Vec<(f64, Evolved)> = refined.into_iter().map(|mut ranked| ranked.swap_remove(0)).collect();
    chosen.sort_by(|a, b| b.0.total_cmp(&a.0));
    Ok(chosen.into_iter().map(|(_, evolved)| evolved).collect())
}

/// The second and third stage from given populations, side by side: of each its controllers by falling success rate in fresh
/// runs, which comes with each. A population's seed fixes what the genetic algorithm draws.
///
/// # Errors
/// As [`genetic::run`].
pub fn refine(
    task: &EvolutionTask,
    begun: Vec<(Vec<Vec<f32>>, u64)>,
    watch: impl FnMut(usize, f64),
) -> Result<Vec<Vec<(f64, Evolved)>>> {
    // All restarts are compared on the same runs.
    let evaluator = task.evaluator(REFINING_RUNS, task.seed);
    let lineages = begun.into_iter().map(|(population, seed)| Lineage::from(&evaluator, population, seed));
    let refined = genetic::run_beside(&REFINING, lineages.collect(), watch)?;
    refined.into_iter().map(|refined| ranked(&evaluator, &refined.population)).collect()
}

/// A population of a controller and its mutants, to be [refined](refine).
pub fn mutants(task: &EvolutionTask, controller: &Controller, seed: u64) -> Vec<Vec<f32>> {
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

/// Individuals by falling success rate in fresh runs, ties broken by fitness; with that rate.
fn ranked(evaluator: &FitnessEvaluator, population: &[Vec<f32>]) -> Result<Vec<(f64, Evolved)>> {
    let controller = |number: usize| evaluator.decoder.controller(&population[number]);
    let judge = |number: usize| {
        let outcomes = evaluator.outcomes(&controller(number), CHOOSING_RUNS, CHOOSING);
        let fitness = evaluator.fitness_of(&outcomes) * evaluator.runs as f64 / CHOOSING_RUNS as f64;
        Ok((evaluator.success_of(&outcomes).rate, fitness))
    };
    let judged = workers::map(population.len().min(CANDIDATES), judge)?.into_iter().enumerate();
    let evolved = |(number, (rate, fitness)): (usize, (f64, f64))| {
        (rate, Evolved { controller: controller(number), fitness, generations: GENERATIONS })
    };
    let mut ranked: Vec<(f64, Evolved)> = judged.map(evolved).collect();
    ranked.sort_by(|(a, x), (b, y)| b.total_cmp(a).then(y.fitness.total_cmp(&x.fitness)));
    Ok(ranked)
}

impl<'a> EvolutionTask<'a> {
    /// Success of a controller in a number of runs that played no part in its evolution.
    pub fn success(&self, controller: &Controller, runs: usize) -> Success {
        self.evaluator(REFINING_RUNS, self.seed).success(controller, runs, JUDGING)
    }

    fn evaluator(&self, runs: usize, seed: u64) -> FitnessEvaluator<'a> {
        FitnessEvaluator {
            environment: self.environment,
            target_cm: self.target_cm,
            way: Some(self.way),
            decoder: self.decoder,
            runs,
            // Within the target radius nearer is no better: the success rate counts.
            floor_cm: REACHED_CM,
            random_numbers: self.random_numbers,
            seed,
        }
    }
}
