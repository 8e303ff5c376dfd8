//! `mindgap drive`: one run of the built-in robot under a controller.

use std::path::PathBuf;

use clap::Args;

use super::evolve::start_of;
use super::{Run, kinds};
use crate::built_in_robot::{ActiveEffect, BuiltInRobot, Termination, Trajectory, default_robot, run_controller};
use crate::chance::generator;
use crate::error::Result;
use crate::evolve::controller_file::ControllerFile;
use crate::files::places::Places;
use crate::logs::Scene;

/// Drive a controller on the built-in robot and log the run.
#[derive(Args)]
pub struct Drive {
    /// The controller file.
    controller: PathBuf,
    /// The scene.
    #[arg(long, value_name = "FILE")]
    scene: PathBuf,
    /// Which of the scene's starts, from 1.
    #[arg(long, value_name = "N", default_value_t = 1)]
    start: usize,
    /// Fixes every draw.
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// What is different about the robot; may be given again. `mindgap record --help` lists what.
    #[arg(long = "effect", value_name = "ID[=STRENGTH[@DETAIL]]")]
    effects: Vec<ActiveEffect>,
    /// The log to write.
    #[arg(long, value_name = "RUN.csv")]
    out: PathBuf,
}

impl Run for Drive {
    fn places(&self) -> Places {
        Places::default().reading([&self.controller, &self.scene]).writing([&self.out], kinds::UNSIGNED)
    }

    fn run(&self) -> Result<String> {
        let controller = ControllerFile::read(&self.controller)?.controller;
        let scene = Scene::read(&self.scene)?;
        let robot = default_robot();
        let start = start_of(&scene, self.start, &robot, &self.scene)?;
        let driven = run_controller(
            &BuiltInRobot::new(&robot, &scene, &self.effects),
            &controller,
            start,
            &mut generator(self.seed, &[]),
        );
        driven.to_run("run").write(&self.out)?;
        Ok(format!("{}: {}{}\n", self.out.display(), ending(&driven), distance(&driven, &scene)))
    }
}

fn ending(driven: &Trajectory) -> String {
    let steps = driven.points.len() - 1;
    let how = match driven.termination {
        Termination::Finished => "finished",
        Termination::TimedOut => "timed out",
        Termination::Crashed => "crashed",
    };
    format!("{how} after {steps} steps")
}

/// How far from the target it came to rest, where the scene has one.
fn distance(driven: &Trajectory, scene: &Scene) -> String {
    let end_cm = driven.end().position_cm;
    scene
        .target_cm
        .map_or_else(String::new, |target_cm| format!(", {:.1} cm from the target", end_cm.distance(target_cm)))
}
