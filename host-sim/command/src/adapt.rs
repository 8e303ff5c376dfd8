//! `mindgap adapt`

use std::path::PathBuf;

use clap::Args;
use schemars::JsonSchema;
use serde::Serialize;

use super::json_output::JsonOption;
use super::table::{self, number};
use super::{Run, kinds, progress, textbook};
use mindgap_applications::adapt::{Adapted, CommandBias, Gap, Lesson, adapt};
use mindgap_diagnosis::Method;
use mindgap_diagnosis::progress::Stage;
use mindgap_files::places::Places;
use mindgap_foundations::error::{Error, Result};
use mindgap_foundations::executor::Executor;
use mindgap_foundations::schema_number::SchemaNumber;
use mindgap_learning::evolve::success_probability::{Judge, ROBOTS, RUNS, SuccessProbability};
use mindgap_logs::Scene;
use mindgap_logs::controller_file::ControllerFile;
use mindgap_models::simulator::Simulator;

/// Adapt a simulator to runs of the robot.
///
/// Effects that the diagnosis names are added to the simulator; what remains is learned as a correction per command. The
/// networks themselves stay as they are.
#[derive(Args)]
pub struct Adapt {
    /// The simulator file.
    sim: PathBuf,
    /// Folders of logs.
    #[arg(required = true)]
    logs: Vec<PathBuf>,
    /// The simulator file to write.
    #[arg(long, value_name = "SIM")]
    out: PathBuf,
    /// Also report this controller's success probability before and after.
    #[arg(long, requires = "scene")]
    controller: Option<PathBuf>,
    /// Scene of the controller.
    #[arg(long, value_name = "FILE")]
    scene: Option<PathBuf>,
    /// Number of the start in the scene, from 1.
    #[arg(long, value_name = "N", default_value_t = 1)]
    start: usize,
    /// Random seed.
    #[arg(long, value_name = "N", default_value_t = Method::SEED)]
    seed: u64,
    #[command(flatten)]
    json: JsonOption,
}

/// Maximum number of commands in the table.
const COMMANDS: usize = 8;

/// Results of `mindgap adapt`.
#[derive(Serialize, JsonSchema)]
pub struct AdaptResults {
    /// Version of the JSON.
    schema: SchemaNumber<1>,
    /// One lesson per folder of logs.
    lessons: Vec<Lesson>,
    /// Success probability of the controller, before and after; null without a controller.
    chance: Option<[SuccessProbability; 2]>,
}

impl Run for Adapt {
    fn places(&self) -> Places {
        let inputs = [&self.sim].into_iter().chain(&self.logs).chain(&self.controller).chain(&self.scene);
        Places::default()
            .reading(inputs)
            .writing([&self.out], kinds::SIMULATOR)
            .writing(self.json.path(), kinds::REPORT)
    }

    fn run(&self, executor: &dyn Executor) -> Result<String> {
        let given = textbook::simulator(&self.sim)?;
        let mut simulator = given.clone();
        let mut lessons = Vec::new();
        let bar = progress::shares();
        for (folder, before) in self.logs.iter().zip(0..) {
            let logs = super::read_sound_logs(folder)?;
            let watch = |stage: Stage| {
                let share = (f64::from(before) + stage.share_before()) / self.logs.len() as f64;
                progress::at(&bar, share, format!("{}: {}", folder.display(), stage.words()));
            };
            let adapted = adapt(&simulator, &logs, self.seed, watch).map_err(|error| error.or_in_file(folder))?;
            let Adapted { simulator: better, lesson, .. } = adapted;
            simulator = better;
            lessons.push(lesson);
        }
        bar.finish_and_clear();
        let chance = match (&self.controller, &self.scene) {
            (Some(_), Some(_)) => Some([self.chance(executor, &given)?, self.chance(executor, &simulator)?]),
            _ => None,
        };
        simulator.write(&self.out)?;
        let of_folder = |(logs, lesson): (&PathBuf, &Lesson)| format!("{}:\n{}", logs.display(), describe(lesson));
        let mut text: String = self.logs.iter().zip(&lessons).map(of_folder).collect();
        if let Some([before, after]) = &chance {
            text += &format!("success probability of the controller: {before} before, {after} after\n");
        }
        text += &format!("simulator written to {}\n", self.out.display());
        self.json.emit(&AdaptResults { schema: SchemaNumber, lessons, chance }, text)
    }
}

impl Adapt {
    /// Returns the controller's success probability over the simulator's posterior of robots.
    fn chance(&self, executor: &dyn Executor, simulator: &Simulator) -> Result<SuccessProbability> {
        let (Some(controller), Some(path)) = (&self.controller, &self.scene) else {
            return Err(Error::new("--controller needs --scene"));
        };
        let file = ControllerFile::read(controller)?;
        file.check_asks(simulator.first_sensor()).map_err(|error| error.or_in_file(controller))?;
        let controller = file.controller;
        let scene = Scene::read(path)?;
        let start = super::evolve::start_of(&scene, self.start, &simulator.robot, path)?;
        let target_cm = scene.target_cm.ok_or_else(|| Error::in_file(path, "has no [target]"))?;
        let robots = simulator.robots(ROBOTS, self.seed);
        let robots = robots.ok_or_else(|| Error::in_file(&self.sim, "has no parameter uncertainty: train it again"))?;
        let judge = Judge::new(executor, simulator, &robots.drawn, &scene, start, target_cm, self.seed)?;
        Ok(judge.success_probabilities(&[controller], RUNS)?[0])
    }
}

fn describe(lesson: &Lesson) -> String {
    let mut text = String::new();
    for effect in &lesson.effects {
        let parameters: Vec<String> =
            effect.parameters.iter().map(|(name, value)| format!("{name} {value:.3}")).collect();
        text += &format!("  effect added: {}: {}\n", effect.effect, parameters.join(", "));
    }
    for cause in &lesson.causes {
        let used = if cause.used { "" } else { ", not used: biases of commands predict the runs better" };
        let rivals = if cause.ambiguous_with.is_empty() {
            String::new()
        } else {
            format!(", not distinguished from {}", cause.ambiguous_with.join(", "))
        };
        text += &format!("  {}: probability {:.0} %{rivals}{used}\n", cause.id, 100.0 * cause.probability);
    }
    text += "  correction per step for each held command (left, right), mean ± SD:\n";
    let rows: Vec<[String; 5]> = lesson.commands.iter().take(COMMANDS).map(row).collect();
    text += &table::text(["command", "steps", "forward (cm)", "left (cm)", "turn (deg)"], &rows);
    if let Some(Gap { forward_cm, lateral_cm, turn_deg }) = &lesson.gap {
        let pair = |[before, after]: &[f64; 2]| format!("{before:.2} to {after:.2}");
        text += &format!(
            "  error per step on held-out runs: forward {} cm, left {} cm, turn {} deg\n",
            pair(forward_cm),
            pair(lateral_cm),
            pair(turn_deg)
        );
    }
    text
}

/// Formats the correction of one command as a row of the table.
fn row(known: &CommandBias) -> [String; 5] {
    let [left, right] = known.command;
    let [forward, lateral, turn] = known
        .before
        .zip_with(known.after, |[before, _], [after, sd]| format!("{} ±{sd:.2}", number(Some(after - before), 2)))
        .into_array();
    [format!("{left} {right}"), known.steps.to_string(), forward, lateral, turn]
}
