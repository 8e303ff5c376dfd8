//! Logs of a robot.

use std::path::PathBuf;
use std::sync::Arc;

use mindgap_built_in_robot::{self as built_in_robot, ActiveEffect, default_robot, training_room};
use mindgap_diagnosis::survey::Survey;
use mindgap_logs as logs;
use mindgap_logs::inspection::Inspection;
use mindgap_logs::robot::same_robot;
use mindgap_logs::tables::Table;
use mindgap_models::simulator::Simulator;
use pyo3::prelude::*;
use pyo3::types::{IntoPyDict, PyDict, PyTuple};

use crate::error::{Error, raised, warn};
use crate::{convert, places};

/// Logged runs of a robot in a scene.
#[pyclass(frozen, module = "mindgap")]
pub struct Logs {
    /// The logs.
    pub inner: Arc<logs::Logs>,
    /// The folder that they were read from.
    pub folder: Option<PathBuf>,
}

#[pymethods]
impl Logs {
    #[new]
    #[pyo3(signature = (runs, robot, scene=None))]
    fn new(py: Python<'_>, runs: &Bound<PyAny>, robot: &Bound<PyAny>, scene: Option<&Bound<PyAny>>) -> PyResult<Self> {
        let robot = convert::robot(robot)?;
        let scene = scene.map(convert::scene).transpose()?.unwrap_or_default();
        let tables = convert::tables(runs)?;
        let mut oddities = Vec::new();
        let read = py.detach(|| logs::Logs::from_tables(robot, scene, &tables, |oddity| oddities.push(oddity)));
        warn(py, oddities)?;
        Ok(Logs { inner: Arc::new(read.map_err(raised)?), folder: None })
    }

    /// Reads a folder of logs.
    #[staticmethod]
    fn read(py: Python<'_>, folder: PathBuf) -> PyResult<Self> {
        let mut oddities = Vec::new();
        let read = py.detach(|| logs::Logs::read(&folder, |oddity| oddities.push(oddity)));
        warn(py, oddities)?;
        Ok(Logs { inner: Arc::new(read.map_err(raised)?), folder: Some(folder) })
    }

    /// Writes a folder of logs. A folder that is not empty needs `force`; unrelated files in it are kept.
    #[pyo3(signature = (folder, *, force=false))]
    fn write(&self, py: Python<'_>, folder: PathBuf, force: bool) -> PyResult<()> {
        places::folder(&folder, force)?;
        py.detach(|| self.inner.write(&folder)).map_err(raised)
    }

    /// The runs: arrays by column name, by run name. Empty cells are NaN.
    #[getter]
    fn runs<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let runs = PyDict::new(py);
        for run in &self.inner.runs {
            runs.set_item(&run.name, convert::arrays(py, Table::from_run(run))?)?;
        }
        Ok(runs)
    }

    /// Returns all runs in one frame, with a column `run`.
    fn frame<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let pandas = py.import("pandas")?;
        let frames = self.inner.runs.iter().map(|run| {
            let frame = pandas.call_method1("DataFrame", (convert::arrays(py, Table::from_run(run))?,))?;
            frame.call_method1("insert", (0, "run", &run.name))?;
            Ok(frame)
        });
        let frames = frames.collect::<PyResult<Vec<_>>>()?;
        pandas.call_method("concat", (frames,), Some(&[("ignore_index", true)].into_py_dict(py)?))
    }

    /// The robot, as in robot.toml.
    #[getter]
    fn robot<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        convert::facts(py, &self.inner.robot)
    }

    /// The scene, as in scene.toml.
    #[getter]
    fn scene<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        convert::scene_facts(py, &self.inner.scene)
    }

    /// Checks the logs: contents, defects, what they can identify, and what to drive next.
    fn check<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let survey = py.detach(|| Survey::of((*self.inner).clone()));
        convert::facts(py, &survey)
    }

    /// Pickles them as what they were made from.
    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let parts = PyTuple::new(py, [self.runs(py)?.into_any(), self.robot(py)?, self.scene(py)?])?;
        Ok((py.get_type::<Logs>().into_any(), parts))
    }

    fn __len__(&self) -> usize {
        self.inner.runs.len()
    }

    fn __repr__(&self) -> String {
        format!("<mindgap.Logs of {} runs, {} rows>", self.inner.runs.len(), self.inner.rows())
    }
}

impl Logs {
    /// Wraps logs.
    pub fn made(logs: logs::Logs) -> Self {
        Logs { inner: Arc::new(logs), folder: None }
    }

    /// Returns their name in pages.
    pub fn name(&self) -> String {
        self.folder.as_ref().map_or_else(|| "logs from Python".into(), |folder| folder.display().to_string())
    }

    /// Returns the usable logs, corrected where the inspection can; they must be of the same robot as `of`, if given.
    pub fn sound(&self, py: Python<'_>, of: Option<&Simulator>) -> PyResult<logs::Logs> {
        let mut findings = Vec::new();
        let sound = py.detach(|| {
            let sound = Inspection::new((*self.inner).clone()).into_usable(|found| findings.push(found))?;
            of.map_or(Ok(()), |simulator| same_robot(&simulator.robot, &sound.robot))?;
            Ok(sound)
        });
        warn(py, findings)?;
        sound.map_err(raised)
    }
}

/// Records random-command logs of the built-in robot.
#[pyfunction]
#[pyo3(signature = (*, runs=100, steps=60, effects=Vec::new(), scene=None, seed=1))]
pub fn record(
    py: Python<'_>,
    runs: usize,
    steps: usize,
    effects: Vec<String>,
    scene: Option<&Bound<PyAny>>,
    seed: u64,
) -> PyResult<Logs> {
    let scene = scene.map_or_else(|| Ok(training_room()), convert::scene)?;
    let effects = effects.iter().map(|effect| effect.parse().map_err(Error::new_err));
    let effects = effects.collect::<PyResult<Vec<ActiveEffect>>>()?;
    let recorded = py.detach(|| built_in_robot::record(&default_robot(), &scene, runs, steps, &effects, seed));
    recorded.map(Logs::made).map_err(raised)
}
