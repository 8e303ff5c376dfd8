//! An evolution as it is asked for: one controller for a start of a scene, the likeliest of those found, and how good it is.

use mindgap_core::controller::Controller;

use super::chance::{Chance, Judge, ROBOTS, RUNS};
use super::fitness::{FitnessEvaluator, RandomNumbers, Success};
use super::genome::GenotypeDecoder;
use super::paper::{self, Evolved};
use super::robust;
use super::task::EvolutionTask;
use super::way::WayMap;
use mindgap_foundations::error::{Error, Result};
use mindgap_foundations::executor::Executor;
use mindgap_logs::Scene;
use mindgap_models::simulator::environment::{Environment, SensorModel};
use mindgap_models::simulator::rollout_report::RolloutReport;
use mindgap_models::simulator::{Noise, Simulator};

/// What is asked.
pub struct Request<'a> {
    /// Executes independent pieces of the search.
    pub executor: &'a dyn Executor,
    /// Where the controller is evolved.
    pub simulator: &'a Simulator,
    /// The scene, which has a target.
    pub scene: &'a Scene,
    /// Start within the scene, from 1.
    pub start: usize,
    /// Steps after which a controller gives up.
    pub max_steps: u16,
    /// One run of the genetic algorithm and its fittest individual, as in the paper.
    pub paper: bool,
    /// What scatters.
    pub noise: Noise,
    /// What makes the readings, where more scatters than in the paper.
    pub sensor: SensorModel,
    /// Seed of all draws.
    pub seed: u64,
}

/// What was found.
pub struct Answered {
    /// The controller.
    pub evolved: Evolved,
    /// How it did in [`JUDGED_RUNS`] fresh runs.
    pub success: Success,
    /// Its chance over robots that the logs leave possible, where the simulator knows of them.
    pub chance: Option<Chance>,
    /// A few runs, to be drawn.
    pub rollouts: RolloutReport,
}

/// Fresh runs that tell how well a controller does.
pub const JUDGED_RUNS: usize = 200;
/// Sets the judging runs apart from all others.
const JUDGING: u64 = 1;
/// Runs that are drawn.
const DRAWN_RUNS: usize = 10;

impl Request<'_> {
    /// Generations that it takes at most.
    pub fn generations(&self) -> usize {
        if self.paper { paper::settings().max_generations } else { robust::GENERATIONS }
    }

    /// Evolves it; `watch` receives the generation and the best fitness.
    ///
    /// # Errors
    /// When the scene has no target or not this start, when there are no steps, or when the simulator cannot run controllers there.
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
        let way = &WayMap::new(scene, target_cm, simulator.robot.body_radius_cm);
        let random_numbers = RandomNumbers::Independent;
        let evaluator =
            FitnessEvaluator { environment, target_cm, way: None, decoder, runs, floor_cm, random_numbers, seed };
        let candidates = if self.paper {
            vec![paper::evolve(executor, &evaluator, &paper::settings(), watch)?]
        } else {
            robust::candidates(&EvolutionTask { executor, environment, target_cm, way, decoder, seed }, watch)?
        };
        let chances = match &robots {
            Some(robots) => {
                let controllers: Vec<Controller> = candidates.iter().map(|c| c.controller.clone()).collect();
                let judge = Judge::new(executor, simulator, &robots.drawn, scene, start, target_cm, seed)?;
                judge.chances(&controllers, RUNS)?
            }
            None => Vec::new(),
        };
        let (evolved, chance) = most_likely(candidates, &chances);
        let success = evaluator.success(&evolved.controller, JUDGED_RUNS, JUDGING);
        let rollouts = RolloutReport::new(environment, scene, &evolved.controller, DRAWN_RUNS, seed);
        Ok(Answered { evolved, success, chance, rollouts })
    }
}

/// The controller with the best chance, as far as chances are known; else the first.
fn most_likely(mut candidates: Vec<Evolved>, chances: &[Chance]) -> (Evolved, Option<Chance>) {
    let better = |a: &usize, b: &usize| chances[*a].success.total_cmp(&chances[*b].success).then(b.cmp(a));
    for (number, (candidate, chance)) in candidates.iter().zip(chances).enumerate() {
        log::info!("controller {} of the search: fitness {:.3}, chance {chance}", number + 1, candidate.fitness);
    }
    let best = (0..chances.len()).max_by(better);
    (candidates.swap_remove(best.unwrap_or(0)), best.map(|best| chances[best]))
}
