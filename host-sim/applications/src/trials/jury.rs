//! What controllers are worth: their chances on many simulated robots, and what the real one did.
//!
//! What real runs say of the robot is in the simulator by then. What they came to against that says how far the simulator is
//! wrong about them, and so about controllers whose paths are alike (`likeness`), as in adapting from trial to trial
//! by a Gaussian process over behaviours (Cully and others, Nature 2015).

use std::cmp::Reverse;

use mindgap_core::controller::{Controller, Tuple};

use super::likeness::{Paths, likeness, paths};
use mindgap_foundations::error::Result;
use mindgap_learning::evolve::chance::{Chance, Judge, ROBOTS};
use mindgap_models::simulator::environment::Environment;

/// A controller works after so many real successes with this chance, real runs counted: two alone were luck for 4 of 16
/// controllers, which then reached the target in three of five fresh runs or fewer.
const SUCCESSES: usize = 3;
const WORKS: f64 = 0.85;
/// The simulated chance that three of three successes confirm.
pub const CONFIRMED: f64 = (WORKS * (SIMULATED + SUCCESSES as f64) - SUCCESSES as f64) / SIMULATED;
/// Real runs count beside the simulated chance, which counts as so many. Under a beta distribution about the simulated
/// chance that counts as so many, the successes of 44 controllers in forty runs each are the most probable for 9.5, and within
/// one nat for 6 to 15 (docs/loop.md): the fewest, since where the robot has an effect the simulator is worse than there.
const SIMULATED: f64 = 6.0;

/// A controller that was driven.
#[derive(Clone, Debug)]
pub struct Tried {
    /// The controller.
    pub controller: Controller,
    /// Runs on the robot.
    pub runs: usize,
    /// Those that reached the target.
    pub successes: usize,
    /// Steps of the longest one.
    pub steps: usize,
}

/// Robots to judge on, and what the real one did.
pub struct Jury<'a> {
    /// Robots that are possible.
    pub judge: Judge<'a>,
    /// The one in their middle, on which paths are compared.
    pub middle: Environment<'a>,
    /// Seed of the runs that are compared.
    pub seed: u64,
    /// What was driven.
    pub tried: &'a [Tried],
}

/// Controllers with their chances, the most promising first.
pub struct Found(Vec<Candidate>);

/// A controller with what it is worth.
#[derive(Clone, Debug)]
pub struct Candidate {
    /// The controller.
    pub controller: Controller,
    /// Its simulated chance.
    pub chance: Chance,
    /// The chance with what real runs came to, its own and those of controllers like it.
    pub score: f64,
}

impl Jury<'_> {
    /// These controllers and those that were driven, each once, with their chances in so many runs of each robot.
    ///
    /// # Errors
    /// As [`Judge::chances`].
    pub fn ranked(&self, controllers: Vec<Controller>, runs: usize) -> Result<Found> {
        let controllers = self.with_tried(controllers);
        let chances = self.judge.chances(&controllers, runs)?;
        let surprises: Vec<Surprise> = self.tried.iter().zip(&chances).map(|(t, c)| self.surprise(t, c)).collect();
        let candidate = |(controller, chance): (Controller, Chance)| {
            let score = if surprises.is_empty() {
                chance.success
            } else {
                score(&self.paths(&controller), chance.success, &surprises)
            };
            Candidate { controller, chance, score }
        };
        Ok(Found::of(controllers.into_iter().zip(chances).map(candidate).collect()))
    }

    /// The chance of success with the best of these controllers and those that were driven if the robot were known.
    ///
    /// # Errors
    /// As [`Judge::chances`].
    pub fn if_known(&self, controllers: Vec<Controller>, runs: usize) -> Result<f64> {
        self.judge.if_known(&self.with_tried(controllers), runs)
    }

    /// Each once, those that were driven first.
    fn with_tried(&self, controllers: Vec<Controller>) -> Vec<Controller> {
        let mut distinct: Vec<Controller> = self.tried.iter().map(|tried| tried.controller.clone()).collect();
        for controller in controllers {
            if !distinct.contains(&controller) {
                distinct.push(controller);
            }
        }
        distinct
    }

    fn surprise(&self, tried: &Tried, chance: &Chance) -> Surprise {
        let (runs, successes) = (tried.runs as f64, tried.successes as f64);
        let paths = self.paths(&tried.controller);
        Surprise { paths, steps: tried.steps, runs, more: successes - runs * chance.success }
    }

    fn paths(&self, controller: &Controller) -> Paths {
        paths(&self.middle, controller, self.seed)
    }
}

/// What real runs of a controller came to against what is foretold by now.
struct Surprise {
    paths: Paths,
    steps: usize,
    runs: f64,
    /// More successes than foretold.
    more: f64,
}

/// The simulated chance, corrected by real runs; by others' as far as paths are alike.
fn score(paths: &Paths, chance: f64, surprises: &[Surprise]) -> f64 {
    let (mut runs, mut more) = (SIMULATED, 0.0);
    for surprise in surprises {
        let alike = likeness(&surprise.paths, paths, surprise.steps);
        runs += alike * surprise.runs;
        more += alike * surprise.more;
    }
    (chance + more / runs).clamp(0.0, 1.0)
}

/// That of a chance over the robots that it was judged on, by Laplace's rule: even a chance of one has an error.
fn standard_error(chance: f64) -> f64 {
    let robots = ROBOTS as f64;
    let chance = (robots * chance + 1.0) / (robots + 2.0);
    (chance * (1.0 - chance) / robots).sqrt()
}

impl Found {
    fn of(mut candidates: Vec<Candidate>) -> Self {
        candidates.sort_by(|a, b| b.score.total_cmp(&a.score));
        Found(candidates)
    }

    /// The most promising one.
    pub fn best(&self) -> Option<&Candidate> {
        self.0.first()
    }

    /// The controllers alone.
    pub fn controllers(&self) -> impl Iterator<Item = Controller> {
        self.0.iter().map(|candidate| candidate.controller.clone())
    }

    /// The one to drive. Of those that the judgement cannot tell from the most promising, one that the robot has proven:
    /// whether it works is what the loop wants to know.
    pub fn choice(&self, tried: &[Tried]) -> Option<&Candidate> {
        let best = self.best()?.score;
        let alike = self.0.iter().take_while(|candidate| best - candidate.score <= standard_error(best));
        let proven = |candidate: &&Candidate| {
            let always = tried.iter().find(|t| t.controller == candidate.controller && t.successes == t.runs);
            Reverse(always.map_or(0, |t| t.successes))
        };
        alike.min_by_key(proven)
    }

    /// The controller that works.
    pub fn confirmed(&self, tried: &[Tried]) -> Option<&Candidate> {
        let works = |candidate: &&Candidate| {
            let again = tried.iter().any(|t| t.controller == candidate.controller && t.successes >= SUCCESSES);
            again && candidate.score >= WORKS
        };
        self.0.iter().find(works)
    }

    /// The chance of a controller, if it was judged.
    pub fn chance_of(&self, controller: &Controller) -> Option<Chance> {
        self.0.iter().find(|candidate| candidate.controller == *controller).map(|candidate| candidate.chance)
    }

    /// The tuples of so many of the best.
    pub fn tuples(&self, count: usize) -> Vec<Vec<Tuple>> {
        self.0.iter().take(count).map(|candidate| candidate.controller.tuples.to_vec()).collect()
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec2;
    use mindgap_core::controller::When;

    use super::*;

    fn controller(left: i8) -> Controller {
        let tuple = Tuple { left, right: 40, when: When::Larger, threshold_cm: 60 };
        Controller { step_ms: 400, max_steps: 60, tuples: [tuple; 6] }
    }

    /// Ten steps of ten centimetres in a direction.
    fn straight(angle_deg: f64) -> Paths {
        vec![(0..=10).map(|step| DVec2::from_angle(angle_deg.to_radians()) * 10.0 * f64::from(step)).collect()]
    }

    fn failed(times: f64, foretold: f64, steps: usize) -> [Surprise; 1] {
        [Surprise { paths: straight(0.0), steps, runs: times, more: -times * foretold }]
    }

    #[test]
    fn real_runs_count_for_a_controller() {
        assert!((score(&straight(0.0), 0.9, &failed(2.0, 0.9, 10)) - 6.0 * 0.9 / 8.0).abs() < 1e-9);
        assert!((score(&straight(0.0), 0.9, &[]) - 0.9).abs() < 1e-9);
    }

    #[test]
    fn they_count_for_those_that_drive_alike_but_for_what_the_simulator_knows_by_now() {
        let turned = |deg: f64, foretold: f64| score(&straight(deg), 0.9, &failed(2.0, foretold, 10));
        assert!(turned(1.0, 0.9) < 0.7 && turned(40.0, 0.9) > 0.89);
        assert!((turned(1.0, 0.0) - 0.9).abs() < 1e-9);
    }

    #[test]
    fn a_controller_works_after_three_successes_with_a_good_chance_and_is_driven_again_unless_another_is_better() {
        let chance = Chance { success: 0.0, ci95: [0.0, 1.0], not_knowing: 0.0 };
        let found = |simulated: f64, tried: &[Tried]| {
            let [Tried { runs, successes, .. }] = tried else { unreachable!("one") };
            let (runs, successes) = (*runs as f64, *successes as f64);
            let own = Surprise { paths: straight(0.0), steps: 10, runs, more: successes - runs * simulated };
            let score = score(&straight(0.0), simulated, &[own]);
            let other = Candidate { controller: controller(-60), chance, score: 0.8 };
            Found::of(vec![other, Candidate { controller: controller(40), chance, score }])
        };
        let tried = |runs, successes| [Tried { controller: controller(40), runs, successes, steps: 10 }];
        let works = |simulated, tried: &[Tried]| found(simulated, tried).confirmed(tried).is_some();
        assert!(!works(1.0, &tried(2, 2)) && works(0.8, &tried(3, 3)) && !works(0.7, &tried(3, 3)));
        assert!(!works(0.9, &tried(4, 3)));
        let again = |simulated, tried: &[Tried]| {
            found(simulated, tried).choice(tried).is_some_and(|next| next.controller == controller(40))
        };
        // Its score is 0.74 and 0.66 where the other's is 0.8, more or less 0.06.
        assert!(again(0.7, &tried(1, 1)) && !again(0.6, &tried(1, 1)));
        // 0.76 after a failure is only less.
        assert!(!again(0.85, &tried(2, 1)) && again(1.0, &tried(2, 1)));
    }
}
