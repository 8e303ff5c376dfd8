//! Simulators adapted to runs of the robot.

use std::sync::Arc;

use mindgap_applications::adapt::{self as applications, Adapted, Lesson};
use mindgap_models::simulator;
use pyo3::prelude::*;

use crate::convert;
use crate::error::raised;
use crate::interrupt::interruptible;
use crate::logs::Logs;
use crate::simulator::Simulator;

/// A simulator that was adapted to runs of the robot, and what it learned.
#[pyclass(frozen, module = "mindgap")]
pub struct Adaptation {
    adapted: Arc<simulator::Simulator>,
    lesson: Lesson,
}

#[pymethods]
impl Adaptation {
    /// The adapted simulator.
    #[getter]
    fn simulator(&self) -> Simulator {
        Simulator { inner: self.adapted.clone(), name: "a simulator from Python".into() }
    }

    /// What was learned: a lesson of `mindgap adapt --json`.
    #[getter]
    fn facts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        convert::facts(py, &self.lesson)
    }

    fn __repr__(&self) -> String {
        let Lesson { effects, commands, .. } = &self.lesson;
        format!("<mindgap.Adaptation: {} effects, {} commands corrected>", effects.len(), commands.len())
    }
}

/// Adapts a simulator to logs of its robot.
#[pyfunction]
#[pyo3(signature = (simulator, logs, *, seed=1))]
pub fn adapt(py: Python<'_>, simulator: &Simulator, logs: &Logs, seed: u64) -> PyResult<Adaptation> {
    let sound = logs.sound(py, None)?;
    let adapted =
        interruptible(py, |interrupt| applications::adapt(&simulator.inner, &sound, seed, |_| interrupt.check()))?;
    let Adapted { simulator, lesson, .. } = adapted.map_err(raised)?;
    Ok(Adaptation { adapted: Arc::new(simulator), lesson })
}
