//! The search of a turn: controllers from new explorations and from those that did well, judged on many robots and by what
//! runs of their like came to.

use mindgap_core::controller::{Controller, Tuple};

use crate::chance::derive;
use crate::error::{Error, Result};
use crate::evolve::chance::{Chance, Judge, ROBOTS, RUNS};
use crate::evolve::fitness::RandomNumbers;
use crate::evolve::genome::GenotypeDecoder;
use crate::evolve::paper::Evolved;
use crate::evolve::robust::{self, EvolutionTask};
use crate::evolve::way::WayMap;
use crate::geometry::Pose;
use crate::logs::Scene;
use crate::simulator::ensemble::Robots;
use crate::simulator::environment::Environment;
use crate::simulator::{Noise, Simulator};

/// Generations that a controller has behind it at most.
pub const GENERATIONS: usize = robust::GENERATIONS / robust::RESTARTS;
/// Runs on each robot that tell which candidates are worth more.
const FEW_RUNS: usize = 3;
/// New explorations of a turn, and controllers from which a search goes on.
const EXPLORED: usize = 2;
const INCUMBENTS: usize = 2;
/// Where the best known controller has this chance, nothing is explored anew.
const GOOD: f64 = 0.6;
/// A controller that succeeded is driven again where it is more likely to succeed than not.
const PROMISING: f64 = 0.5;
/// Candidates that a search leaves, and those that the next turn begins with.
const SHORTLISTED: usize = 8;
const ARCHIVED: usize = 12;
/// Real runs count beside the simulated chance, which counts as so many.
const SIMULATED: f64 = 2.0;
/// A run tells of controllers whose genes differ by less than about this, root mean square.
const ALIKE: f64 = 0.06;

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
    /// The chance with what real runs of its like came to.
    score: f64,
}

/// Streams of random numbers.
#[derive(Clone, Copy)]
enum Purpose {
    Robots,
    Judging,
    Exploring,
    Refining,
}

impl Search<'_> {
    /// The best controllers, from those of earlier turns, those that were driven, and new ones.
    ///
    /// # Errors
    /// When the simulator lacks a network or what its logs left open, or the robot does not fit at the start.
    pub fn best(&self, archive: &[Vec<Tuple>], tried: &[Tried]) -> Result<Found> {
        let ensemble = self.simulator.ensemble.as_ref();
        let robots = ensemble.and_then(|ensemble| ensemble.robots(ROBOTS, self.stream(Purpose::Robots, 0)));
        let Robots { mean, drawn } = robots.ok_or_else(|| {
            Error::new("the simulator file does not say what its training logs leave open: train it again")
        })?;
        let target_cm = self.scene.target_cm.ok_or_else(|| Error::new("the scene has no target"))?;
        let judging = self.stream(Purpose::Judging, 0);
        let judge = Judge::new(self.simulator, &drawn, self.scene, self.start, target_cm, judging)?;
        let environment = Environment::new(self.simulator, self.scene, self.start, Noise::Learned)?;
        let task = EvolutionTask {
            environment: &environment.with_beam(self.simulator).of_robot(&mean),
            target_cm,
            way: &WayMap::new(self.scene, target_cm, self.simulator.robot.body_radius_cm),
            decoder: GenotypeDecoder::new(self.simulator, self.max_steps),
            random_numbers: RandomNumbers::Common,
            seed: self.stream(Purpose::Exploring, 0),
        };
        let known = archive.iter().filter_map(|tuples| self.controller(tuples));
        let mut controllers: Vec<Controller> = Vec::new();
        for controller in tried.iter().map(|tried| tried.controller.clone()).chain(known) {
            if !controllers.contains(&controller) {
                controllers.push(controller);
            }
        }
        let known = ranked(&judge, controllers, FEW_RUNS, tried, &task.decoder);
        let mut controllers: Vec<Controller> = known.iter().map(|known| known.controller.clone()).collect();
        let mut add = |searched: Vec<(f64, Evolved)>| {
            for (_, evolved) in searched.into_iter().take(SHORTLISTED) {
                if !controllers.contains(&evolved.controller) {
                    controllers.push(evolved.controller);
                }
            }
        };
        if known.first().is_none_or(|best| best.score < GOOD) {
            (0..EXPLORED).for_each(|restart| add(robust::explore(&task, restart, |_, _| {})));
        }
        for (i, incumbent) in known.iter().take(INCUMBENTS).enumerate() {
            let seed = self.stream(Purpose::Refining, i as u64);
            let population = robust::mutants(&task, &incumbent.controller, seed);
            add(robust::refine(&task, population, seed, |_, _| {}));
        }
        let mut judged = ranked(&judge, controllers, FEW_RUNS, tried, &task.decoder);
        judged.truncate(ARCHIVED.max(tried.len()));
        let mut finalists: Vec<Controller> = judged.into_iter().map(|candidate| candidate.controller).collect();
        for tried in tried {
            if !finalists.contains(&tried.controller) {
                finalists.push(tried.controller.clone());
            }
        }
        Ok(Found(ranked(&judge, finalists, RUNS, tried, &task.decoder)))
    }

    fn stream(&self, purpose: Purpose, number: u64) -> u64 {
        derive(self.seed, &[purpose as u64, number])
    }

    fn controller(&self, tuples: &[Tuple]) -> Option<Controller> {
        let step_ms = self.simulator.robot.step_ms.round() as u16;
        Some(Controller { step_ms, max_steps: self.max_steps, tuples: tuples.try_into().ok()? })
    }
}

/// Judges controllers; the most promising come first.
fn ranked(
    judge: &Judge,
    controllers: Vec<Controller>,
    runs: usize,
    tried: &[Tried],
    decoder: &GenotypeDecoder,
) -> Vec<Candidate> {
    let chances = judge.chances(&controllers, runs);
    let candidate = |(controller, chance): (Controller, Chance)| {
        let score = score(&controller, chance.success, tried, decoder);
        Candidate { controller, chance, score }
    };
    let mut candidates: Vec<Candidate> = controllers.into_iter().zip(chances).map(candidate).collect();
    candidates.sort_by(|a, b| b.score.total_cmp(&a.score));
    candidates
}

/// The simulated chance, corrected by real runs: those of a controller count whole, those of another the less the more it
/// differs.
fn score(controller: &Controller, chance: f64, tried: &[Tried], decoder: &GenotypeDecoder) -> f64 {
    let genes = decoder.genes(controller);
    let (mut successes, mut runs) = (SIMULATED * chance, SIMULATED);
    for other in tried {
        let others = decoder.genes(&other.controller);
        let squares: f64 = others.iter().zip(&genes).map(|(a, b)| f64::from((a - b) * (a - b))).sum();
        let apart = (squares / genes.len() as f64).sqrt() / ALIKE;
        let weight = libm::exp(-apart * apart);
        successes += weight * other.successes as f64;
        runs += weight * other.runs as f64;
    }
    successes / runs
}

impl Found {
    /// The controller to drive next. One that never failed on the robot is driven again first: whether it works is what
    /// the loop wants to know.
    pub fn choice(&self, tried: &[Tried]) -> (&Controller, &Chance) {
        let confirms = |candidate: &&Candidate| {
            let succeeded = tried.iter().any(|t| t.controller == candidate.controller && t.successes == t.runs);
            succeeded && candidate.score > PROMISING
        };
        let Candidate { controller, chance, .. } = self.0.iter().find(confirms).unwrap_or(&self.0[0]);
        (controller, chance)
    }

    /// The chance of a controller, if it was judged.
    pub fn chance_of(&self, controller: &Controller) -> Option<Chance> {
        self.0.iter().find(|candidate| candidate.controller == *controller).map(|candidate| candidate.chance)
    }

    /// The most promising of those that were driven.
    pub fn settled(&self, tried: &[Tried]) -> Option<&Controller> {
        let driven = |candidate: &&Candidate| tried.iter().any(|tried| tried.controller == candidate.controller);
        self.0.iter().find(driven).map(|candidate| &candidate.controller)
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

    const DECODER: GenotypeDecoder =
        GenotypeDecoder { commands: [-80.0, 80.0], thresholds_cm: [4.0, 240.0], step_ms: 400, max_steps: 60 };

    fn controller(left: i8) -> Controller {
        let tuple = Tuple { left, right: 40, when: When::Larger, threshold_cm: 60 };
        Controller { step_ms: 400, max_steps: 60, tuples: [tuple; 6] }
    }

    #[test]
    fn real_runs_count_for_a_controller_and_its_like() {
        let failed = [Tried { controller: controller(40), runs: 2, successes: 0 }];
        let score = |left: i8| score(&controller(left), 0.9, &failed, &DECODER);
        assert!((score(40) - 1.8 / 4.0).abs() < 1e-9);
        assert!(score(44) < 0.6 && score(-60) > 0.899, "{} {}", score(44), score(-60));
    }
}
