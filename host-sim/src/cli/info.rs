//! `mindgap info`

use std::fs;
use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::Value;

use crate::effects::own;
use crate::error::{Error, Result};
use crate::evolve::controller_file::ControllerFile;
use crate::files;
use crate::files::places::Places;
use crate::logs::{Logs, Robot, Run, Scene};
use crate::simulator::Simulator;

/// Tell what a file or folder is, and what is in it.
#[derive(Args)]
pub struct Info {
    /// The file or folder.
    path: PathBuf,
}

/// What JSON files of other commands are, by keys that no other one has.
const REPORTS: &[(&str, &str)] = &[
    ("verdict", "a diagnosis: `mindgap diagnose --json`"),
    ("reached_within_cm", "simulated runs: `mindgap simulate --json`"),
    ("holds", "what logs hold: `mindgap check --json`"),
    ("tracks", "an import: `mindgap import --json`"),
    ("instructions", "a run of an onboard program: `mindgap brick --json`"),
    ("runs", "a comparison of fixed with floating point: `mindgap crosscheck --json`"),
    ("networks", "an evaluation: `mindgap evaluate --json`"),
];

/// What files are that nothing is read from again, by their endings.
const PRODUCTS: &[(&str, &str)] = &[
    ("html", "a page: open it in a browser"),
    ("svg", "a figure"),
    ("png", "a figure"),
    ("pdf", "a figure"),
    ("nxc", "an onboard program in NXC: compile it with nbc"),
    ("rxe", "an onboard program for an NXT: `mindgap brick` runs it"),
    ("rs", "an onboard program in Rust"),
    ("c", "an onboard program in C"),
    ("1", "a manual page: man -l shows it"),
];

impl super::Run for Info {
    fn places(&self) -> Places {
        Places::default().reading([&self.path])
    }

    fn run(&self) -> Result<String> {
        let path = self.path.as_path();
        let told = if path.is_dir() { folder(path)? } else { file(path)? };
        Ok(format!("{}: {told}\n", path.display()))
    }
}

fn folder(path: &Path) -> Result<String> {
    if !path.join("robot.toml").exists() {
        return Err(Error::in_file(path, "is a folder without robot.toml: no logs that mindgap reads"));
    }
    let logs = Logs::read(path, super::warn)?;
    let rows: usize = logs.runs.iter().map(|run| run.rows.len()).sum();
    let step_ms = logs.robot.step_ms;
    Ok(format!("logs of {} runs, {rows} rows, {step_ms} ms apart; `mindgap check` tells more", logs.runs.len()))
}

fn file(path: &Path) -> Result<String> {
    let ending = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    match ending.as_str() {
        "json" => json(path),
        "toml" => toml(path),
        "csv" => {
            let run = Run::read(path, super::warn)?;
            let seen = run.rows.iter().filter(|row| row.pose.is_some()).count();
            let heard = run.rows.iter().filter(|row| row.echo_cm.is_some()).count();
            Ok(format!("a run of {} rows, {seen} with a pose and {heard} with a reading", run.rows.len()))
        }
        _ => {
            let product = PRODUCTS.iter().find(|(other, _)| *other == ending);
            let (_, what) = product.ok_or_else(|| Error::in_file(path, "is nothing that mindgap writes or reads"))?;
            // That there is such a file is a part of the answer.
            fs::metadata(path).map_err(|e| Error::in_file(path, format!("cannot be read: {e}")))?;
            Ok((*what).into())
        }
    }
}

fn json(path: &Path) -> Result<String> {
    let value: Value = files::read_json(path)?;
    if value.get("robot").is_some() && value.get("origin").is_some() {
        return Simulator::read(path).map(|simulator| told(&simulator));
    }
    let report = REPORTS.iter().find(|(key, _)| value.get(key).is_some());
    let (_, what) = report.ok_or_else(|| Error::in_file(path, "is no JSON that mindgap writes"))?;
    Ok(match value.get("verdict").and_then(Value::as_str) {
        Some(verdict) => format!("{what}, verdict {verdict}"),
        None => (*what).into(),
    })
}

fn told(simulator: &Simulator) -> String {
    let origin = &simulator.origin;
    let mut text = format!(
        "a simulator, trained ({}) on {} runs with seed {} by mindgap {}; steps of {} ms",
        origin.trainer, origin.runs, origin.seed, origin.version, simulator.robot.step_ms
    );
    for missing in &simulator.missing {
        text += &format!("; no network {}: {}", missing.network, missing.reason);
    }
    if !simulator.added.is_empty() {
        let ids: Vec<&str> = simulator.added.iter().map(|effect| effect.effect.as_str()).collect();
        text += &format!("; with the effects {}", ids.join(", "));
    }
    text
}

fn toml(path: &Path) -> Result<String> {
    let table: toml::Table = files::read_toml(path)?;
    let has = |key: &str| table.contains_key(key);
    if has("tuple") {
        let ControllerFile { controller, origin } = ControllerFile::read(path)?;
        let evolved = origin.map(|o| {
            format!(
                "; evolved in {} for start {} of {}, {:.0} % reach the target",
                o.simulator,
                o.start,
                o.scene,
                100.0 * o.success
            )
        });
        let steps = format!("a controller, a step every {} ms, {} at most", controller.step_ms, controller.max_steps);
        return Ok(steps + &evolved.unwrap_or_default());
    }
    if has("effect") {
        let ids: Vec<&str> = own::read(path)?.iter().map(|effect| effect.id).collect();
        return Ok(format!("effects of your own for `mindgap diagnose --effects`: {}", ids.join(", ")));
    }
    if has("ultrasonic") || has("track_cm") {
        let robot = Robot::read(path)?;
        return Ok(format!("a robot with a track of {} cm, steps of {} ms", robot.track_cm, robot.step_ms));
    }
    let scene = Scene::read(path)?;
    let target = if scene.target_cm.is_some() { "a target" } else { "no target" };
    let [obstacles, walls, starts] = [scene.obstacles.len(), scene.walls.len(), scene.starts.len()];
    Ok(format!("a scene with {obstacles} obstacles, {walls} bare walls, {target} and {starts} starts"))
}
