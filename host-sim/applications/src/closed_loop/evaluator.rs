//! Controller evaluation: success probability over the posterior of robots, updated with real runs.
//!
//! The simulator is already adapted to the motion in the real runs. Their outcomes, compared with the prediction, show how
//! wrong the simulator still is for these controllers and for those with similar paths (`similarity`), as in trial-to-trial
//! adaptation by a Gaussian process over behaviours (Cully et al., Nature 2015).

use std::cmp::Reverse;

use mindgap_core::controller::{Controller, Tuple};

use super::similarity::{Paths, paths, similarity};
use mindgap_foundations::error::Result;
use mindgap_learning::evolve::success_probability::{Judge, ROBOTS, SuccessProbability};
use mindgap_models::simulator::environment::Environment;

/// A controller works after this many real successes with this success probability, real runs included: two successes were
/// luck for 4 of 16 controllers, which then reached the target in at most three of five new runs.
const SUCCESSES: usize = 3;
const WORKS: f64 = 0.85;
/// Simulated success probability that three of three successes confirm.
pub const CONFIRMED: f64 = (WORKS * (SIMULATED + SUCCESSES as f64) - SUCCESSES as f64) / SIMULATED;
/// Weight of the simulated success probability, in real runs (the concentration of a beta prior). The successes of 44
/// controllers in forty runs each are most likely at 9.5, and within one nat at 6 to 15 (docs/explanation/loop.md). The
/// smallest is used, since the simulator is worse if the robot has an unmodelled effect.
const SIMULATED: f64 = 6.0;

/// A controller that was driven.
#[derive(Clone, Debug)]
pub struct Tried {
    /// The controller.
    pub controller: Controller,
    /// Runs on the robot.
    pub runs: usize,
    /// Runs that reached the target.
    pub successes: usize,
    /// Steps of the longest run.
    pub steps: usize,
}

/// Evaluates controllers on robots of the posterior and by real runs.
pub struct Evaluator<'a> {
    /// Success probability over the posterior of robots.
    pub judge: Judge<'a>,
    /// Robot at the posterior mean, on which paths are compared.
    pub middle: Environment<'a>,
    /// Seed of the compared runs.
    pub seed: u64,
    /// Controllers that were driven on the robot.
    pub tried: &'a [Tried],
}

/// Evaluated controllers, the most promising first.
pub struct Found(Vec<Candidate>);

/// An evaluated controller.
#[derive(Clone, Debug)]
pub struct Candidate {
    /// The controller.
    pub controller: Controller,
    /// Simulated success probability.
    pub chance: SuccessProbability,
    /// Success probability updated with the real runs of this and similar controllers.
    pub score: f64,
}

impl Evaluator<'_> {
    /// Evaluates these controllers and those that were driven, with `runs` runs on each robot.
    ///
    /// # Errors
    /// As [`Judge::success_probabilities`].
    pub fn ranked(&self, controllers: Vec<Controller>, runs: usize) -> Result<Found> {
        let controllers = self.with_tried(controllers);
        let chances = self.judge.success_probabilities(&controllers, runs)?;
        let surprises: Vec<Surprise> = self.tried.iter().zip(&chances).map(|(t, c)| self.surprise(t, c)).collect();
        let candidate = |(controller, chance): (Controller, SuccessProbability)| {
            let score = if surprises.is_empty() {
                chance.success
            } else {
                score(&self.paths(&controller), chance.success, &surprises)
            };
            Candidate { controller, chance, score }
        };
        Ok(Found::of(controllers.into_iter().zip(chances).map(candidate).collect()))
    }

    /// Returns the mean success probability if, for each robot, the best of these and the driven controllers could be used.
    ///
    /// # Errors
    /// As [`Judge::success_probabilities`].
    pub fn oracle(&self, controllers: Vec<Controller>, runs: usize) -> Result<f64> {
        self.judge.if_known(&self.with_tried(controllers), runs)
    }

    /// Returns the distinct controllers, driven ones first.
    fn with_tried(&self, controllers: Vec<Controller>) -> Vec<Controller> {
        let mut distinct: Vec<Controller> = self.tried.iter().map(|tried| tried.controller.clone()).collect();
        for controller in controllers {
            if !distinct.contains(&controller) {
                distinct.push(controller);
            }
        }
        distinct
    }

    fn surprise(&self, tried: &Tried, chance: &SuccessProbability) -> Surprise {
        let (runs, successes) = (tried.runs as f64, tried.successes as f64);
        let paths = self.paths(&tried.controller);
        Surprise { paths, steps: tried.steps, runs, more: successes - runs * chance.success }
    }

    fn paths(&self, controller: &Controller) -> Paths {
        paths(&self.middle, controller, self.seed)
    }
}

/// The real results of a controller relative to the present prediction.
struct Surprise {
    paths: Paths,
    steps: usize,
    runs: f64,
    /// Successes beyond the predicted number.
    more: f64,
}

/// Returns the simulated success probability corrected by real runs, weighted by the similarity of paths.
fn score(paths: &Paths, chance: f64, surprises: &[Surprise]) -> f64 {
    let (mut runs, mut more) = (SIMULATED, 0.0);
    for surprise in surprises {
        let alike = similarity(&surprise.paths, paths, surprise.steps);
        runs += alike * surprise.runs;
        more += alike * surprise.more;
    }
    (chance + more / runs).clamp(0.0, 1.0)
}

/// Returns the standard error of a probability estimated on [`ROBOTS`] robots, by Laplace's rule of succession.
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

    /// Returns the most promising controller.
    pub fn best(&self) -> Option<&Candidate> {
        self.0.first()
    }

    /// Returns the controllers without their evaluation.
    pub fn controllers(&self) -> impl Iterator<Item = Controller> {
        self.0.iter().map(|candidate| candidate.controller.clone())
    }

    /// Returns the controller to drive next. Among those within one standard error of the most promising, controllers with
    /// real successes come first, since the loop must confirm one.
    pub fn choice(&self, tried: &[Tried]) -> Option<&Candidate> {
        let best = self.best()?.score;
        let alike = self.0.iter().take_while(|candidate| best - candidate.score <= standard_error(best));
        let proven = |candidate: &&Candidate| {
            let always = tried.iter().find(|t| t.controller == candidate.controller && t.successes == t.runs);
            Reverse(always.map_or(0, |t| t.successes))
        };
        alike.min_by_key(proven)
    }

    /// Returns the controller that is confirmed to work, if any.
    pub fn confirmed(&self, tried: &[Tried]) -> Option<&Candidate> {
        let works = |candidate: &&Candidate| {
            let again = tried.iter().any(|t| t.controller == candidate.controller && t.successes >= SUCCESSES);
            again && candidate.score >= WORKS
        };
        self.0.iter().find(works)
    }

    /// Returns the success probability of a controller, if it was evaluated.
    pub fn chance_of(&self, controller: &Controller) -> Option<SuccessProbability> {
        self.0.iter().find(|candidate| candidate.controller == *controller).map(|candidate| candidate.chance)
    }

    /// Returns the tuples of the best `count` controllers.
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

    /// Returns a path of ten steps of ten centimetres.
    fn straight(angle_deg: f64) -> Paths {
        vec![(0..=10).map(|step| DVec2::from_angle(angle_deg.to_radians()) * 10.0 * f64::from(step)).collect()]
    }

    fn failed(times: f64, predicted: f64, steps: usize) -> [Surprise; 1] {
        [Surprise { paths: straight(0.0), steps, runs: times, more: -times * predicted }]
    }

    #[test]
    fn real_runs_correct_the_score_of_a_controller() {
        assert!((score(&straight(0.0), 0.9, &failed(2.0, 0.9, 10)) - 6.0 * 0.9 / 8.0).abs() < 1e-9);
        assert!((score(&straight(0.0), 0.9, &[]) - 0.9).abs() < 1e-9);
    }

    #[test]
    fn real_runs_correct_similar_controllers_unless_already_predicted() {
        let turned = |deg: f64, predicted: f64| score(&straight(deg), 0.9, &failed(2.0, predicted, 10));
        assert!(turned(1.0, 0.9) < 0.7 && turned(40.0, 0.9) > 0.89);
        assert!((turned(1.0, 0.0) - 0.9).abs() < 1e-9);
    }

    #[test]
    fn three_successes_confirm_a_controller_and_fewer_repeat_it_unless_another_is_better() {
        let chance = SuccessProbability { success: 0.0, ci95: [0.0, 1.0], epistemic_fraction: 0.0 };
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
        // The scores are 0.74 and 0.66; that of the other controller is 0.8 with a standard error of 0.06.
        assert!(again(0.7, &tried(1, 1)) && !again(0.6, &tried(1, 1)));
        // After a failure a score of 0.76 is not preferred.
        assert!(!again(0.85, &tried(2, 1)) && again(1.0, &tried(2, 1)));
    }
}
