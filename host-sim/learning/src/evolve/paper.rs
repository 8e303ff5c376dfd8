//! The procedure of the paper, section IX: one run of the genetic algorithm for 1000 generations, whose fittest individual
//! is the controller.

use mindgap_core::controller::Controller;

use super::fitness::FitnessEvaluator;
use crate::genetic::{self, Settings};
use mindgap_foundations::error::Result;
use mindgap_foundations::executor::Executor;

/// An evolved controller.
#[derive(Clone, Debug, PartialEq)]
pub struct Evolved {
    /// The controller.
    pub controller: Controller,
    /// Fitness when it was selected: equation (3) of the paper, summed over the evaluator's runs.
    pub fitness: f64,
    /// Total number of generations run.
    pub generations: usize,
}

/// Returns the parameters of the paper, section IX: those of section VII, ended after 1000 generations.
pub fn settings() -> Settings {
    Settings { stagnation: None, max_generations: 1000, ..Settings::default() }
}

/// Number of runs whose fitness is summed, since echoes fail at random (paper, section IX).
pub const RUNS: usize = 5;
/// Smaller distances to the target are raised to this one; the paper gives no bound, and 1 / distance has none.
pub const FLOOR_CM: f64 = 1.0;

/// Evolves a controller as in the paper, section IX. `watch` receives the generation and the best fitness up to it.
///
/// # Errors
/// As [`genetic::run`].
pub fn evolve(
    executor: &dyn Executor,
    evaluator: &FitnessEvaluator,
    settings: &Settings,
    watch: impl FnMut(usize, f64),
) -> Result<Evolved> {
    let outcome = genetic::run(executor, settings, evaluator, evaluator.seed, watch)?;
    let controller = evaluator.decoder.controller(&outcome.best);
    Ok(Evolved { controller, fitness: outcome.fitness, generations: outcome.generations })
}
