//! Recordings of a robot as logs.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::str::FromStr;
use std::sync::Arc;

use mindgap_command::import::recordings::{self as text, RecordingsResults};
use mindgap_command::import::{self as brick_text, ImportResults};
use mindgap_import::assemble::{Stated, Watchdog};
use mindgap_import::bag::{self, Choice};
use mindgap_import::brick;
use mindgap_import::given::{self, Given};
use mindgap_import::mapping::Mapping;
use mindgap_import::report::{RecordingsReport, Report};
use mindgap_import::statements::Statements;
use mindgap_import::streams::{Recordings, recordings};
use mindgap_import::units::Units;
use mindgap_logs::range_sensor::RangeSensor;
use mindgap_logs::{LogFiles, Robot, Scene};
use pyo3::prelude::*;

use crate::error::{Error, raised, warn};
use crate::interrupt::{Interrupt, interruptible};
use crate::logs::Logs;
use crate::{convert, places};

/// Logs that were made of recordings, and what was guessed, changed or left out.
#[pyclass(frozen, module = "mindgap")]
pub struct Imported {
    logs: Arc<mindgap_logs::Logs>,
    files: LogFiles,
    report: AnyReport,
}

enum AnyReport {
    Recordings(RecordingsReport),
    BrickLogs(Report),
}

#[pymethods]
impl Imported {
    /// The logs.
    #[getter]
    fn logs(&self) -> Logs {
        Logs { inner: self.logs.clone(), folder: None }
    }

    /// The facts of `mindgap import --json`.
    #[getter]
    fn facts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        match &self.report {
            AnyReport::Recordings(report) => convert::facts(py, &RecordingsResults::of(report)),
            AnyReport::BrickLogs(report) => convert::facts(py, &ImportResults::of(report)),
        }
    }

    /// Writes the folder of `mindgap import`. A folder that is not empty needs `force`; unrelated files in it are kept.
    #[pyo3(signature = (folder, *, force=false))]
    fn write(&self, py: Python<'_>, folder: PathBuf, force: bool) -> PyResult<()> {
        places::folder(&folder, force)?;
        py.detach(|| self.files.write(&folder)).map_err(raised)
    }

    /// What the command prints.
    fn __str__(&self) -> String {
        match &self.report {
            AnyReport::Recordings(report) => text::describe(report, self.logs.robot.step_ms),
            AnyReport::BrickLogs(report) => brick_text::describe(report),
        }
    }

    fn __repr__(&self) -> String {
        format!("<mindgap.Imported of {} runs>", self.logs.runs.len())
    }
}

/// One path or several.
#[derive(FromPyObject)]
pub enum Paths {
    /// One.
    One(PathBuf),
    /// Several.
    Several(Vec<PathBuf>),
}

/// The topic of the readings, or that of each range sensor by name.
#[derive(FromPyObject)]
pub enum Ranges {
    /// That of the first sensor.
    First(String),
    /// By the sensors' names.
    ByName(BTreeMap<String, String>),
}

impl From<Paths> for Vec<PathBuf> {
    fn from(paths: Paths) -> Self {
        match paths {
            Paths::One(path) => vec![path],
            Paths::Several(paths) => paths,
        }
    }
}

impl Ranges {
    fn by_sensor(self) -> Vec<(Option<String>, String)> {
        match self {
            Ranges::First(topic) => vec![(None, topic)],
            Ranges::ByName(topics) => topics.into_iter().map(|(sensor, topic)| (Some(sensor), topic)).collect(),
        }
    }
}

/// Imports bags of ROS.
#[pyfunction]
#[pyo3(signature = (
    bags, *, robot=None, scene=None, commands=None, poses=None, ranges=None, gyro=None, left_joints=Vec::new(),
    right_joints=Vec::new(), watchdog_ms=None,
))]
#[expect(clippy::too_many_arguments, reason = "the options of the command")]
pub fn import_bags(
    py: Python<'_>,
    bags: Paths,
    robot: Option<&Bound<PyAny>>,
    scene: Option<&Bound<PyAny>>,
    commands: Option<String>,
    poses: Option<String>,
    ranges: Option<Ranges>,
    gyro: Option<String>,
    left_joints: Vec<String>,
    right_joints: Vec<String>,
    watchdog_ms: Option<&Bound<PyAny>>,
) -> PyResult<Imported> {
    let ranges = ranges.map(Ranges::by_sensor).unwrap_or_default();
    let choice = Choice { commands, poses, ranges, gyro, wheels: [left_joints, right_joints] };
    let stated = Stated { offset_ms: None, watchdog: watchdog(watchdog_ms)? };
    let bags = Vec::from(bags);
    imported(py, given(robot, scene)?, stated, |sensors, interrupt| {
        bag::usable(&bags, &choice, &sensors, |_| interrupt.check())
    })
}

/// Imports streams as CSV.
#[pyfunction]
#[pyo3(signature = (
    files, *, robot=None, scene=None, map=None, time_unit=None, length_unit=None, angle_unit=None, body=None,
    offset_ms=None, watchdog_ms=None,
))]
#[expect(clippy::too_many_arguments, reason = "the options of the command")]
pub fn import_streams(
    py: Python<'_>,
    files: Paths,
    robot: Option<&Bound<PyAny>>,
    scene: Option<&Bound<PyAny>>,
    map: Option<&Bound<PyAny>>,
    time_unit: Option<&str>,
    length_unit: Option<&str>,
    angle_unit: Option<&str>,
    body: Option<String>,
    offset_ms: Option<f64>,
    watchdog_ms: Option<&Bound<PyAny>>,
) -> PyResult<Imported> {
    let mapping = map.map(|map| convert::text(map, "map")).transpose()?;
    let mapping =
        mapping.map_or(Ok(Mapping::default()), |(path, text)| Mapping::parse(&path, &text)).map_err(raised)?;
    let units = units(time_unit, length_unit, angle_unit)?;
    let stated = Stated { offset_ms, watchdog: watchdog(watchdog_ms)? };
    let files = Vec::from(files);
    imported(py, given(robot, scene)?, stated, |sensors, interrupt| {
        recordings(&files, &Statements { mapping, units, body, sensors }, |_, _| interrupt.check())
    })
}

/// Merges a brick's logs with a camera's tracks.
#[pyfunction]
#[pyo3(signature = (files, robot, scene, *, time_unit=None, length_unit=None, angle_unit=None, body=None))]
#[expect(clippy::too_many_arguments, reason = "the options of the command")]
pub fn import_brick(
    py: Python<'_>,
    files: Paths,
    robot: &Bound<PyAny>,
    scene: &Bound<PyAny>,
    time_unit: Option<&str>,
    length_unit: Option<&str>,
    angle_unit: Option<&str>,
    body: Option<String>,
) -> PyResult<Imported> {
    let (path, text) = convert::text(robot, "robot")?;
    let robot = Robot::parse_all(&path, &text).map_err(raised)?;
    let scene: Scene = convert::scene(scene)?;
    let units = units(time_unit, length_unit, angle_unit)?;
    let stated = Statements { units, body, ..Statements::default() };
    let files = Vec::from(files);
    let mut oddities = Vec::new();
    let merged = interruptible(py, |interrupt| {
        brick::import(&files, &stated, robot, scene, |odd| oddities.push(odd), |_, _| interrupt.check())
    })?;
    warn(py, oddities)?;
    let (logs, report) = merged.map_err(raised)?;
    Ok(Imported { files: logs.to_files(), logs: Arc::new(logs), report: AnyReport::BrickLogs(report) })
}

/// Reads recordings for the robot's range sensors with `read`, and makes logs of them.
fn imported(
    py: Python<'_>,
    given: Given,
    stated: Stated,
    read: impl FnOnce(Vec<RangeSensor>, &Interrupt) -> mindgap_foundations::error::Result<Recordings> + Send,
) -> PyResult<Imported> {
    let imported = interruptible(py, |interrupt| {
        let recordings = read(given.range_sensors(), interrupt)?;
        given.import(recordings, stated, |_, _| interrupt.check())
    })?;
    let given::Imported { logs, files, report } = imported.map_err(raised)?;
    Ok(Imported { logs: Arc::new(logs), files, report: AnyReport::Recordings(report) })
}

fn given(robot: Option<&Bound<PyAny>>, scene: Option<&Bound<PyAny>>) -> PyResult<Given> {
    let robot = robot.map(|robot| convert::text(robot, "robot")).transpose()?;
    let scene = scene.map(|scene| convert::text(scene, "scene")).transpose()?;
    Given::parse(robot, scene).map_err(raised)
}

fn units(time: Option<&str>, length: Option<&str>, angle: Option<&str>) -> PyResult<Units> {
    Ok(Units {
        time: parsed(time, "time_unit")?,
        length: parsed(length, "length_unit")?,
        angle: parsed(angle, "angle_unit")?,
    })
}

/// Reads a watchdog time in ms, or "none".
fn watchdog(stated: Option<&Bound<PyAny>>) -> PyResult<Option<Watchdog>> {
    let text = stated.map(|stated| stated.str()).transpose()?.map(|text| text.to_string());
    parsed(text.as_deref(), "watchdog_ms")
}

fn parsed<T: FromStr<Err = String>>(text: Option<&str>, name: &str) -> PyResult<Option<T>> {
    text.map(|text| text.parse().map_err(|why: String| Error::new_err(format!("{name}: {why}")))).transpose()
}
