//! Probability that a controller reaches the target, and its epistemic uncertainty: over robots drawn from the posterior of
//! the simulator, each with its own success rate.

use std::fmt;

use glam::DVec2;
use mindgap_core::controller::Controller;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use mindgap_foundations::error::Result;
use mindgap_foundations::executor::{self, Executor};
use mindgap_foundations::geometry::Pose;
use mindgap_foundations::random::derive;
use mindgap_logs::{Scene, Termination};
use mindgap_models::simulator::Simulator;
use mindgap_models::simulator::ensemble::Member;
use mindgap_models::simulator::environment::Environment;
use mindgap_models::simulator::motion::MotionTable;
use mindgap_models::simulator::rollout::{RolloutOutcome, RolloutRequest};

/// Number of robots over which the epistemic uncertainty is estimated.
pub const ROBOTS: usize = 48;
/// Number of runs per robot for a probability that is reported.
pub const RUNS: usize = 12;

/// The probability of success of a controller.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SuccessProbability {
    /// Mean over all robots, 0..=1.
    pub success: f64,
    /// Interval that contains the success rates of 95 % of the robots, 0..=1.
    pub ci95: [f64; 2],
    /// Share of the variance of a single run's success that comes from uncertainty about the robot, 0..=1; the rest is noise.
    pub epistemic_fraction: f64,
}

/// Shares of simulated runs by how they end; they add up to one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Endings {
    /// Reached the target.
    pub reached: f64,
    /// Finished elsewhere.
    pub missed: f64,
    /// Touched a wall or an obstacle.
    pub crashed: f64,
    /// Drove until the step limit, not to the target.
    pub timed_out: f64,
}

/// Evaluates controllers on robots drawn from the posterior.
pub struct Judge<'a> {
    executor: &'a dyn Executor,
    robots: Vec<Environment<'a>>,
    target_cm: DVec2,
    seed: u64,
}

impl<'a> Judge<'a> {
    /// Places the robots at a start of a scene with a target. All controllers have the same runs, which `seed` fixes.
    ///
    /// # Errors
    /// As [`Environment::new`].
    pub fn new(
        executor: &'a dyn Executor,
        simulator: &'a Simulator,
        members: &'a [Member],
        scene: &Scene,
        start: Pose,
        target_cm: DVec2,
        seed: u64,
    ) -> Result<Self> {
        Ok(Judge { executor, robots: Environment::of_robots(simulator, members, scene, start)?, target_cm, seed })
    }

    /// Returns the probability of success of each controller, from `runs` runs of every robot.
    ///
    /// # Errors
    /// If the executor fails.
    pub fn success_probabilities(&self, controllers: &[Controller], runs: usize) -> Result<Vec<SuccessProbability>> {
        let by_robot = self.successes(controllers, runs)?;
        let rates = |controller: usize| by_robot.iter().map(|robot| share(&robot[controller])).collect();
        Ok((0..controllers.len()).map(|controller| SuccessProbability::from_rates(rates(controller), runs)).collect())
    }

    /// Returns how `runs` runs of every robot end.
    ///
    /// # Errors
    /// If the executor fails.
    pub fn endings(&self, controller: &Controller, runs: usize) -> Result<Endings> {
        let of_robot = |number: usize| {
            let robot = &self.robots[number];
            let motions = [robot.motions(controller)];
            let outcomes = robot.run(&self.requests(number, std::slice::from_ref(controller), &motions, runs));
            let share = |is_such: &dyn Fn(&RolloutOutcome) -> bool| {
                outcomes.iter().filter(|outcome| is_such(outcome)).count() as f64 / (runs * self.robots.len()) as f64
            };
            let failed = |as_this: Termination| {
                share(&|outcome| !outcome.reached(self.target_cm) && outcome.termination == as_this)
            };
            Ok([
                share(&|outcome| outcome.reached(self.target_cm)),
                failed(Termination::Finished),
                failed(Termination::Crashed),
                failed(Termination::TimedOut),
            ])
        };
        let by_robot = executor::map(self.executor, self.robots.len(), of_robot)?;
        let sum = |ending: usize| by_robot.iter().map(|shares: &[f64; 4]| shares[ending]).sum();
        Ok(Endings { reached: sum(0), missed: sum(1), crashed: sum(2), timed_out: sum(3) })
    }

    /// Returns the probability of success if the robot were known: the mean over robots of that of the best controller for
    /// each. One half of the `runs` runs selects the controller and the other half measures it, since the rate by which one
    /// has selected is biased upwards.
    ///
    /// # Errors
    /// If the executor fails.
    pub fn if_known(&self, controllers: &[Controller], runs: usize) -> Result<f64> {
        let by_robot = self.successes(controllers, runs)?;
        let best = by_robot.iter().flat_map(|robot| {
            let halves = robot.iter().map(|runs| [&runs[..runs.len() / 2], &runs[runs.len() / 2..]].map(share));
            [0, 1].map(|chooses| {
                let best = halves.clone().max_by(|one, other| one[chooses].total_cmp(&other[chooses]));
                best.map_or(0.0, |halves| halves[1 - chooses])
            })
        });
        Ok(best.sum::<f64>() / (2 * self.robots.len()) as f64)
    }

    /// Returns for every robot, controller and run whether it reaches the target.
    fn successes(&self, controllers: &[Controller], runs: usize) -> Result<Vec<Vec<Vec<bool>>>> {
        let of_robot = |number: usize| Ok(self.successes_on(number, &self.robots[number], controllers, runs));
        executor::map(self.executor, self.robots.len(), of_robot)
    }

    fn successes_on(
        &self,
        number: usize,
        robot: &Environment,
        controllers: &[Controller],
        runs: usize,
    ) -> Vec<Vec<bool>> {
        let motions: Vec<_> = controllers.iter().map(|controller| robot.motions(controller)).collect();
        let outcomes = robot.run(&self.requests(number, controllers, &motions, runs));
        let reached = |of_one: &[RolloutOutcome]| of_one.iter().map(|o| o.reached(self.target_cm)).collect();
        outcomes.chunks(runs).map(reached).collect()
    }

    /// Returns the runs of controllers on a robot.
    fn requests<'r>(
        &self,
        robot: usize,
        controllers: &'r [Controller],
        motions: &'r [MotionTable],
        runs: usize,
    ) -> Vec<RolloutRequest<'r>> {
        let seed = |run: usize| derive(self.seed, &[robot as u64, run as u64]);
        let of_one =
            |(controller, motions)| (0..runs).map(move |run| RolloutRequest { controller, motions, seed: seed(run) });
        controllers.iter().zip(motions).flat_map(of_one).collect()
    }
}

/// Returns the share of the runs that reach the target.
fn share(reached: &[bool]) -> f64 {
    reached.iter().filter(|reached| **reached).count() as f64 / reached.len() as f64
}

/// Writes the probability in percent, with the interval over robots.
impl fmt::Display for SuccessProbability {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [success, low, high] = [self.success, self.ci95[0], self.ci95[1]].map(|share| 100.0 * share);
        write!(f, "{success:.0} % ({low:.0} to {high:.0})")
    }
}

impl SuccessProbability {
    /// Estimates the probability from the success rates of robots in `runs` runs each.
    fn from_rates(mut rates: Vec<f64>, runs: usize) -> Self {
        rates.sort_by(f64::total_cmp);
        let count = rates.len() as f64;
        let success = rates.iter().sum::<f64>() / count;
        let spread = rates.iter().map(|rate| (rate - success) * (rate - success)).sum::<f64>() / (count - 1.0).max(1.0);
        let whole = success * (1.0 - success);
        // Rates of few runs scatter even if all robots have the same probability.
        let runs = runs as f64;
        let between = if runs > 1.0 { (runs * spread - whole) / (runs - 1.0) } else { 0.0 };
        let at = |share: f64| rates[((count - 1.0) * share).round() as usize];
        let epistemic_fraction = if whole > 0.0 { (between / whole).clamp(0.0, 1.0) } else { 0.0 };
        SuccessProbability { success, ci95: [at(0.025), at(0.975)], epistemic_fraction }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evolve::genome::GenotypeDecoder;
    use crate::evolve::test_support::SIMULATOR;
    use mindgap_built_in_robot::four_obstacles;
    use mindgap_foundations::executor::Serial;
    use mindgap_foundations::random::generator;

    const SEED: u64 = 5;

    #[test]
    fn known_robot_gets_its_best_controller() {
        let (scene, robots) = (four_obstacles(), SIMULATOR.robots(12, SEED).expect("robots"));
        let start = scene.starts[0];
        // Some random controllers get there.
        let target_cm = start.position_cm + DVec2::new(25.0, 0.0);
        let judge = Judge::new(&Serial, &SIMULATOR, &robots.drawn, &scene, start, target_cm, SEED).expect("room");
        let decoder = GenotypeDecoder::new(&SIMULATOR, 60);
        let controllers: Vec<Controller> =
            (0..300).map(|number| decoder.controller(&decoder.random(&mut generator(SEED, &[number])))).collect();
        let probabilities = judge.success_probabilities(&controllers, 4 * RUNS).expect("probabilities");
        let uncertain: Vec<usize> =
            (0..300).filter(|number| (0.1..0.9).contains(&probabilities[*number].success)).take(5).collect();
        assert_eq!(uncertain.len(), 5);
        let known = |numbers: &[usize]| {
            let some: Vec<Controller> = numbers.iter().map(|number| controllers[*number].clone()).collect();
            judge.if_known(&some, 4 * RUNS).expect("a probability")
        };
        let never = (0..300).find(|number| probabilities[*number].success == 0.0).expect("one that does not get there");
        for number in &uncertain {
            assert!((known(&[*number]) - probabilities[*number].success).abs() < 1e-9);
            assert!((known(&[*number, never]) - probabilities[*number].success).abs() < 0.05);
        }
        let best = uncertain.iter().map(|number| probabilities[*number].success).fold(0.0, f64::max);
        assert!(known(&uncertain) > best - 0.1 && known(&uncertain) <= 1.0, "{} of {best}", known(&uncertain));
    }

    #[test]
    fn variance_between_robots_is_epistemic_and_that_of_coins_is_not() {
        let split: Vec<f64> = (0..40).map(|robot| f64::from(robot % 2)).collect();
        let probability = SuccessProbability::from_rates(split, 10);
        assert!(
            (probability.success - 0.5).abs() < 1e-9
                && probability.epistemic_fraction > 0.95
                && probability.ci95 == [0.0, 1.0],
            "{probability:?}"
        );
        // As often as ten fair coins show heads.
        let coins = [0.2, 0.3, 0.4, 0.4, 0.5, 0.5, 0.6, 0.6, 0.7, 0.8].repeat(4);
        let probability = SuccessProbability::from_rates(coins, 10);
        assert!((probability.success - 0.5).abs() < 1e-9 && probability.epistemic_fraction < 0.1, "{probability:?}");
    }
}
