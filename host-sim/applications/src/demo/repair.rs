//! The last stage: the robot has changed since its logs were recorded, its controllers fail, and the loop finds out what
//! is wrong and repairs it.

use std::path::Path;

use mindgap_core::controller::Controller;

use super::robot::TrialledRobot;
use crate::trials::state::State;
use crate::trials::{self, Event};
use mindgap_built_in_robot::{self as built_in_robot, ActiveEffect, BuiltInRobot, Effect};
use mindgap_foundations::error::Result;
use mindgap_foundations::random::generator;
use mindgap_learning::evolve::controller_file::ControllerFile;
use mindgap_learning::evolve::fitness::Success;
use mindgap_logs::Scene;

/// Runs that tell how a controller does on the changed robot.
const RUNS: u64 = 5;
/// Stream keys of the runs before and after the loop.
const BEFORE: u64 = 0;
const AFTER: u64 = 1;

/// What the loop is given besides.
pub struct Job {
    /// Start of the controllers, from 1.
    pub start: usize,
    /// Steps after which a controller gives up.
    pub max_steps: u16,
    /// Runs on the robot that it may have.
    pub trials: usize,
    /// Seed of all draws.
    pub seed: u64,
}

/// What the loop came to.
pub struct Repair {
    /// What is different about the robot.
    pub changed: ActiveEffect,
    /// Start of the controllers, from 1.
    pub start: usize,
    /// Success on the robot of the controller that was evolved for it as it was.
    pub before: Success,
    /// What happened.
    pub state: State,
    /// Success on the robot of the controller that the loop settled on.
    pub after: Success,
}

/// Lets the loop repair what a weak motor does to the first of some `controllers` for a start. The folder holds
/// `simulator.json` and `scene.toml`, and receives `loop`.
///
/// # Errors
/// When a file cannot be read or written.
pub fn run(
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
    let job = trials::Job {
        folder: &folder.join("loop"),
        simulator: &simulator,
        scene: &scene_file,
        start,
        trials,
        max_steps,
        known: controllers,
        seed,
    };
    let state = trials::run(&job, &mut TrialledRobot(vec![changed]), |event| {
        if let Event::Driving(trial) = event {
            watch(trial.number);
        }
    })?;
    let settled = ControllerFile::read(&job.folder.join("controller.toml"))?.controller;
    let before = controllers.first().map_or_else(Success::default, |controller| success(controller, BEFORE));
    Ok(Repair { changed, start, before, state, after: success(&settled, AFTER) })
}
