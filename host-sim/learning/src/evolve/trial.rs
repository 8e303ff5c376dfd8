//! Simulated trials of a controller: each run samples a robot from the posterior of the simulator.

use mindgap_core::controller::Controller;

use super::success_probability::ROBOTS;
use mindgap_foundations::error::{Error, Result};
use mindgap_foundations::geometry::Pose;
use mindgap_logs::Scene;
use mindgap_models::simulator::environment::{Environment, SensorModel};
use mindgap_models::simulator::rollout_report::RolloutReport;
use mindgap_models::simulator::{Noise, Simulator};

/// A request to run a controller in a simulator.
pub struct Trial<'a> {
    /// The simulator in which it runs.
    pub simulator: &'a Simulator,
    /// The controller.
    pub controller: &'a Controller,
    /// Scene of the runs.
    pub scene: &'a Scene,
    /// Pose at which they start.
    pub start: Pose,
    /// The noise of the simulated robot.
    pub noise: Noise,
    /// The model of the sensor, unless the noise is that of the paper.
    pub sensor: SensorModel,
    /// Number of runs.
    pub runs: usize,
    /// Seed of all draws.
    pub seed: u64,
}

impl Trial<'_> {
    /// Runs the controller; `watch` receives the number of finished runs and of all runs.
    ///
    /// # Errors
    /// If `runs` is 0, if the simulator cannot run controllers, or if it lacks a first-echo law that `sensor` needs.
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
