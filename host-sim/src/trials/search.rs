//! The search of a turn: controllers from new explorations and from those that did well, judged on many robots and by their
//! own real runs. What the runs of others tell is in the simulator by then.

use std::cmp::Reverse;

use glam::DVec2;
use mindgap_core::controller::{Controller, Tuple};

use super::state::{IfKnown, SimulatedPath, place_cm};
use crate::chance::derive;
use crate::error::{Error, Result};
use crate::evolve::chance::{Chance, Judge, ROBOTS, RUNS};
use crate::evolve::fitness::RandomNumbers;
use crate::evolve::genome::GenotypeDecoder;
use crate::evolve::prefixes;
use crate::evolve::robust::{self, REFINED};
use crate::evolve::task::{EvolutionTask, Judged};
use crate::evolve::way::WayMap;
use crate::geometry::Pose;
use crate::logs::Scene;
use crate::simulator::ensemble::{Member, Robots};
use crate::simulator::environment::Environment;
use crate::simulator::rollout::RolloutRequest;
use crate::simulator::{Noise, Simulator};

/// Generations that a controller has behind it at most.
pub const GENERATIONS: usize = robust::REFINING_GENERATIONS;
/// Runs on each robot that tell which candidates are worth more.
const FEW_RUNS: usize = 3;
/// Controllers from which a search goes on.
const INCUMBENTS: usize = 2;
/// Where the best known controller has this chance, nothing is explored anew.
const GOOD: f64 = 0.9;
/// A controller works after so many real successes with this chance, real runs counted: two alone were luck for 4 of 16
/// controllers, which then reached the target in three of five fresh runs or fewer.
const SUCCESSES: usize = 3;
const WORKS: f64 = 0.85;
/// The simulated chance that three of three successes confirm.
const CONFIRMED: f64 = (WORKS * (SIMULATED + SUCCESSES as f64) - SUCCESSES as f64) / SIMULATED;
/// Runs on each robot that tell which controller is best there.
const KNOWING_RUNS: usize = 48;
/// Candidates that a search leaves, and those that the next turn begins with.
const SHORTLISTED: usize = 8;
const ARCHIVED: usize = 12;
/// Robots whose paths are kept with a trial.
const SHOWN: usize = 5;
/// Real runs count beside the simulated chance, which counts as so many. Under a beta distribution about the simulated
/// chance that counts as so many, the successes of 44 controllers in forty runs each are the most probable for 9.5, and within
/// one nat for 6 to 15 (docs/loop.md): the fewest, since where the robot has an effect the simulator is worse than there.
const SIMULATED: f64 = 6.0;

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

/// A controller that was driven.
#[derive(Clone, Debug)]
pub struct Tried {
    /// The controller.
    pub controller: Controller,
    /// Runs on the robot.
    pub runs: usize,
    /// Those that reached the target.
    pub successes: usize,
}

/// Controllers with their chances, the most promising first.
pub struct Found(Vec<Candidate>);

struct Candidate {
    controller: Controller,
    chance: Chance,
    /// The chance with what its real runs came to.
    score: f64,
}

/// Streams of random numbers.
#[derive(Clone, Copy)]
enum Purpose {
    Robots,
    Judging,
    Searching,
    Showing,
}

impl Search<'_> {
    /// The controllers that were driven, as they are judged now.
    ///
    /// # Errors
    /// As [`best`](Self::best).
    pub fn judged(&self, tried: &[Tried]) -> Result<Found> {
        let Robots { drawn, .. } = self.robots()?;
        Ok(Found(self.jury(&drawn, tried)?.ranked(driven(tried).collect(), RUNS)?))
    }

    /// The best controllers, from those of earlier turns, those that were driven, and new ones.
    ///
    /// # Errors
    /// When the simulator lacks a network or what its logs left open, or the robot does not fit at the start.
    pub fn best(&self, archive: &[Vec<Tuple>], tried: &[Tried]) -> Result<Found> {
        let Robots { mean, drawn } = self.robots()?;
        let jury = self.jury(&drawn, tried)?;
        let known = jury.ranked(self.known(archive, tried), FEW_RUNS)?;
        let found = self.searched(&mean, &known)?;
        let all = distinct(known.into_iter().map(|known| known.controller).chain(found));
        let promising = jury.ranked(all, FEW_RUNS)?.into_iter().take(ARCHIVED).map(|candidate| candidate.controller);
        Ok(Found(jury.ranked(distinct(promising.chain(driven(tried))), RUNS)?))
    }

    /// The chance of success with the best of these controllers if the robot were known: what a search can reach.
    ///
    /// # Errors
    /// As [`best`](Self::best).
    pub fn if_known(&self, archive: &[Vec<Tuple>], tried: &[Tried]) -> Result<IfKnown> {
        let Robots { drawn, .. } = self.robots()?;
        let success = self.judge(&drawn)?.if_known(&self.known(archive, tried), KNOWING_RUNS)?;
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
    fn searched(&self, mean: &Member, known: &[Candidate]) -> Result<Vec<Controller>> {
        let environment = Environment::new(self.simulator, self.scene, self.start, Noise::Learned)?;
        let target_cm = self.target_cm()?;
        let task = EvolutionTask {
            environment: &environment.of_robot(mean),
            target_cm,
            way: &WayMap::new(self.scene, target_cm, self.simulator.robot.body_radius_cm),
            decoder: self.decoder(),
            random_numbers: RandomNumbers::Common,
            seed: self.stream(Purpose::Searching, 0),
        };
        let explores = known.first().is_none_or(|best| best.score < GOOD);
        let explored = if explores { prefixes::explore(&task, |_, _| {})? } else { Vec::new() };
        let incumbents = known.iter().take(INCUMBENTS).map(|known| known.controller.clone());
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

    fn jury<'a>(&'a self, robots: &'a [Member], tried: &'a [Tried]) -> Result<Jury<'a>> {
        Ok(Jury { judge: self.judge(robots)?, tried })
    }

    fn judge<'a>(&'a self, robots: &'a [Member]) -> Result<Judge<'a>> {
        let seed = self.stream(Purpose::Judging, 0);
        Judge::new(self.simulator, robots, self.scene, self.start, self.target_cm()?, seed)
    }

    /// The controllers that were driven and those of earlier turns.
    fn known(&self, archive: &[Vec<Tuple>], tried: &[Tried]) -> Vec<Controller> {
        distinct(driven(tried).chain(archive.iter().filter_map(|tuples| self.controller(tuples))))
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

fn driven(tried: &[Tried]) -> impl Iterator<Item = Controller> {
    tried.iter().map(|tried| tried.controller.clone())
}

/// Controllers, each once.
fn distinct(controllers: impl Iterator<Item = Controller>) -> Vec<Controller> {
    let mut distinct: Vec<Controller> = Vec::new();
    for controller in controllers {
        if !distinct.contains(&controller) {
            distinct.push(controller);
        }
    }
    distinct
}

/// Robots to judge on, and what the real one did.
struct Jury<'a> {
    judge: Judge<'a>,
    tried: &'a [Tried],
}

impl Jury<'_> {
    /// Controllers with their chances in so many runs of each robot, the most promising first.
    fn ranked(&self, controllers: Vec<Controller>, runs: usize) -> Result<Vec<Candidate>> {
        let chances = self.judge.chances(&controllers, runs)?;
        let candidate = |(controller, chance): (Controller, Chance)| {
            let score = score(&controller, chance.success, self.tried);
            Candidate { controller, chance, score }
        };
        let mut candidates: Vec<Candidate> = controllers.into_iter().zip(chances).map(candidate).collect();
        candidates.sort_by(|a, b| b.score.total_cmp(&a.score));
        Ok(candidates)
    }
}

/// The simulated chance, corrected by the controller's own real runs.
fn score(controller: &Controller, chance: f64, tried: &[Tried]) -> f64 {
    let real = tried.iter().find(|tried| tried.controller == *controller);
    let (runs, successes) = real.map_or((0, 0), |real| (real.runs, real.successes));
    (SIMULATED * chance + successes as f64) / (SIMULATED + runs as f64)
}

/// That of a chance over the robots that it was judged on, by Laplace's rule: even a chance of one has an error.
fn standard_error(chance: f64) -> f64 {
    let robots = ROBOTS as f64;
    let chance = (robots * chance + 1.0) / (robots + 2.0);
    (chance * (1.0 - chance) / robots).sqrt()
}

impl Found {
    /// The most promising controller. Of those that the judgement cannot tell from it, one that the robot has proven: whether
    /// it works is what the loop wants to know.
    pub fn choice(&self, tried: &[Tried]) -> Option<(&Controller, &Chance)> {
        let best = self.0.first()?.score;
        let alike = self.0.iter().take_while(|candidate| best - candidate.score <= standard_error(best));
        let proven = |candidate: &&Candidate| {
            let always = tried.iter().find(|t| t.controller == candidate.controller && t.successes == t.runs);
            Reverse(always.map_or(0, |t| t.successes))
        };
        alike.min_by_key(proven).map(|Candidate { controller, chance, .. }| (controller, chance))
    }

    /// The controller that works.
    pub fn confirmed(&self, tried: &[Tried]) -> Option<(&Controller, &Chance)> {
        let works = |candidate: &&Candidate| {
            let again = tried.iter().any(|t| t.controller == candidate.controller && t.successes >= SUCCESSES);
            again && candidate.score >= WORKS
        };
        self.0.iter().find(works).map(|Candidate { controller, chance, .. }| (controller, chance))
    }

    /// The chance of a controller, if it was judged.
    pub fn chance_of(&self, controller: &Controller) -> Option<Chance> {
        self.0.iter().find(|candidate| candidate.controller == *controller).map(|candidate| candidate.chance)
    }

    /// The tuples of those with which the next turn begins.
    pub fn archive(&self) -> Vec<Vec<Tuple>> {
        self.0.iter().take(ARCHIVED).map(|candidate| candidate.controller.tuples.to_vec()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mindgap_core::controller::When;

    fn controller(left: i8) -> Controller {
        let tuple = Tuple { left, right: 40, when: When::Larger, threshold_cm: 60 };
        Controller { step_ms: 400, max_steps: 60, tuples: [tuple; 6] }
    }

    #[test]
    fn real_runs_count_for_a_controller() {
        let failed = [Tried { controller: controller(40), runs: 2, successes: 0 }];
        let score = |left: i8| score(&controller(left), 0.9, &failed);
        assert!((score(40) - 6.0 * 0.9 / 8.0).abs() < 1e-9 && score(44) == 0.9);
    }

    #[test]
    fn a_controller_works_after_three_successes_with_a_good_chance_and_is_driven_again_unless_another_is_better() {
        let chance = Chance { success: 0.0, ci95: [0.0, 1.0], not_knowing: 0.0 };
        let found = |simulated: f64, tried: &[Tried]| {
            let score = score(&controller(40), simulated, tried);
            let other = Candidate { controller: controller(-60), chance, score: 0.8 };
            let mut both = vec![other, Candidate { controller: controller(40), chance, score }];
            both.sort_by(|a, b| b.score.total_cmp(&a.score));
            Found(both)
        };
        let tried = |runs, successes| [Tried { controller: controller(40), runs, successes }];
        let works = |simulated, tried: &[Tried]| found(simulated, tried).confirmed(tried).is_some();
        assert!(!works(1.0, &tried(2, 2)) && works(0.8, &tried(3, 3)) && !works(0.7, &tried(3, 3)));
        assert!(!works(0.9, &tried(4, 3)));
        let again = |simulated, tried: &[Tried]| {
            found(simulated, tried).choice(tried).is_some_and(|(next, _)| *next == controller(40))
        };
        // Its score is 0.74 and 0.66 where the other's is 0.8, more or less 0.06.
        assert!(again(0.7, &tried(1, 1)) && !again(0.6, &tried(1, 1)));
        // 0.76 after a failure is only less.
        assert!(!again(0.85, &tried(2, 1)) && again(1.0, &tried(2, 1)));
    }
}
