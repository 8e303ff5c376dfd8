//! The task that a controller is evolved for, and how well a controller does it.

use glam::DVec2;
use mindgap_core::controller::Controller;
use serde::{Deserialize, Serialize};

use super::fitness::{FitnessEvaluator, RandomNumbers, Success};
use super::genome::GenotypeDecoder;
use super::route::RouteMap;
use mindgap_foundations::executor::Executor;
use mindgap_models::simulator::environment::Environment;
use mindgap_models::simulator::rollout::REACHED_CM;

/// Number of runs whose fitness is summed.
pub const RUNS: usize = 20;
/// Weight of the nearness of a stop to the target relative to the success rate: it ranks controllers none of which
/// reaches the target.
pub const NEARNESS: f64 = 0.1;
/// Stream keys of the runs that select a controller, and of those that measure its success.
const CHOOSING: u64 = 2;
const JUDGING: u64 = 1;

/// The task that a controller is evolved for.
pub struct EvolutionTask<'a> {
    /// Executes independent pieces of the search.
    pub executor: &'a dyn Executor,
    /// The environment in which it runs.
    pub environment: &'a Environment<'a>,
    /// The target at which it has to stop, cm.
    pub target_cm: DVec2,
    /// Routes to the target around the obstacles.
    pub routes: &'a RouteMap,
    /// Decodes genotypes into controllers.
    pub decoder: GenotypeDecoder,
    /// Seed of all draws.
    pub seed: u64,
}

/// A controller and its score in fresh runs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Judged {
    /// The controller.
    pub controller: Controller,
    /// Share of the runs that reached the target, 0..=1.
    pub success: f64,
    /// Its fitness, scaled to [`RUNS`] runs.
    pub fitness: f64,
}

impl<'a> EvolutionTask<'a> {
    /// Returns the success of a controller in `runs` runs that played no part in its evolution.
    pub fn success(&self, controller: &Controller, runs: usize) -> Success {
        self.evaluator().success(controller, runs, JUDGING)
    }

    /// Scores a controller in `runs` runs that serve to select among controllers.
    pub fn judged(&self, controller: Controller, runs: usize) -> Judged {
        let evaluator = self.evaluator();
        let outcomes = evaluator.outcomes(&controller, runs, CHOOSING);
        let fitness = evaluator.fitness_of(&outcomes) * RUNS as f64 / runs as f64;
        Judged { controller, success: evaluator.success_of(&outcomes).rate, fitness }
    }

    /// Returns the evaluator of individuals, which compares all controllers on the same runs.
    pub fn evaluator(&self) -> FitnessEvaluator<'a> {
        FitnessEvaluator {
            environment: self.environment,
            target_cm: self.target_cm,
            routes: Some(self.routes),
            decoder: self.decoder,
            runs: RUNS,
            // Within the target radius, nearer is not better: the success rate counts.
            floor_cm: REACHED_CM,
            random_numbers: RandomNumbers::Common,
            seed: self.seed,
        }
    }
}

/// Sorts by descending success rate, ties by descending fitness.
pub fn sort(judged: &mut [Judged]) {
    judged.sort_by(|a, b| b.success.total_cmp(&a.success).then(b.fitness.total_cmp(&a.fitness)));
}
