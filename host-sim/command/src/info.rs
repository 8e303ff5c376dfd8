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
use super::table::{self, count};
use mindgap_diagnosis::scope::of_sensor;
use mindgap_files as files;
use mindgap_files::places::Places;
use mindgap_foundations::error::{Error, Result};
use mindgap_foundations::executor::Executor;
use mindgap_foundations::schema_number::SchemaNumber;
use mindgap_import::bag;
use mindgap_import::contents::{Contents, StreamContents};
use mindgap_logs::controller_file::ControllerFile;
use mindgap_logs::range_sensor::Sensors;
use mindgap_logs::{Logs, Robot, Run, Scene};
use mindgap_models::effects::own;
use mindgap_models::simulator::Simulator;

/// Identify files or folders and summarise their contents: for recordings, the columns or topics, rates, time span and bodies.
#[derive(Args)]
pub struct Info {
    /// Files or folders to identify.
    #[arg(required = true)]
    paths: Vec<PathBuf>,
    #[command(flatten)]
    json: JsonOption,
}

/// Results of `mindgap info`.
#[derive(Serialize, JsonSchema)]
pub struct InfoResults<'a> {
    /// Version of the JSON.
    schema: SchemaNumber<1>,
    /// The files or folders.
    files: Vec<Described<'a>>,
}

/// A file or folder.
#[derive(Serialize, JsonSchema)]
struct Described<'a> {
    /// The file or folder.
    path: &'a Path,
    /// What it holds; only recordings have streams.
    #[serde(flatten)]
    contents: Contents,
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
        Places::default().reading(&self.paths).writing(self.json.path(), kinds::REPORT)
    }

    fn run(&self, _: &dyn Executor) -> Result<String> {
        let described = |path: &'_ PathBuf| {
            let what = |kind| Contents { kind, seconds: None, streams: Vec::new(), bodies: Vec::new() };
            match path.is_dir() {
                _ if bag::is_bag(path) => bag::contents(path),
                true => folder(path).map(what),
                false => file(path, what),
            }
        };
        let files = self.paths.iter().map(|path| Ok(Described { path, contents: described(path)? }));
        let files = files.collect::<Result<Vec<_>>>()?;
        let text = files.iter().map(text).collect();
        self.json.emit_sorted(&InfoResults { schema: SchemaNumber, files }, text)
    }
}

fn text(Described { path, contents }: &Described) -> String {
    let Contents { kind, seconds, streams, bodies } = contents;
    let span = seconds.map_or(String::new(), |seconds| format!(", {seconds:.1} s"));
    let of =
        |bodies: &[String]| if bodies.is_empty() { String::new() } else { format!("; bodies: {}", bodies.join(", ")) };
    let mut text = format!("{}: {kind}{span}{}\n", path.display(), of(bodies));
    if !streams.is_empty() {
        let row = |stream: &StreamContents| {
            let StreamContents { name, r#type, rate_hz, rows } = stream;
            [name.clone(), r#type.clone(), rate_hz.map_or("-".into(), |hz| format!("{hz:.1}")), rows.to_string()]
        };
        text += &table::text(["name", "type", "rate (Hz)", "rows"], &streams.iter().map(row).collect::<Vec<_>>());
    }
    text
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
    let sensors = with_sensors(&logs.sensors());
    Ok(format!("logs of {}, {rows} rows, {step_ms} ms apart{sensors}; see `mindgap check`", count(runs, "run")))
}

/// Names range sensors where there is another than `[ultrasonic]`.
fn with_sensors(sensors: &Sensors) -> String {
    if sensors.are_usual() {
        return String::new();
    }
    format!("; range sensors {}", sensors.names().collect::<Vec<_>>().join(", "))
}

/// Endings of recordings in text.
const TABLES: [&str; 6] = ["csv", "tsv", "txt", "tum", "gz", "log"];

fn file(path: &Path, what: impl Fn(String) -> Contents) -> Result<Contents> {
    let ending = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    match ending.as_str() {
        "json" => of_json(path).map(what),
        "toml" => of_toml(path).map(what),
        "csv" if is_run(path) => {
            let run = Run::read(path, super::warn)?;
            let seen = run.rows.iter().filter(|row| row.pose.is_some()).count();
            let heard = run.rows.iter().filter(|row| row.echo_cm.is_some()).count();
            Ok(what(format!("a run of {} rows, {seen} with a pose and {heard} with a reading", run.rows.len())))
        }
        ending if TABLES.contains(&ending) => Contents::of_table(path),
        _ => {
            // The file must exist.
            fs::metadata(path).map_err(|e| Error::in_file(path, format!("cannot be read: {e}")))?;
            let product = PRODUCTS.iter().find(|(other, _)| *other == ending);
            let (_, product) = product.ok_or_else(|| Error::in_file(path, "unrecognised file type"))?;
            Ok(what((*product).into()))
        }
    }
}

/// Returns whether a table is a run of a log folder, by its header.
fn is_run(path: &Path) -> bool {
    let text = files::read_text(path).unwrap_or_default();
    let header = text.lines().next().unwrap_or_default();
    let has = |name: &str| header.split(',').any(|column| column.trim() == name);
    ["t_ms", "left", "right", "x_cm", "y_cm", "heading_deg"].into_iter().all(has)
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
    if simulator.sensor.is_some() || !simulator.further.is_empty() {
        text += &format!("; range sensors {}", simulator.sensor_names().join(", "));
    }
    for missing in &simulator.missing {
        text += &format!("; no network {}: {}", missing.network, missing.reason);
    }
    if !simulator.filter.is_none() {
        text += &format!("; behind a filter of the drive: {}", simulator.filter.in_words(&simulator.robot));
    }
    if !simulator.added.is_empty() {
        let ids: Vec<String> =
            simulator.added.iter().map(|effect| of_sensor(&effect.effect, effect.sensor.as_deref())).collect();
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
        let ControllerFile { controller, origin, sensors } = ControllerFile::read(path)?;
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
        let mut named: Vec<&str> = sensors.iter().flatten().map(String::as_str).collect();
        named.dedup();
        let asks = if named.is_empty() { String::new() } else { format!("; asks range sensor {}", named.join(", ")) };
        return Ok(steps + &asks + &evolved.unwrap_or_default());
    }
    if has("effect") {
        let ids: Vec<&str> = own::read(path)?.iter().map(|effect| effect.id).collect();
        return Ok(format!("user-defined effects for `mindgap diagnose --effects`: {}", ids.join(", ")));
    }
    if has("ultrasonic") || has("track_cm") {
        let (robot, sensors) = Robot::read_all(path)?;
        let text = format!("a robot with a track of {} cm, {} ms per step", robot.track_cm, robot.step_ms);
        return Ok(text + &with_sensors(&sensors));
    }
    let scene = Scene::read(path)?;
    let target = if scene.target_cm.is_some() { "a target" } else { "no target" };
    let obstacles = count(scene.obstacles.len(), "obstacle");
    let [walls, starts] = [count(scene.walls.len(), "bare wall"), count(scene.starts.len(), "start")];
    Ok(format!("a scene with {obstacles}, {walls}, {target} and {starts}"))
}
