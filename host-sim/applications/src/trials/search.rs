//! The search of a turn: controllers from new explorations and from those that did well, judged on many robots and by real
//! runs.

use glam::DVec2;
use mindgap_core::controller::{Controller, Tuple};

use super::jury::{CONFIRMED, Found, Jury, Tried};
use super::state::{IfKnown, SimulatedPath, place_cm};
use mindgap_foundations::error::{Error, Result};
use mindgap_foundations::geometry::Pose;
use mindgap_foundations::random::derive;
use mindgap_learning::evolve::chance::{Judge, ROBOTS, RUNS};
use mindgap_learning::evolve::fitness::RandomNumbers;
use mindgap_learning::evolve::genome::GenotypeDecoder;
use mindgap_learning::evolve::prefixes;
use mindgap_learning::evolve::robust::{self, REFINED};
use mindgap_learning::evolve::task::{EvolutionTask, Judged};
use mindgap_learning::evolve::way::WayMap;
use mindgap_logs::Scene;
use mindgap_models::simulator::ensemble::Robots;
use mindgap_models::simulator::environment::Environment;
use mindgap_models::simulator::rollout::RolloutRequest;
use mindgap_models::simulator::{Noise, Simulator};

/// Generations that a controller has behind it at most.
pub const GENERATIONS: usize = robust::REFINING_GENERATIONS;
/// Runs on each robot that tell which candidates are worth more.
const FEW_RUNS: usize = 3;
/// Controllers from which a search goes on.
const INCUMBENTS: usize = 2;
/// Where the best known controller has this chance, nothing is explored anew.
const GOOD: f64 = 0.9;
/// Runs on each robot that tell which controller is best there.
const KNOWING_RUNS: usize = 48;
/// Candidates that a search leaves.
const SHORTLISTED: usize = 8;
/// Those that the next turn begins with.
pub const ARCHIVED: usize = 12;
/// Robots whose paths are kept with a trial.
const SHOWN: usize = 5;

/// What a turn searches in.
pub struct Search<'a> {
    /// The simulator, adapted to all runs so far.
    pub simulator: &'a Simulator,
    /// The scene.
    pub scene: &'a Scene,
    /// Where controllers start.
    pub start: Pose,
    /// Steps after which a controller gives up.
    pub max_steps: u16,
    /// Seed of all draws.
    pub seed: u64,
}

/// Streams of random numbers.
#[derive(Clone, Copy)]
enum Purpose {
    Robots,
    Judging,
    Searching,
    Showing,
    Comparing,
}

impl Search<'_> {
    /// The controllers that were driven, as they are judged now.
    ///
    /// # Errors
    /// As [`best`](Self::best).
    pub fn judged(&self, tried: &[Tried]) -> Result<Found> {
        let robots = self.robots()?;
        self.jury(&robots, tried)?.ranked(Vec::new(), RUNS)
    }

    /// The best controllers, from those of earlier turns, those that were driven, and new ones.
    ///
    /// # Errors
    /// When the simulator lacks a network or what its logs left open, or the robot does not fit at the start.
    pub fn best(&self, archive: &[Vec<Tuple>], tried: &[Tried]) -> Result<Found> {
        let robots = self.robots()?;
        let jury = self.jury(&robots, tried)?;
        let known = jury.ranked(self.archived(archive), FEW_RUNS)?;
        let found = self.searched(&jury.middle, &known)?;
        let all = known.controllers().chain(found).collect();
        let promising = jury.ranked(all, FEW_RUNS)?.controllers().take(ARCHIVED).collect();
        jury.ranked(promising, RUNS)
    }

    /// The chance of success with the best of these controllers if the robot were known: what a search can reach.
    ///
    /// # Errors
    /// As [`best`](Self::best).
    pub fn if_known(&self, archive: &[Vec<Tuple>], tried: &[Tried]) -> Result<IfKnown> {
        let robots = self.robots()?;
        let success = self.jury(&robots, tried)?.if_known(self.archived(archive), KNOWING_RUNS)?;
        Ok(IfKnown { success, is_enough: success >= CONFIRMED })
    }

    /// Paths of a controller on some of the robots that it was judged on.
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
            SimulatedPath { ending: outcome.termination.into(), path_cm }
        };
        Ok((0..).zip(&robots).map(run).collect())
    }

    /// New controllers, on the robot in the middle: exploring on drawn ones would be a bad search.
    fn searched(&self, middle: &Environment, known: &Found) -> Result<Vec<Controller>> {
        let target_cm = self.target_cm()?;
        let task = EvolutionTask {
            environment: middle,
            target_cm,
            way: &WayMap::new(self.scene, target_cm, self.simulator.robot.body_radius_cm),
            decoder: self.decoder(),
            random_numbers: RandomNumbers::Common,
            seed: self.stream(Purpose::Searching, 0),
        };
        let explores = known.best().is_none_or(|best| best.score < GOOD);
        let explored = if explores { prefixes::explore(&task, |_, _| {})? } else { Vec::new() };
        let incumbents = known.controllers().take(INCUMBENTS);
        let begun: Vec<Controller> = incumbents.chain(explored.into_iter().take(REFINED)).collect();
        let refined = robust::refine(&task, &begun, |_, _| {})?;
        let shortlist = |ranked: Vec<Judged>| ranked.into_iter().take(SHORTLISTED).map(|judged| judged.controller);
        Ok(refined.into_iter().flat_map(shortlist).collect())
    }

    fn robots(&self) -> Result<Robots> {
        self.simulator.robots(ROBOTS, self.stream(Purpose::Robots, 0)).ok_or_else(|| {
            Error::new("the simulator file does not say what its training logs leave open: train it again")
        })
    }

    fn jury<'a>(&'a self, robots: &'a Robots, tried: &'a [Tried]) -> Result<Jury<'a>> {
        let seed = self.stream(Purpose::Judging, 0);
        let judge = Judge::new(self.simulator, &robots.drawn, self.scene, self.start, self.target_cm()?, seed)?;
        let middle = Environment::new(self.simulator, self.scene, self.start, Noise::Learned)?.of_robot(&robots.mean);
        Ok(Jury { judge, middle, seed: self.stream(Purpose::Comparing, 0), tried })
    }

    /// The controllers of earlier turns.
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
