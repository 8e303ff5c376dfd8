//! Cases with known effects, generated on demand, to fit and test thresholds.

use super::answer::learn;
use super::cases::{self, Case, Echoes, Outside, Setting, Size};
use mindgap_built_in_robot::Effect;
use mindgap_foundations::error::Result;
use mindgap_foundations::executor::{self, Executor};
use mindgap_logs::Logs;
use mindgap_models::simulator::Simulator;
use mindgap_models::simulator::baseline::Baseline;

/// Cases and the simulators of their robots.
pub struct Bench {
    seed: u64,
    setting: Setting,
    robots: Vec<Logs>,
    simulators: Vec<Simulator>,
    /// Effects of each case.
    pub effects: Vec<Vec<Effect>>,
}

impl Bench {
    /// Generates the robots of a seed and trains a simulator on the logs of each.
    ///
    /// # Errors
    /// If a robot has no room to drive in, or its logs do not suffice for training.
    pub fn new(executor: &dyn Executor, count: usize, seed: u64, size: Size) -> Result<Self> {
        let setting = Setting { outside: OUTSIDE, echoes: Echoes::Fresh, size };
        let robots = cases::robots(seed, setting)?;
        let simulators = executor::map(executor, robots.len(), |robot| learn(executor, &robots[robot]))?;
        Ok(Bench { seed, setting, robots, simulators, effects: effects(count, seed) })
    }

    /// Records a case and returns it with the baseline of its robot.
    ///
    /// # Errors
    /// If the robot hits something in every room.
    pub fn case(&self, number: usize) -> Result<(Case, Baseline<'_>)> {
        let case = cases::case(number, &self.effects[number], &self.robots, self.setting, self.seed)?;
        let baseline = Baseline::at_posterior_mean(&self.simulators[case.robot])?;
        Ok((case, baseline))
    }
}

/// The held-out effects stay unseen.
const OUTSIDE: Outside = Outside::Usual;

/// Returns the effects of the cases.
fn effects(count: usize, seed: u64) -> Vec<Vec<Effect>> {
    cases::effects(count, seed, OUTSIDE)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_case_has_a_held_out_effect() {
        let drawn: Vec<Effect> = (0..1000).flat_map(|seed| effects(200, seed)).flatten().collect();
        assert!(drawn.contains(&Effect::SonarDrift), "effects outside the table are drawn");
        assert!(!drawn.iter().any(|effect| matches!(effect, Effect::HeldOut(_))));
    }
}
