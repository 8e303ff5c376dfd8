//! `mindgap record`: random-command logs of the built-in robot.

use std::path::{Path, PathBuf};

use clap::Args;
use schemars::JsonSchema;
use serde::Serialize;

use super::json_output::JsonOption;
use super::table::count;
use super::{Run, kinds};
use mindgap_built_in_robot::{ActiveEffect, Driving, Effect, default_robot, record_driving, training_room};
use mindgap_files::places::Places;
use mindgap_foundations::error::Result;
use mindgap_foundations::executor::Executor;
use mindgap_foundations::schema_number::SchemaNumber;
use mindgap_logs::Scene;

/// Record random-command logs of the built-in robot.
#[derive(Args)]
#[command(after_help = effects_help())]
pub struct Record {
    /// Folder to write the logs to.
    #[arg(long, value_name = "LOGS")]
    out: PathBuf,
    /// Scene to drive in (default: a room with four obstacles).
    #[arg(long, value_name = "FILE")]
    scene: Option<PathBuf>,
    /// Number of runs.
    #[arg(long, value_name = "N", default_value_t = 100, value_parser = clap::value_parser!(u32).range(1..=999))]
    runs: u32,
    /// Steps per run.
    #[arg(long, value_name = "N", default_value_t = 60, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    steps: u32,
    /// In every third run, hold each command for up to this many steps, as controllers do (default: at most 3 steps).
    #[arg(long, value_name = "STEPS", value_parser = clap::value_parser!(u32).range(4..=100_000))]
    hold: Option<u32>,
    /// Fault to inject; repeatable.
    #[arg(long = "effect", value_name = "ID[=STRENGTH[@DETAIL]]")]
    effects: Vec<ActiveEffect>,
    /// Random seed.
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    #[command(flatten)]
    json: JsonOption,
}

/// Results of `mindgap record`.
#[derive(Serialize, JsonSchema)]
pub struct RecordResults<'a> {
    /// Version of the JSON.
    schema: SchemaNumber<1>,
    /// Folder of the logs.
    logs: &'a Path,
    /// Number of runs.
    runs: u32,
    /// Number of steps per run.
    steps: u32,
    /// Time between two rows, ms.
    step_ms: f64,
    /// Random seed.
    seed: u64,
    /// Injected faults, as ID=STRENGTH@DETAIL.
    effects: Vec<String>,
}

impl Run for Record {
    fn places(&self) -> Places {
        Places::default().reading(&self.scene).filling([&self.out]).writing(self.json.path(), kinds::REPORT)
    }

    fn run(&self, _: &dyn Executor) -> Result<String> {
        let scene = match &self.scene {
            Some(path) => Scene::read(path)?,
            None => training_room(),
        };
        let driving = self.hold.map_or(Driving::MIXED, |longest| Driving::MIXED.holding(longest as usize));
        let amount = [self.runs, self.steps].map(|count| count as usize);
        let logs = record_driving(&driving, &default_robot(), &scene, amount, &self.effects, self.seed)
            .map_err(|error| self.scene.iter().fold(error, |p, scene| p.or_in_file(scene)))?;
        logs.write(&self.out)?;
        let results = RecordResults {
            schema: SchemaNumber,
            logs: &self.out,
            runs: self.runs,
            steps: self.steps,
            step_ms: logs.robot.step_ms,
            seed: self.seed,
            effects: self.effects.iter().map(ToString::to_string).collect(),
        };
        let text = format!("{}: {} of {} steps\n", self.out.display(), count(amount[0], "run"), self.steps);
        self.json.emit_sorted(&results, text)
    }
}

/// Returns the list of effects, each with its unit and default.
fn effects_help() -> String {
    let lines = Effect::all().map(|effect| {
        let strength = effect.strength_range();
        let place = if effect.in_table() { "" } else { " (unknown to the diagnosis)" };
        let about = effect.about();
        let detail = effect.detail_range().map_or(String::new(), |d| format!("; @ {}, default {}", d.unit, d.default));
        let range = format!("{} to {}, default {}", strength.lowest, strength.highest, strength.default);
        format!("  {:<20} {about}{place}\n  {:<20} {}: {range}{detail}", effect.id(), "", strength.unit)
    });
    format!("Effects:\n{}", lines.collect::<Vec<_>>().join("\n"))
}
