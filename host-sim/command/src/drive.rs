//! `mindgap drive`: one run of the built-in robot under a controller.

use std::path::{Path, PathBuf};

use clap::Args;
use schemars::JsonSchema;
use serde::Serialize;

use super::evolve::start_of;
use super::json_output::JsonOption;
use super::{Run, kinds};
use mindgap_built_in_robot::{ActiveEffect, BuiltInRobot, default_robot, run_controller};
use mindgap_files::places::Places;
use mindgap_foundations::error::Result;
use mindgap_foundations::executor::Executor;
use mindgap_foundations::random::generator;
use mindgap_foundations::schema_number::SchemaNumber;
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

/// Results of `mindgap drive`.
#[derive(Serialize, JsonSchema)]
pub struct DriveResults<'a> {
    /// Version of the JSON.
    schema: SchemaNumber<1>,
    /// The log of the run.
    run: &'a Path,
    /// How the run ended: `finished`, `timed out` or `crashed`.
    ending: String,
    /// Number of steps.
    steps: usize,
    /// Final distance from the target, cm; null in a scene without one.
    distance_cm: Option<f64>,
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
        let (ending, steps) = (driven.termination.to_string(), driven.steps());
        let text = format!("{}: {ending} after {steps} steps{distance}\n", self.out.display());
        let results = DriveResults { schema: SchemaNumber, run: &self.out, ending, steps, distance_cm };
        self.json.emit_sorted(&results, text)
    }
}
