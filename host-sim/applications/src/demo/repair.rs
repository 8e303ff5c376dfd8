//! The last stage: the robot has changed since its logs were recorded, its controllers fail, and the loop finds the cause
//! and a controller that works.

use std::path::Path;

use mindgap_core::controller::Controller;

use super::robot::TrialledRobot;
use crate::closed_loop::state::State;
use crate::closed_loop::{self, Event};
use mindgap_built_in_robot::{self as built_in_robot, ActiveEffect, BuiltInRobot, Effect};
use mindgap_foundations::error::Result;
use mindgap_foundations::executor::Executor;
use mindgap_foundations::random::generator;
use mindgap_learning::evolve::fitness::Success;
use mindgap_logs::Scene;
use mindgap_logs::controller_file::ControllerFile;

/// Number of runs to measure success on the changed robot.
const RUNS: u64 = 5;
/// Stream keys of the runs before and after the loop.
const BEFORE: u64 = 0;
const AFTER: u64 = 1;

/// Parameters of the loop.
pub struct Job {
    /// Number of the start, from 1.
    pub start: usize,
    /// Maximum number of steps of a controller.
    pub max_steps: u16,
    /// Maximum number of runs on the robot.
    pub trials: usize,
    /// Random seed.
    pub seed: u64,
}

/// Result of the loop.
pub struct Repair {
    /// The injected fault.
    pub changed: ActiveEffect,
    /// Number of the start, from 1.
    pub start: usize,
    /// Success of the original controller on the changed robot.
    pub before: Success,
    /// Final state of the loop.
    pub state: State,
    /// Success of the loop's final controller on the changed robot.
    pub after: Success,
}

/// Weakens a motor and runs the loop, starting from `controllers`. The folder contains `simulator.json` and `scene.toml`;
/// the loop's folder is `loop` within it.
///
/// # Errors
/// If a file cannot be read or written.
pub fn run(
    executor: &dyn Executor,
    folder: &Path,
    controllers: &[Controller],
    &Job { start, max_steps, trials, seed }: &Job,
    mut watch: impl FnMut(usize),
) -> Result<Repair> {
    let [simulator, scene_file] = ["simulator.json", "scene.toml"].map(|name| folder.join(name));
    let scene = Scene::read(&scene_file)?;
    let changed = ActiveEffect::new(Effect::MotorAsymmetry);
    let robot = BuiltInRobot::new(&built_in_robot::default_robot(), &scene, &[changed]);
    let success = |controller: &Controller, when: u64| {
        let drive = |run| {
            let rng = &mut generator(seed, &[when, run]);
            built_in_robot::run_controller(&robot, controller, scene.starts[start - 1], rng)
        };
        super::success((0..RUNS).map(drive), scene.target_cm.unwrap_or_default())
    };
    let job = closed_loop::Job {
        executor,
        folder: &folder.join("loop"),
        simulator: &simulator,
        scene: &scene_file,
        start,
        trials,
        max_steps,
        known: controllers,
        seed,
    };
    let state = closed_loop::run(&job, &mut TrialledRobot(vec![changed]), |event| {
        if let Event::Driving(trial) = event {
            watch(trial.number);
        }
    })?;
    let settled = ControllerFile::read(&job.folder.join("controller.toml"))?.controller;
    let before = controllers.first().map_or_else(Success::default, |controller| success(controller, BEFORE));
    Ok(Repair { changed, start, before, state, after: success(&settled, AFTER) })
}
