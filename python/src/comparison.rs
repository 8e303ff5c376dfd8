//! A user's own simulator against the robot.

use std::sync::Arc;

use mindgap_applications::compare::coverage;
use mindgap_applications::compare::pairs::{self, Pair};
use mindgap_diagnosis as gap;
use mindgap_diagnosis::Method;
use mindgap_learning::learn::train::Trainer;
use mindgap_models::simulator;
use mindgap_pages::diagnosis::comparison;
use pyo3::prelude::*;
use serde::Serialize;

use crate::convert;
use crate::diagnosis::Diagnosis;
use crate::error::Error;
use crate::logs::Logs;
use crate::show::Page;
use crate::simulator::{Simulator, trained};

/// What differs between a simulator and the robot, from logs of both.
#[pyclass(frozen, module = "mindgap")]
pub struct Comparison {
    diagnosis: Py<Diagnosis>,
    learned: Arc<simulator::Simulator>,
    pairs: Vec<Pair>,
}

/// A diagnosis, and the runs of both sides.
#[derive(Serialize)]
struct Facts<'a> {
    #[serde(flatten)]
    diagnosis: &'a gap::Diagnosis,
    pairs: &'a [Pair],
}

#[pymethods]
impl Comparison {
    /// The diagnosis of the learned simulator on the robot's logs.
    #[getter]
    fn diagnosis(&self, py: Python<'_>) -> Py<Diagnosis> {
        self.diagnosis.clone_ref(py)
    }

    /// The simulator that was learned from its logs.
    #[getter]
    fn simulator(&self) -> Simulator {
        Simulator { inner: self.learned.clone(), name: "a simulator from Python".into() }
    }

    /// Runs of both sides with the same commands, as a frame.
    #[getter]
    fn pairs<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        convert::frame(py, &self.pairs)
    }

    /// The facts of `mindgap compare --json`, without patches.
    #[getter]
    fn facts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        convert::facts(py, &Facts { diagnosis: self.diagnosis.get().diagnosis(), pairs: &self.pairs })
    }

    /// Returns the page of `mindgap compare --html`.
    fn page(&self, py: Python<'_>) -> PyResult<Page> {
        let comparison = comparison::Comparison { pairs: &self.pairs, ..Default::default() };
        self.diagnosis.get().page_with(py, comparison)
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        Ok(format!("<mindgap.Comparison: {}>", self.diagnosis.bind(py).repr()?))
    }
}

/// Compares a simulator with the robot, from logs of both.
#[pyfunction]
#[pyo3(signature = (simulated, real, *, seed=1))]
pub fn compare(py: Python<'_>, simulated: &Logs, real: &Logs, seed: u64) -> PyResult<Comparison> {
    let known = simulated.sound(py, None)?;
    if let Some(what) = coverage::missing(&known, &real.inner) {
        return Err(Error::new_err(what));
    }
    let learned = Arc::new(trained(py, &known, &Trainer::Fast, seed)?);
    let pairs = pairs::pairs(&known, &real.inner);
    let method = Method { seed, ..Method::default() };
    let diagnosis = Diagnosis::of(py, (Some(learned.clone()), simulated.name()), real, None, method, None)?;
    Ok(Comparison { diagnosis: Py::new(py, diagnosis)?, learned, pairs })
}
