//! `mindgap info`

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use clap::Args;
use schemars::JsonSchema;
use serde::Serialize;
use serde::de::IgnoredAny;
use serde_json::Value;

use super::json_output::JsonOption;
use super::kinds;
use super::table::count;
use mindgap_files as files;
use mindgap_files::places::Places;
use mindgap_foundations::error::{Error, Result};
use mindgap_foundations::executor::Executor;
use mindgap_foundations::schema_number::SchemaNumber;
use mindgap_logs::controller_file::ControllerFile;
use mindgap_logs::{Logs, Robot, Run, Scene};
use mindgap_models::effects::own;
use mindgap_models::simulator::Simulator;

/// Identify a file or folder and summarise its contents.
#[derive(Args)]
pub struct Info {
    /// File or folder to identify.
    path: PathBuf,
    #[command(flatten)]
    json: JsonOption,
}

/// Results of `mindgap info`.
#[derive(Serialize, JsonSchema)]
pub struct InfoResults<'a> {
    /// Version of the JSON.
    schema: SchemaNumber<1>,
    /// The file or folder.
    path: &'a Path,
    /// What it is, in words.
    what: String,
}

/// Output files that are not read again, by extension.
const PRODUCTS: &[(&str, &str)] = &[
    ("html", "a page: open it in a browser"),
    ("svg", "a figure"),
    ("png", "a figure"),
    ("nxc", "an onboard program in NXC: compile it with nbc"),
    ("rxe", "an onboard program for an NXT: `mindgap brick` runs it"),
    ("rs", "an onboard program in Rust"),
    ("c", "an onboard program in C"),
    ("ino", "an onboard program for an Arduino"),
    ("py", "an onboard program for Pybricks"),
    ("1", "a manual page: man -l shows it"),
];

/// Folders other than logs, by a file in them.
const FOLDERS: &[(&str, &str)] = &[
    ("demo.html", "output of `mindgap demo`: open demo.html in a browser"),
    ("loop.json", "a loop on the robot: `mindgap loop`; loop.json has its trials"),
    ("fleet.json", "the diagnoses of a fleet: `mindgap diagnose --fleet`; open fleet.html in a browser"),
    ("mindgap.1", "manual pages: `mindgap manual`"),
];

/// JSON lists, by a key of their entries.
const LISTS: &[(&str, &str)] = &[
    ("salt", "the sealed faults of a challenge: `mindgap challenge make`"),
    ("variant", "the effects named in a challenge: `mindgap challenge answer`"),
];

impl super::Run for Info {
    fn places(&self) -> Places {
        Places::default().reading([&self.path]).writing(self.json.path(), kinds::REPORT)
    }

    fn run(&self, _: &dyn Executor) -> Result<String> {
        let path = self.path.as_path();
        let what = if path.is_dir() { folder(path)? } else { file(path)? };
        let text = format!("{}: {what}\n", path.display());
        self.json.emit_sorted(&InfoResults { schema: SchemaNumber, path, what }, text)
    }
}

fn folder(path: &Path) -> Result<String> {
    if !path.join("robot.toml").exists() {
        let known = FOLDERS.iter().find(|(file, _)| path.join(file).exists());
        return known
            .map(|(_, what)| (*what).into())
            .ok_or_else(|| Error::in_file(path, "is not a folder of logs: it has no robot.toml"));
    }
    let logs = Logs::read(path, super::warn)?;
    let (runs, rows, step_ms) = (logs.runs.len(), logs.rows(), logs.robot.step_ms);
    Ok(format!("logs of {}, {rows} rows, {step_ms} ms apart; see `mindgap check`", count(runs, "run")))
}

fn file(path: &Path) -> Result<String> {
    let ending = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    match ending.as_str() {
        "json" => of_json(path),
        "toml" => of_toml(path),
        "csv" => {
            let run = Run::read(path, super::warn)?;
            let seen = run.rows.iter().filter(|row| row.pose.is_some()).count();
            let heard = run.rows.iter().filter(|row| row.echo_cm.is_some()).count();
            Ok(format!("a run of {} rows, {seen} with a pose and {heard} with a reading", run.rows.len()))
        }
        _ => {
            // The file must exist.
            fs::metadata(path).map_err(|e| Error::in_file(path, format!("cannot be read: {e}")))?;
            let product = PRODUCTS.iter().find(|(other, _)| *other == ending);
            let (_, what) = product.ok_or_else(|| Error::in_file(path, "unrecognised file type"))?;
            Ok((*what).into())
        }
    }
}

fn of_json(path: &Path) -> Result<String> {
    let value: Value = files::read_json(path)?;
    if value.get("robot").is_some() && value.get("origin").is_some() {
        return Simulator::read(path).map(|simulator| describe(&simulator));
    }
    if let Some(first) = value.get(0) {
        let list = LISTS.iter().find(|(key, _)| first.get(key).is_some());
        return list.map(|(_, what)| (*what).into()).ok_or_else(|| Error::in_file(path, "unrecognised list"));
    }
    let report = kinds::REPORTS.iter().find(|(keys, _)| keys.iter().all(|key| value.get(key).is_some()));
    let (_, what) = report.ok_or_else(|| Error::in_file(path, "unrecognised JSON"))?;
    Ok(match value.get("verdict").and_then(Value::as_str) {
        Some(verdict) => format!("{what}, verdict {verdict}"),
        None => (*what).into(),
    })
}

fn describe(simulator: &Simulator) -> String {
    let origin = &simulator.origin;
    let mut text = format!(
        "a simulator, trained ({}) on {} runs with seed {} by mindgap {}; {} ms per step",
        origin.trainer, origin.runs, origin.seed, origin.version, simulator.robot.step_ms
    );
    for missing in &simulator.missing {
        text += &format!("; no network {}: {}", missing.network, missing.reason);
    }
    if !simulator.filter.is_none() {
        text += &format!("; behind a filter of the drive: {}", simulator.filter.in_words(&simulator.robot));
    }
    if !simulator.added.is_empty() {
        let ids: Vec<&str> = simulator.added.iter().map(|effect| effect.effect.as_str()).collect();
        text += &format!("; with the effects {}", ids.join(", "));
    }
    text
}

fn of_toml(path: &Path) -> Result<String> {
    if (kinds::CALIBRATION.is_own)(files::read_text(path)?.as_bytes()) {
        return Ok("thresholds of the diagnosis: `mindgap challenge calibrate`".into());
    }
    // Only keys are parsed: a TOML value cannot hold a seed above 2^63.
    let table: BTreeMap<String, IgnoredAny> = files::read_toml(path)?;
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
        let steps = format!("a controller, {} ms per step, at most {} steps", controller.step_ms, controller.max_steps);
        return Ok(steps + &evolved.unwrap_or_default());
    }
    if has("effect") {
        let ids: Vec<&str> = own::read(path)?.iter().map(|effect| effect.id).collect();
        return Ok(format!("user-defined effects for `mindgap diagnose --effects`: {}", ids.join(", ")));
    }
    if has("ultrasonic") || has("track_cm") {
        let robot = Robot::read(path)?;
        return Ok(format!("a robot with a track of {} cm, {} ms per step", robot.track_cm, robot.step_ms));
    }
    let scene = Scene::read(path)?;
    let target = if scene.target_cm.is_some() { "a target" } else { "no target" };
    let obstacles = count(scene.obstacles.len(), "obstacle");
    let [walls, starts] = [count(scene.walls.len(), "bare wall"), count(scene.starts.len(), "start")];
    Ok(format!("a scene with {obstacles}, {walls}, {target} and {starts}"))
}
