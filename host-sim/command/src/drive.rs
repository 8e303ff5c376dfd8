//! `mindgap drive`: one run of the built-in robot under a controller.

use std::path::PathBuf;

use clap::Args;
use serde_json::json;

use super::evolve::start_of;
use super::json_output::JsonOption;
use super::{Run, kinds};
use mindgap_built_in_robot::{ActiveEffect, BuiltInRobot, default_robot, run_controller};
use mindgap_files::places::Places;
use mindgap_foundations::error::Result;
use mindgap_foundations::executor::Executor;
use mindgap_foundations::random::generator;
use mindgap_logs::Scene;
use mindgap_logs::controller_file::ControllerFile;

/// Run a controller on the built-in robot and log the run.
#[derive(Args)]
pub struct Drive {
    /// The controller file.
    controller: PathBuf,
    /// The scene.
    #[arg(long, value_name = "FILE")]
    scene: PathBuf,
    /// Number of the start in the scene, from 1.
    #[arg(long, value_name = "N", default_value_t = 1)]
    start: usize,
    /// Random seed.
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Fault to inject; repeatable. `mindgap record --help` lists them.
    #[arg(long = "effect", value_name = "ID[=STRENGTH[@DETAIL]]")]
    effects: Vec<ActiveEffect>,
    /// Log to write.
    #[arg(long, value_name = "RUN.csv")]
    out: PathBuf,
    #[command(flatten)]
    json: JsonOption,
}

impl Run for Drive {
    fn places(&self) -> Places {
        let places = Places::default().reading([&self.controller, &self.scene]).writing([&self.out], kinds::UNSIGNED);
        places.writing(self.json.path(), kinds::REPORT)
    }

    fn run(&self, _: &dyn Executor) -> Result<String> {
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
        let (how, steps) = (driven.termination.to_string(), driven.steps());
        let results = json!({"schema": 1, "run": self.out, "ending": how, "steps": steps, "distance_cm": distance_cm});
        let text = format!("{}: {how} after {steps} steps{distance}\n", self.out.display());
        self.json.emit(&results, text)
    }
}
