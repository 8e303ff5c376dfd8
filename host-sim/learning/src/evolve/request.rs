//! A request for a controller: the evolution of one for a start of a scene, and the success of the most promising one found.

use mindgap_core::controller::Controller;

use super::fitness::{FitnessEvaluator, RandomNumbers, Success};
use super::genome::GenotypeDecoder;
use super::paper::{self, Evolved};
use super::robust;
use super::route::RouteMap;
use super::success_probability::{Judge, ROBOTS, RUNS, SuccessProbability};
use super::task::EvolutionTask;
use mindgap_foundations::error::{Error, Result};
use mindgap_foundations::executor::Executor;
use mindgap_logs::Scene;
use mindgap_models::simulator::environment::{Environment, SensorModel};
use mindgap_models::simulator::rollout_report::RolloutReport;
use mindgap_models::simulator::{Noise, Simulator};

/// A request to evolve a controller.
pub struct Request<'a> {
    /// Executes independent pieces of the search.
    pub executor: &'a dyn Executor,
    /// The simulator in which the controller is evolved.
    pub simulator: &'a Simulator,
    /// The scene, which has a target.
    pub scene: &'a Scene,
    /// Start within the scene, from 1.
    pub start: usize,
    /// Maximum number of steps of a run.
    pub max_steps: u16,
    /// Whether to use the procedure of the paper: one run of the genetic algorithm, and its fittest individual.
    pub paper: bool,
    /// The noise of the simulated robot.
    pub noise: Noise,
    /// The model of the sensor, unless the noise is that of the paper.
    pub sensor: SensorModel,
    /// Seed of all draws.
    pub seed: u64,
}

/// The result of a [`Request`].
pub struct Answered {
    /// The controller.
    pub evolved: Evolved,
    /// Its success in [`JUDGED_RUNS`] fresh runs.
    pub success: Success,
    /// Its probability of success over the posterior of robots, if the simulator has one.
    pub chance: Option<SuccessProbability>,
    /// A few runs, for figures.
    pub rollouts: RolloutReport,
}

/// Number of fresh runs that measure the success of a controller.
pub const JUDGED_RUNS: usize = 200;
/// Stream key of these runs.
const JUDGING: u64 = 1;
/// Number of runs for figures.
const DRAWN_RUNS: usize = 10;

impl Request<'_> {
    /// Returns the maximum number of generations.
    pub fn generations(&self) -> usize {
        if self.paper { paper::settings().max_generations } else { robust::GENERATIONS }
    }

    /// Evolves a controller; `watch` receives the generation and the best fitness.
    ///
    /// # Errors
    /// If the scene lacks a target or the start, if `max_steps` is 0, or if the simulator cannot run controllers in the
    /// scene.
    pub fn evolve(&self, watch: impl FnMut(usize, f64)) -> Result<Answered> {
        let Request { executor, simulator, scene, noise, seed, .. } = *self;
        if self.max_steps == 0 {
            return Err(Error::new("a controller needs at least one step"));
        }
        let start = scene.start(self.start, simulator.robot.body_radius_cm)?;
        let target_cm = scene.target_cm.ok_or_else(|| Error::new("has no [target]"))?;
        let environment = Environment::new(simulator, scene, start, noise)?;
        let robots = if noise == Noise::Learned { simulator.robots(ROBOTS, seed) } else { None };
        let environment = &environment.sensing_by(self.sensor, simulator, scene)?.at_posterior_mean(robots.as_ref());
        let decoder = GenotypeDecoder::new(simulator, self.max_steps);
        let (runs, floor_cm) = (paper::RUNS, paper::FLOOR_CM);
        let routes = &RouteMap::new(scene, target_cm, simulator.robot.body_radius_cm);
        let random_numbers = RandomNumbers::Independent;
        let evaluator =
            FitnessEvaluator { environment, target_cm, routes: None, decoder, runs, floor_cm, random_numbers, seed };
        let candidates = if self.paper {
            vec![paper::evolve(executor, &evaluator, &paper::settings(), watch)?]
        } else {
            robust::candidates(&EvolutionTask { executor, environment, target_cm, routes, decoder, seed }, watch)?
        };
        let probabilities = match &robots {
            Some(robots) => {
                let controllers: Vec<Controller> = candidates.iter().map(|c| c.controller.clone()).collect();
                let judge = Judge::new(executor, simulator, &robots.drawn, scene, start, target_cm, seed)?;
                judge.success_probabilities(&controllers, RUNS)?
            }
            None => Vec::new(),
        };
        let (evolved, chance) = most_likely(candidates, &probabilities);
        let success = evaluator.success(&evolved.controller, JUDGED_RUNS, JUDGING);
        let rollouts = RolloutReport::new(environment, scene, &evolved.controller, DRAWN_RUNS, seed);
        Ok(Answered { evolved, success, chance, rollouts })
    }
}

/// Returns the controller with the largest probability of success, or the first if `probabilities` is empty.
fn most_likely(
    mut candidates: Vec<Evolved>,
    probabilities: &[SuccessProbability],
) -> (Evolved, Option<SuccessProbability>) {
    let better = |a: &usize, b: &usize| probabilities[*a].success.total_cmp(&probabilities[*b].success).then(b.cmp(a));
    for (number, (candidate, chance)) in candidates.iter().zip(probabilities).enumerate() {
        log::info!(
            "controller {} of the search: fitness {:.3}, probability of success {chance}",
            number + 1,
            candidate.fitness
        );
    }
    let best = (0..probabilities.len()).max_by(better);
    (candidates.swap_remove(best.unwrap_or(0)), best.map(|best| probabilities[best]))
}
