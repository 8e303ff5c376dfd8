//! Simulators, and their training.

use std::path::PathBuf;
use std::sync::Arc;

use mindgap_command::kinds;
use mindgap_learning::evaluation::predictions::{Predictions, predict};
use mindgap_learning::learn::paper;
use mindgap_learning::learn::train::{self as training, TABLE_ONE, Trainer};
use mindgap_logs as logs;
use mindgap_models::simulator;
use mindgap_workers::Workers;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde::Serialize;

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

    /// Predicts every row of logs; returns a frame of logged and predicted values by channel.
    fn predict<'py>(&self, py: Python<'py>, logs: &Logs) -> PyResult<Bound<'py, PyAny>> {
        let predicted = py.detach(|| predict(&self.inner, &logs.inner)).map_err(raised)?;
        let Predictions { forward, lateral, turn, echo_probability, echo_value } = predicted;
        let channels = [
            ("forward_cm", forward),
            ("lateral_cm", lateral),
            ("turn_deg", turn),
            ("echo_probability", echo_probability),
            ("echo_value_cm", echo_value),
        ];
        let rows = channels.iter().flat_map(|(channel, pairs)| {
            pairs.iter().map(|[logged, predicted]| Prediction { channel, logged: *logged, predicted: *predicted })
        });
        convert::frame(py, &rows.collect::<Vec<_>>())
    }

    /// The networks by name, with their weights, as the simulator file has them.
    #[getter]
    fn networks<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let simulator::Simulator { turn, forward, lateral, echo_probability, echo_value, .. } = &*self.inner;
        let networks = PyDict::new(py);
        for (name, learned) in [("turn", turn), ("forward", forward), ("lateral", lateral)] {
            networks.set_item(name, convert::facts(py, &learned.as_ref().map(|learned| &learned.network))?)?;
        }
        for (name, learned) in [("echo_probability", echo_probability), ("echo_value", echo_value)] {
            networks.set_item(name, convert::facts(py, &learned.as_ref().map(|learned| &learned.network))?)?;
        }
        Ok(networks.into_any())
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

    /// Pickles it as its file.
    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, (String, String))> {
        let text = serde_json::to_string(&*self.inner).map_err(|e| PyValueError::new_err(e.to_string()))?;
        Ok((py.get_type::<Simulator>().getattr("_unpickled")?, (text, self.name.clone())))
    }

    #[staticmethod]
    fn _unpickled(text: &str, name: String) -> PyResult<Self> {
        let inner = serde_json::from_str(text).map_err(|e| PyValueError::new_err(e.to_string()))?;
        Ok(Simulator { inner: Arc::new(inner), name })
    }

    fn __repr__(&self) -> String {
        format!("<mindgap.Simulator from {} runs, with {} effects>", self.inner.origin.runs, self.inner.added.len())
    }
}

/// A row of the frame of predictions.
#[derive(Serialize)]
struct Prediction<'a> {
    channel: &'a str,
    logged: f64,
    predicted: f64,
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
    trained(py, &logs.sound(py, None)?, &trainer, seed).map(Simulator::made)
}

/// Trains a simulator on usable logs; warns of networks that they do not support.
pub fn trained(py: Python<'_>, logs: &logs::Logs, trainer: &Trainer, seed: u64) -> PyResult<simulator::Simulator> {
    let train = |interrupt: &Interrupt| {
        training::train(&Workers::default(), logs, trainer, &TABLE_ONE, seed, &|_| interrupt.check())
    };
    let trained = interruptible(py, train)?.map_err(raised)?;
    let missing = trained.missing.iter().map(|missing| format!("no {} network: {}", missing.network, missing.reason));
    warn(py, missing.collect())?;
    Ok(trained)
}
