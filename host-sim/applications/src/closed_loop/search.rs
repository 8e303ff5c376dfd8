//! The search of one iteration: controllers from new explorations and from earlier ones that did well, evaluated over the
//! posterior and by real runs.

use glam::DVec2;
use mindgap_core::controller::{Controller, Tuple};

use super::evaluator::{CONFIRMED, Evaluator, Found, Tried};
use super::state::{OracleSuccess, SimulatedPath, place_cm};
use mindgap_foundations::error::{Error, Result};
use mindgap_foundations::executor::Executor;
use mindgap_foundations::geometry::Pose;
use mindgap_foundations::random::derive;
use mindgap_learning::evolve::explore;
use mindgap_learning::evolve::genome::GenotypeDecoder;
use mindgap_learning::evolve::robust::{self, REFINED};
use mindgap_learning::evolve::route::RouteMap;
use mindgap_learning::evolve::success_probability::{Endings, Judge, ROBOTS, RUNS};
use mindgap_learning::evolve::task::{EvolutionTask, Judged};
use mindgap_logs::Scene;
use mindgap_models::simulator::ensemble::Robots;
use mindgap_models::simulator::environment::Environment;
use mindgap_models::simulator::rollout::RolloutRequest;
use mindgap_models::simulator::{Noise, Simulator};

/// Maximum number of generations behind a controller.
pub const GENERATIONS: usize = robust::REFINING_GENERATIONS;
/// Runs per robot for a first ranking of the candidates.
const FEW_RUNS: usize = 3;
/// Number of earlier controllers that a search refines.
const INCUMBENTS: usize = 2;
/// Success probability of the best known controller above which no new exploration is made.
const GOOD: f64 = 0.9;
/// Runs per robot to find the best controller for each robot.
const ORACLE_RUNS: usize = 48;
/// Number of candidates kept by a search.
const SHORTLISTED: usize = 8;
/// Number of candidates kept for the next iteration.
pub const ARCHIVED: usize = 12;
/// Number of robots whose paths are stored with a trial.
const SHOWN: usize = 5;

/// The inputs of a search.
#[derive(Clone, Copy)]
pub struct Search<'a> {
    /// Executor of independent work items.
    pub executor: &'a dyn Executor,
    /// Simulator adapted to all runs so far.
    pub simulator: &'a Simulator,
    /// Scene with a target.
    pub scene: &'a Scene,
    /// Start pose of the controllers.
    pub start: Pose,
    /// Maximum number of steps of a controller.
    pub max_steps: u16,
    /// Random seed.
    pub seed: u64,
}

/// Keys of the random streams.
#[derive(Clone, Copy)]
enum Purpose {
    Robots,
    Judging,
    Searching,
    Showing,
    Comparing,
}

impl Search<'_> {
    /// Re-evaluates the controllers that were driven.
    ///
    /// # Errors
    /// As [`best`](Self::best).
    pub fn judged(&self, tried: &[Tried]) -> Result<Found> {
        let robots = self.robots()?;
        self.evaluator(&robots, tried)?.ranked(Vec::new(), RUNS)
    }

    /// Returns the best controllers among those of earlier iterations, those that were driven, and new ones.
    ///
    /// # Errors
    /// If the simulator lacks a network or the posterior, or the robot does not fit at the start.
    pub fn best(&self, archive: &[Vec<Tuple>], tried: &[Tried]) -> Result<Found> {
        let robots = self.robots()?;
        let evaluator = self.evaluator(&robots, tried)?;
        let known = evaluator.ranked(self.archived(archive), FEW_RUNS)?;
        let found = self.searched(&evaluator.middle, &known)?;
        let all = known.controllers().chain(found).collect();
        let promising = evaluator.ranked(all, FEW_RUNS)?.controllers().take(ARCHIVED).collect();
        evaluator.ranked(promising, RUNS)
    }

    /// Returns how simulated runs of a controller end.
    ///
    /// # Errors
    /// As [`best`](Self::best).
    pub fn endings(&self, controller: &Controller) -> Result<Endings> {
        let robots = self.robots()?;
        self.evaluator(&robots, &[])?.judge.endings(controller, RUNS)
    }

    /// Returns the success probability of the best controller for each robot: an upper limit for what a search can reach.
    ///
    /// # Errors
    /// As [`best`](Self::best).
    pub fn oracle(&self, archive: &[Vec<Tuple>], tried: &[Tried]) -> Result<OracleSuccess> {
        let robots = self.robots()?;
        let success = self.evaluator(&robots, tried)?.oracle(self.archived(archive), ORACLE_RUNS)?;
        Ok(OracleSuccess { success, is_enough: success >= CONFIRMED })
    }

    /// Simulates paths of a controller on some robots of the posterior.
    ///
    /// # Errors
    /// As [`best`](Self::best).
    pub fn paths(&self, controller: &Controller) -> Result<Vec<SimulatedPath>> {
        let Robots { drawn, .. } = self.robots()?;
        let robots = Environment::of_robots(self.simulator, &drawn[..SHOWN], self.scene, self.start)?;
        let run = |(number, robot): (u64, &Environment)| {
            let (outcome, points) = robot.trace(RolloutRequest {
                controller,
                motions: &robot.motions(controller),
                seed: self.stream(Purpose::Showing, number),
            });
            let places = points.iter().map(|point| point.pose.position_cm);
            let path_cm = [self.start.position_cm].into_iter().chain(places).map(place_cm).collect();
            SimulatedPath { ending: outcome.termination, path_cm }
        };
        Ok((0..).zip(&robots).map(run).collect())
    }

    /// Searches for new controllers at the posterior mean; exploring on drawn robots would be a poor search.
    fn searched(&self, middle: &Environment, known: &Found) -> Result<Vec<Controller>> {
        let target_cm = self.target_cm()?;
        let task = EvolutionTask {
            executor: self.executor,
            environment: middle,
            target_cm,
            routes: &RouteMap::new(self.scene, target_cm, self.simulator.robot.body_radius_cm),
            decoder: self.decoder(),
            seed: self.stream(Purpose::Searching, 0),
        };
        let explores = known.best().is_none_or(|best| best.score < GOOD);
        let explored = if explores { explore::explore(&task, |_, _| {})? } else { Vec::new() };
        let incumbents = known.controllers().take(INCUMBENTS);
        let begun: Vec<Controller> = incumbents.chain(explored.into_iter().take(REFINED)).collect();
        let refined = robust::refine(&task, &begun, |_, _| {})?;
        let shortlist = |ranked: Vec<Judged>| ranked.into_iter().take(SHORTLISTED).map(|judged| judged.controller);
        Ok(refined.into_iter().flat_map(shortlist).collect())
    }

    fn robots(&self) -> Result<Robots> {
        self.simulator
            .robots(ROBOTS, self.stream(Purpose::Robots, 0))
            .ok_or_else(|| Error::new("the simulator file has no parameter uncertainty: train it again"))
    }

    fn evaluator<'a>(&'a self, robots: &'a Robots, tried: &'a [Tried]) -> Result<Evaluator<'a>> {
        let seed = self.stream(Purpose::Judging, 0);
        let judge =
            Judge::new(self.executor, self.simulator, &robots.drawn, self.scene, self.start, self.target_cm()?, seed)?;
        let middle = Environment::new(self.simulator, self.scene, self.start, Noise::Learned)?.of_robot(&robots.mean);
        Ok(Evaluator { judge, middle, seed: self.stream(Purpose::Comparing, 0), tried })
    }

    /// Returns the controllers of earlier iterations.
    fn archived(&self, archive: &[Vec<Tuple>]) -> Vec<Controller> {
        archive.iter().filter_map(|tuples| self.controller(tuples)).collect()
    }

    fn target_cm(&self) -> Result<DVec2> {
        self.scene.target_cm.ok_or_else(|| Error::new("the scene has no target"))
    }

    fn decoder(&self) -> GenotypeDecoder {
        GenotypeDecoder::new(self.simulator, self.max_steps)
    }

    fn stream(&self, purpose: Purpose, number: u64) -> u64 {
        derive(self.seed, &[purpose as u64, number])
    }

    fn controller(&self, tuples: &[Tuple]) -> Option<Controller> {
        Some(self.decoder().with_tuples(tuples.try_into().ok()?))
    }
}
