//! Simulators, and their training.

use std::path::PathBuf;
use std::sync::Arc;

use mindgap_command::kinds;
use mindgap_learning::learn::paper;
use mindgap_learning::learn::train::{self as training, TABLE_ONE, Trainer};
use mindgap_models::simulator;
use mindgap_workers::Workers;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::error::{raised, warn};
use crate::interrupt::{Interrupt, interruptible};
use crate::logs::Logs;
use crate::{convert, places};

/// A simulator of a robot.
#[pyclass(frozen, module = "mindgap")]
pub struct Simulator {
    /// The simulator.
    pub inner: Arc<simulator::Simulator>,
    /// Its name in pages.
    pub name: String,
}

#[pymethods]
impl Simulator {
    /// Reads a simulator file.
    #[staticmethod]
    fn read(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let read = py.detach(|| simulator::Simulator::read(&path)).map_err(raised)?;
        Ok(Simulator { inner: Arc::new(read), name: path.display().to_string() })
    }

    /// Writes a simulator file; replacing anything but a simulator needs `force`.
    #[pyo3(signature = (path, *, force=false))]
    fn write(&self, path: PathBuf, force: bool) -> PyResult<()> {
        places::file(&path, kinds::SIMULATOR, force)?;
        self.inner.write(&path).map_err(raised)
    }

    /// How the simulator was made.
    #[getter]
    fn origin<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        convert::facts(py, &self.inner.origin)
    }

    /// The robot, as in robot.toml.
    #[getter]
    fn robot<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        convert::facts(py, &self.inner.robot)
    }

    /// The effects added to the simulator, in the order in which they act.
    #[getter]
    fn added<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        convert::facts(py, &self.inner.added)
    }

    fn __repr__(&self) -> String {
        format!("<mindgap.Simulator from {} runs, with {} effects>", self.inner.origin.runs, self.inner.added.len())
    }
}

impl Simulator {
    /// Wraps a simulator.
    pub fn made(simulator: simulator::Simulator) -> Self {
        Simulator { inner: Arc::new(simulator), name: "a simulator from Python".into() }
    }
}

/// Trains the five networks of a simulator on logs.
#[pyfunction]
#[pyo3(signature = (logs, *, trainer="fast", seed=1))]
pub fn train(py: Python<'_>, logs: &Logs, trainer: &str, seed: u64) -> PyResult<Simulator> {
    let trainer = match trainer {
        "fast" => Trainer::Fast,
        "paper" => Trainer::Paper(paper::Options::default()),
        other => return Err(PyValueError::new_err(format!("trainer {other:?}: expected \"fast\" or \"paper\""))),
    };
    let sound = logs.sound(py, None)?;
    let train = |interrupt: &Interrupt| {
        training::train(&Workers::default(), &sound, &trainer, &TABLE_ONE, seed, &|_| interrupt.check())
    };
    let trained = interruptible(py, train)?.map_err(raised)?;
    let missing = trained.missing.iter().map(|missing| format!("no {} network: {}", missing.network, missing.reason));
    warn(py, missing.collect())?;
    Ok(Simulator::made(trained))
}
