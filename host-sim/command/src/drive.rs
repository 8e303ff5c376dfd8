//! `mindgap drive`: one run of the built-in robot under a controller or a script.

use std::path::{Path, PathBuf};

use clap::Args;
use schemars::JsonSchema;
use serde::Serialize;

use super::evolve::start_of;
use super::json_output::JsonOption;
use super::{Run, kinds, warn};
use mindgap_built_in_robot::{ActiveEffect, BuiltInRobot, Trajectory, default_robot, run_controller, run_script};
use mindgap_files::places::Places;
use mindgap_foundations::error::Result;
use mindgap_foundations::executor::Executor;
use mindgap_foundations::random::generator;
use mindgap_foundations::schema_number::SchemaNumber;
use mindgap_logs::Scene;
use mindgap_logs::controller_file::ControllerFile;
use mindgap_logs::range_sensor::ULTRASONIC;

/// Run a controller or a script on the built-in robot and log the run.
#[derive(Args)]
pub struct Drive {
    /// The controller file; or a script in CSV, with columns t_ms, left and right.
    #[arg(value_name = "CONTROLLER|SCRIPT.csv")]
    controller: PathBuf,
    /// The scene.
    #[arg(long, value_name = "FILE")]
    scene: PathBuf,
    /// Number of the start in the scene, from 1 (default: 1; for a script a place that has room for it).
    #[arg(long, value_name = "N")]
    start: Option<usize>,
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

/// Required columns of a script; it may have those of a log as well.
const SCRIPT_COLUMNS: [&str; 3] = ["t_ms", "left", "right"];

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
        let scene = Scene::read(&self.scene)?;
        let driven = if self.is_script() { self.scripted(&scene)? } else { self.controlled(&scene)? };
        driven.to_run("run").write(&self.out)?;
        let distance_cm = scene.target_cm.map(|target_cm| driven.end().position_cm.distance(target_cm));
        let distance = distance_cm.map_or_else(String::new, |cm| format!(", {cm:.1} cm from the target"));
        // After a script nothing coasts: its last row is at rest.
        let steps = if self.is_script() { driven.points.len() - 1 } else { driven.steps() };
        let ending = driven.termination.to_string();
        let text = format!("{}: {ending} after {steps} steps{distance}\n", self.out.display());
        let results = DriveResults { schema: SchemaNumber, run: &self.out, ending, steps, distance_cm };
        self.json.emit_sorted(&results, text)
    }
}

impl Drive {
    fn is_script(&self) -> bool {
        self.controller.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("csv"))
    }

    fn controlled(&self, scene: &Scene) -> Result<Trajectory> {
        let file = ControllerFile::read(&self.controller)?;
        file.check_asks(ULTRASONIC).map_err(|error| error.or_in_file(&self.controller))?;
        let controller = file.controller;
        let robot = default_robot();
        let start = start_of(scene, self.start.unwrap_or(1), &robot, &self.scene)?;
        let built_in = BuiltInRobot::new(&robot, scene, &self.effects);
        Ok(run_controller(&built_in, &controller, start, &mut generator(self.seed, &[])))
    }

    fn scripted(&self, scene: &Scene) -> Result<Trajectory> {
        let script = mindgap_logs::Run::read_with(&self.controller, &SCRIPT_COLUMNS, warn)?;
        let robot = default_robot();
        let start = self.start.map(|number| start_of(scene, number, &robot, &self.scene)).transpose()?;
        let driven = run_script(&robot, scene, &self.effects, &script, start, self.seed);
        driven.map_err(|error| error.or_in_file(&self.scene))
    }
}
