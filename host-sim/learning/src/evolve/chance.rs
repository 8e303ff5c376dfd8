//! How often a controller reaches the target, as far as that is known: over robots drawn from what the simulator leaves
//! open, each with its own chance.

use std::fmt;

use glam::DVec2;
use mindgap_core::controller::Controller;
use serde::{Deserialize, Serialize};

use mindgap_foundations::error::Result;
use mindgap_foundations::geometry::Pose;
use mindgap_foundations::random::derive;
use mindgap_logs::Scene;
use mindgap_models::simulator::Simulator;
use mindgap_models::simulator::ensemble::Member;
use mindgap_models::simulator::environment::Environment;
use mindgap_models::simulator::rollout::{RolloutOutcome, RolloutRequest};
use mindgap_workers as workers;

/// Robots that tell how far a controller's chance is known.
pub const ROBOTS: usize = 48;
/// Runs on each for a chance that is told.
pub const RUNS: usize = 12;

/// The chance of success of a controller.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Chance {
    /// Over all robots, 0..=1.
    pub success: f64,
    /// What the chances of 95 % of the robots lie between.
    pub ci95: [f64; 2],
    /// Share of the variance of one run's success that is between robots: not knowing, where the rest is chance.
    pub not_knowing: f64,
}

/// Robots that controllers are judged on.
pub struct Judge<'a> {
    robots: Vec<Environment<'a>>,
    target_cm: DVec2,
    seed: u64,
}

impl<'a> Judge<'a> {
    /// Of these robots, in a scene with a target, from a start. The same seed gives all controllers the same runs.
    ///
    /// # Errors
    /// As [`Environment::new`].
    pub fn new(
        simulator: &'a Simulator,
        members: &'a [Member],
        scene: &Scene,
        start: Pose,
        target_cm: DVec2,
        seed: u64,
    ) -> Result<Self> {
        Ok(Judge { robots: Environment::of_robots(simulator, members, scene, start)?, target_cm, seed })
    }

    /// The chance of each controller in `runs` runs of every robot.
    ///
    /// # Errors
    /// When it cannot be computed by those to whom it is handed out.
    pub fn chances(&self, controllers: &[Controller], runs: usize) -> Result<Vec<Chance>> {
        let by_robot = self.successes(controllers, runs)?;
        let of = |controller: usize| by_robot.iter().map(|robot| share(&robot[controller])).collect();
        Ok((0..controllers.len()).map(|controller| Chance::of(of(controller), runs)).collect())
    }

    /// The chance of success if the robot were known: on each robot that of the controller which does best there. One half
    /// of `runs` runs each chooses and the other one tells, since a chance by which one has chosen is too good.
    ///
    /// # Errors
    /// As [`chances`](Self::chances).
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

    /// Of every robot, and there of every controller, which runs reach the target.
    fn successes(&self, controllers: &[Controller], runs: usize) -> Result<Vec<Vec<Vec<bool>>>> {
        let of_robot = |number: usize| Ok(self.successes_on(number, &self.robots[number], controllers, runs));
        workers::map(self.robots.len(), of_robot)
    }

    fn successes_on(
        &self,
        number: usize,
        robot: &Environment,
        controllers: &[Controller],
        runs: usize,
    ) -> Vec<Vec<bool>> {
        let motions: Vec<_> = controllers.iter().map(|controller| robot.motions(controller)).collect();
        let mut requests = Vec::with_capacity(controllers.len() * runs);
        for (controller, motions) in controllers.iter().zip(&motions) {
            requests.extend((0..runs).map(|run| RolloutRequest {
                controller,
                motions,
                seed: derive(self.seed, &[number as u64, run as u64]),
            }));
        }
        let outcomes = robot.run(&requests);
        let reached = |of_one: &[RolloutOutcome]| of_one.iter().map(|o| o.reached(self.target_cm)).collect();
        outcomes.chunks(runs).map(reached).collect()
    }
}

/// Share of the runs that reach the target.
fn share(reached: &[bool]) -> f64 {
    reached.iter().filter(|reached| **reached).count() as f64 / reached.len() as f64
}

/// In percent, with the range of the robots.
impl fmt::Display for Chance {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [success, low, high] = [self.success, self.ci95[0], self.ci95[1]].map(|share| 100.0 * share);
        write!(f, "{success:.0} % ({low:.0} to {high:.0})")
    }
}

impl Chance {
    /// From the success rates of robots in `runs` runs each.
    fn of(mut rates: Vec<f64>, runs: usize) -> Self {
        rates.sort_by(f64::total_cmp);
        let count = rates.len() as f64;
        let success = rates.iter().sum::<f64>() / count;
        let spread = rates.iter().map(|rate| (rate - success) * (rate - success)).sum::<f64>() / (count - 1.0).max(1.0);
        let whole = success * (1.0 - success);
        // Rates of few runs scatter where all robots have one chance.
        let runs = runs as f64;
        let between = if runs > 1.0 { (runs * spread - whole) / (runs - 1.0) } else { 0.0 };
        let at = |share: f64| rates[((count - 1.0) * share).round() as usize];
        let not_knowing = if whole > 0.0 { (between / whole).clamp(0.0, 1.0) } else { 0.0 };
        Chance { success, ci95: [at(0.025), at(0.975)], not_knowing }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evolve::genome::GenotypeDecoder;
    use crate::evolve::test_support::SIMULATOR;
    use mindgap_built_in_robot::four_obstacles;
    use mindgap_foundations::random::generator;

    const SEED: u64 = 5;

    #[test]
    fn a_robot_that_is_known_gets_the_controller_that_is_best_for_it() {
        let (scene, robots) = (four_obstacles(), SIMULATOR.robots(12, SEED).expect("robots"));
        let start = scene.starts[0];
        // Some of what drives at random gets there.
        let target_cm = start.position_cm + DVec2::new(25.0, 0.0);
        let judge = Judge::new(&SIMULATOR, &robots.drawn, &scene, start, target_cm, SEED).expect("room");
        let decoder = GenotypeDecoder::new(&SIMULATOR, 60);
        let controllers: Vec<Controller> =
            (0..300).map(|number| decoder.controller(&decoder.random(&mut generator(SEED, &[number])))).collect();
        let chances = judge.chances(&controllers, 4 * RUNS).expect("chances");
        let uncertain: Vec<usize> =
            (0..300).filter(|number| (0.1..0.9).contains(&chances[*number].success)).take(5).collect();
        assert_eq!(uncertain.len(), 5);
        let known = |numbers: &[usize]| {
            let some: Vec<Controller> = numbers.iter().map(|number| controllers[*number].clone()).collect();
            judge.if_known(&some, 4 * RUNS).expect("a chance")
        };
        let never = (0..300).find(|number| chances[*number].success == 0.0).expect("one that does not get there");
        for number in &uncertain {
            assert!((known(&[*number]) - chances[*number].success).abs() < 1e-9);
            assert!((known(&[*number, never]) - chances[*number].success).abs() < 0.05);
        }
        let best = uncertain.iter().map(|number| chances[*number].success).fold(0.0, f64::max);
        assert!(known(&uncertain) > best - 0.1 && known(&uncertain) <= 1.0, "{} of {best}", known(&uncertain));
    }

    #[test]
    fn robots_that_always_or_never_succeed_are_not_known_and_coins_are_chance() {
        let split: Vec<f64> = (0..40).map(|robot| f64::from(robot % 2)).collect();
        let chance = Chance::of(split, 10);
        assert!(
            (chance.success - 0.5).abs() < 1e-9 && chance.not_knowing > 0.95 && chance.ci95 == [0.0, 1.0],
            "{chance:?}"
        );
        // As often as ten fair coins show heads.
        let coins = [0.2, 0.3, 0.4, 0.4, 0.5, 0.5, 0.6, 0.6, 0.7, 0.8].repeat(4);
        let chance = Chance::of(coins, 10);
        assert!((chance.success - 0.5).abs() < 1e-9 && chance.not_knowing < 0.1, "{chance:?}");
    }
}
