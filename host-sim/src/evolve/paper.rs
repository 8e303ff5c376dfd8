//! The paper's exact procedure (section IX): one run of the genetic algorithm for 1000 generations, and its fittest
//! individual is the controller.

use mindgap_core::controller::Controller;

use super::fitness::FitnessEvaluator;
use crate::genetic::{self, Settings};

/// An evolved controller.
#[derive(Clone, Debug, PartialEq)]
pub struct Evolved {
    /// The controller.
    pub controller: Controller,
    /// Its fitness when it was chosen: equation (3) summed over the task's runs.
    pub fitness: f64,
    /// Generations that were run in all.
    pub generations: usize,
}

/// The paper's genetic algorithm as section IX uses it: that of section VII, ended after 1000 generations.
pub fn settings() -> Settings {
    Settings { stagnation: None, max_generations: 1000, ..Settings::default() }
}

/// Runs whose fitness is summed, since echoes fail at random.
pub const RUNS: usize = 5;
/// Distances below this count as this (the paper is silent; 1/d has no ceiling).
pub const FLOOR_CM: f64 = 1.0;

/// Evolves a controller as the paper does.
pub fn evolve(evaluator: &FitnessEvaluator, settings: &Settings, watch: impl FnMut(usize, f64)) -> Evolved {
    let outcome = genetic::run(settings, evaluator, evaluator.seed, watch);
    let controller = evaluator.decoder.controller(&outcome.best);
    Evolved { controller, fitness: outcome.fitness, generations: outcome.generations }
}
