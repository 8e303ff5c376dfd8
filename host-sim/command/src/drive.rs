//! `mindgap drive`: one run of the built-in robot under a controller.

use std::path::PathBuf;

use clap::Args;
use serde_json::json;

use super::evolve::start_of;
use super::facts::FactsOption;
use super::{Run, kinds};
use mindgap_built_in_robot::{ActiveEffect, BuiltInRobot, Termination, default_robot, run_controller};
use mindgap_files::places::Places;
use mindgap_foundations::error::Result;
use mindgap_foundations::random::generator;
use mindgap_learning::evolve::controller_file::ControllerFile;
use mindgap_logs::Scene;

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
    #[command(flatten)]
    facts: FactsOption,
}

impl Run for Drive {
    fn places(&self) -> Places {
        let places = Places::default().reading([&self.controller, &self.scene]).writing([&self.out], kinds::UNSIGNED);
        places.writing(self.facts.asked(), kinds::REPORT)
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
        let distance_cm = scene.target_cm.map(|target_cm| driven.end().position_cm.distance(target_cm));
        let distance = distance_cm.map_or_else(String::new, |cm| format!(", {cm:.1} cm from the target"));
        let (how, steps) = (ending(driven.termination), driven.steps());
        let facts = json!({"schema": 1, "run": self.out, "ending": how, "steps": steps, "distance_cm": distance_cm});
        let text = format!("{}: {how} after {steps} steps{distance}\n", self.out.display());
        self.facts.told(&facts, text)
    }
}

fn ending(how: Termination) -> &'static str {
    match how {
        Termination::Finished => "finished",
        Termination::TimedOut => "timed out",
        Termination::Crashed => "crashed",
    }
}
