//! A controller tried in a simulator: each run is of another robot that the simulator's logs leave possible.

use mindgap_core::controller::Controller;

use super::chance::ROBOTS;
use mindgap_foundations::error::{Error, Result};
use mindgap_foundations::geometry::Pose;
use mindgap_logs::Scene;
use mindgap_models::simulator::environment::{Environment, SensorModel};
use mindgap_models::simulator::rollout_report::RolloutReport;
use mindgap_models::simulator::{Noise, Simulator};

/// What is asked.
pub struct Trial<'a> {
    /// Where it is tried.
    pub simulator: &'a Simulator,
    /// What is tried.
    pub controller: &'a Controller,
    /// In this scene,
    pub scene: &'a Scene,
    /// from here.
    pub start: Pose,
    /// What scatters.
    pub noise: Noise,
    /// What makes the readings, where more scatters than in the paper.
    pub sensor: SensorModel,
    /// How many runs.
    pub runs: usize,
    /// Seed of all draws.
    pub seed: u64,
}

impl Trial<'_> {
    /// Runs it; `watch` is told how many of the runs are done.
    ///
    /// # Errors
    /// When there are no runs, when the simulator cannot run controllers, or has no first-echo law where it is asked for.
    pub fn run(&self, watch: impl Fn(usize, usize) + Sync) -> Result<RolloutReport> {
        let Trial { simulator, controller, scene, start, noise, sensor, runs, seed } = *self;
        if runs == 0 {
            return Err(Error::new("there must be at least one run"));
        }
        let open = if noise == Noise::Learned { simulator.robots(runs.min(ROBOTS), seed) } else { None };
        let drawn = open.map(|robots| robots.drawn);
        let robots = match &drawn {
            Some(drawn) => Environment::of_robots(simulator, drawn, scene, start)?,
            None => vec![Environment::new(simulator, scene, start, noise)?],
        };
        let robots: Result<Vec<_>> =
            robots.into_iter().map(|robot| robot.sensing_by(sensor, simulator, scene)).collect();
        Ok(RolloutReport::of_robots(&robots?, scene, controller, runs, seed, watch))
    }
}
