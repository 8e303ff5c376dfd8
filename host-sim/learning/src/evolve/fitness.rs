//! Fitness of a controller, equation (3) of the paper summed over several runs, and its success rate.

use glam::DVec2;
use mindgap_core::controller::Controller;
use schemars::JsonSchema;
use serde::Serialize;

use super::genome::GenotypeDecoder;
use super::route::RouteMap;
use crate::genetic;
use mindgap_foundations::random::{Generator, derive};
use mindgap_logs::Termination;
use mindgap_models::simulator::environment::Environment;
use mindgap_models::simulator::motion::MotionTable;
use mindgap_models::simulator::rollout::{REACHED_CM, RolloutOutcome, RolloutRequest};

/// Which random numbers the individuals of a generation are evaluated with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RandomNumbers {
    /// Each individual has its own.
    Independent,
    /// All individuals share the same ones, new in each generation (common random numbers).
    Common,
}

/// Evaluates the fitness of controllers, as an optimisation problem for the genetic algorithm.
pub struct FitnessEvaluator<'a> {
    /// The environment in which controllers run.
    pub environment: &'a Environment<'a>,
    /// The target at which they have to stop, cm.
    pub target_cm: DVec2,
    /// Routes whose length counts as distance to the target; `None` for the straight line.
    pub routes: Option<&'a RouteMap>,
    /// Decodes genotypes into controllers.
    pub decoder: GenotypeDecoder,
    /// Number of runs whose fitness is summed (paper: five).
    pub runs: usize,
    /// Smaller distances to the target are raised to this one, cm.
    pub floor_cm: f64,
    /// Which random numbers individuals are evaluated with.
    pub random_numbers: RandomNumbers,
    /// Seed of all runs.
    pub seed: u64,
}

/// Success statistics of a number of runs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct Success {
    /// Share of runs that reached the target without a crash, 0..=1.
    #[serde(rename = "success")]
    pub rate: f64,
    /// Share of runs that crashed, 0..=1.
    pub crashed: f64,
    /// Median final distance to the target, cm; NaN, written as null, without runs.
    pub median_cm: f64,
}

/// Returns the fitness of one run that ended `distance_cm` from the target (paper, equation 3), in 1/cm: 0.5 / distance
/// after a crash, else 1 / distance. Distances below `floor_cm` are raised to it, since 1 / distance is unbounded.
pub fn fitness(outcome: &RolloutOutcome, distance_cm: f64, floor_cm: f64) -> f64 {
    let distance_cm = distance_cm.max(floor_cm);
    if outcome.termination == Termination::Crashed { 0.5 / distance_cm } else { 1.0 / distance_cm }
}

impl FitnessEvaluator<'_> {
    /// Returns the outcomes of `runs` runs of a controller; each `purpose` has independent random numbers.
    pub fn outcomes(&self, controller: &Controller, runs: usize, purpose: u64) -> Vec<RolloutOutcome> {
        let motions = &self.environment.motions(controller);
        let seed = |run: usize| derive(self.seed, &[purpose, run as u64]);
        let requests: Vec<RolloutRequest> =
            (0..runs).map(|run| RolloutRequest { controller, motions, seed: seed(run) }).collect();
        self.environment.run(&requests)
    }

    /// Returns the success of a controller in `runs` runs, with the random numbers of [`outcomes`](Self::outcomes).
    pub fn success(&self, controller: &Controller, runs: usize, purpose: u64) -> Success {
        self.success_of(&self.outcomes(controller, runs, purpose))
    }

    /// Returns the success of runs with these outcomes.
    pub fn success_of(&self, outcomes: &[RolloutOutcome]) -> Success {
        Success::of(outcomes, self.target_cm)
    }

    /// Returns the fitness, summed over outcomes.
    pub fn fitness_of(&self, outcomes: &[RolloutOutcome]) -> f64 {
        let distance_cm = |o: &RolloutOutcome| match self.routes {
            Some(routes) => routes.length_cm(o.end_cm),
            None => o.end_cm.distance(self.target_cm),
        };
        outcomes.iter().map(|o| fitness(o, distance_cm(o), self.floor_cm)).sum()
    }
}

impl Success {
    /// Returns the success of runs with these outcomes, for a target in cm.
    pub fn of(outcomes: &[RolloutOutcome], target_cm: DVec2) -> Self {
        let end = |o: &RolloutOutcome| (o.end_cm.distance(target_cm), o.termination == Termination::Crashed);
        Self::of_ends(outcomes.iter().map(end))
    }

    /// Returns the success of runs, each given as its final distance to the target in cm and whether it crashed.
    pub fn of_ends(ends: impl Iterator<Item = (f64, bool)>) -> Self {
        let (mut distances, mut reached, mut crashed) = (Vec::new(), 0, 0);
        for (distance_cm, has_crashed) in ends {
            distances.push(distance_cm);
            crashed += usize::from(has_crashed);
            reached += usize::from(!has_crashed && distance_cm <= REACHED_CM);
        }
        distances.sort_by(f64::total_cmp);
        let share = |count: usize| count as f64 / distances.len() as f64;
        let median_cm = distances.get(distances.len() / 2).copied().unwrap_or(f64::NAN);
        Success { rate: share(reached), crashed: share(crashed), median_cm }
    }
}

impl genetic::Problem for FitnessEvaluator<'_> {
    fn random(&self, rng: &mut Generator) -> Vec<f32> {
        self.decoder.random(rng)
    }

    fn repair(&self, genes: &mut [f32]) {
        self.decoder.repair(genes);
    }

    fn fitness(&self, generation: usize, first: usize, individuals: &[Vec<f32>]) -> Vec<f64> {
        let controllers: Vec<Controller> = individuals.iter().map(|genes| self.decoder.controller(genes)).collect();
        let motions: Vec<MotionTable> = controllers.iter().map(|c| self.environment.motions(c)).collect();
        let mut requests = Vec::with_capacity(individuals.len() * self.runs);
        for (i, (controller, motions)) in controllers.iter().zip(&motions).enumerate() {
            let individual = if self.random_numbers == RandomNumbers::Common { 0 } else { (first + i) as u64 };
            let place = |run: usize| [0, generation as u64, individual, run as u64];
            requests.extend((0..self.runs).map(|run| RolloutRequest {
                controller,
                motions,
                seed: derive(self.seed, &place(run)),
            }));
        }
        let outcomes = self.environment.run(&requests);
        outcomes.chunks(self.runs).map(|runs| self.fitness_of(runs)).collect()
    }
}
