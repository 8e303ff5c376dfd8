//! What a controller is evolved for, and how good one is at it.

use glam::DVec2;
use mindgap_core::controller::Controller;
use serde::{Deserialize, Serialize};

use super::fitness::{FitnessEvaluator, RandomNumbers, Success};
use super::genome::GenotypeDecoder;
use super::way::WayMap;
use mindgap_models::simulator::environment::Environment;
use mindgap_models::simulator::rollout::REACHED_CM;

/// Runs whose fitness is summed.
pub const RUNS: usize = 20;
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

/// A controller, and what it did in fresh runs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Judged {
    /// The controller.
    pub controller: Controller,
    /// Share of the runs that reached the target.
    pub success: f64,
    /// Its fitness, as of [`RUNS`] runs.
    pub fitness: f64,
}

impl<'a> EvolutionTask<'a> {
    /// Success of a controller in a number of runs that played no part in its evolution.
    pub fn success(&self, controller: &Controller, runs: usize) -> Success {
        self.evaluator().success(controller, runs, JUDGING)
    }

    /// A controller with what it does in so many runs that are there to choose by.
    pub fn judged(&self, controller: Controller, runs: usize) -> Judged {
        let evaluator = self.evaluator();
        let outcomes = evaluator.outcomes(&controller, runs, CHOOSING);
        let fitness = evaluator.fitness_of(&outcomes) * RUNS as f64 / runs as f64;
        Judged { controller, success: evaluator.success_of(&outcomes).rate, fitness }
    }

    /// What individuals are evaluated with: all controllers are compared on the same runs.
    pub fn evaluator(&self) -> FitnessEvaluator<'a> {
        FitnessEvaluator {
            environment: self.environment,
            target_cm: self.target_cm,
            way: Some(self.way),
            decoder: self.decoder,
            runs: RUNS,
            // Within the target radius nearer is no better: the success rate counts.
            floor_cm: REACHED_CM,
            random_numbers: self.random_numbers,
            seed: self.seed,
        }
    }
}

/// By falling success rate, ties broken by fitness.
pub fn sort(judged: &mut [Judged]) {
    judged.sort_by(|a, b| b.success.total_cmp(&a.success).then(b.fitness.total_cmp(&a.fitness)));
}
