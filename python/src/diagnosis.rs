//! The gap between a simulator and logs.

use std::path::PathBuf;
use std::sync::Arc;

use mindgap_command::kinds;
use mindgap_diagnosis as gap;
use mindgap_diagnosis::Method;
use mindgap_diagnosis::request::{Answered, Request};
use mindgap_figures::pictures;
use mindgap_files as files;
use mindgap_models::effects::own;
use mindgap_models::simulator;
use mindgap_models::simulator::textbook;
use mindgap_pages::diagnosis::comparison::Comparison;
use mindgap_pages::diagnosis::{Source, Subject, page};
use mindgap_pages::text;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;

use crate::controller::Controller;
use crate::error::raised;
use crate::interrupt::interruptible;
use crate::logs::Logs;
use crate::show::{self, Figure, Page};
use crate::simulator::Simulator;
use crate::{convert, places};

/// Name of the textbook simulator, in place of a simulator.
const KINEMATIC: &str = "kinematic";

/// The size, location and causes of a gap, and how much of it they explain.
#[pyclass(frozen, module = "mindgap")]
pub struct Diagnosis {
    answered: Answered,
    simulator: Option<Arc<simulator::Simulator>>,
    method: Method,
    names: [String; 2],
    folder: Option<PathBuf>,
}

#[pymethods]
impl Diagnosis {
    /// The facts of `mindgap diagnose --json`.
    #[getter]
    fn facts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        convert::facts(py, self.diagnosis())
    }

    /// `no_gap`, `known`, `partly_known` or `unknown`.
    #[getter]
    fn verdict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        convert::facts(py, &self.diagnosis().verdict)
    }

    /// The effects found, as a frame.
    #[getter]
    fn effects<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        convert::frame(py, &self.diagnosis().effects)
    }

    /// The contributions to the gap, as a frame.
    #[getter]
    fn budget<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        convert::frame(py, &self.diagnosis().budget)
    }

    /// Where the gap lies, as a frame.
    #[getter]
    fn r#where<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        convert::frame(py, &self.diagnosis().strata)
    }

    /// Returns the simulator with the effects that explain the gap, and the formula of the remaining residual.
    fn with_effects_applied(&self, py: Python<'_>) -> PyResult<Simulator> {
        py.detach(|| self.request().with_effects_applied(&self.answered)).map(Simulator::made).map_err(raised)
    }

    /// Writes the commands to log next, as a run in CSV. Returns False if no causes are confused.
    #[pyo3(signature = (path, *, force=false))]
    fn write_next_experiment(&self, path: PathBuf, force: bool) -> PyResult<bool> {
        let Some(experiment) = self.diagnosis().experiment.as_ref() else { return Ok(false) };
        places::file(&path, kinds::UNSIGNED, force)?;
        experiment.commands.write(&path).map_err(raised)?;
        Ok(true)
    }

    /// Returns the page of `mindgap diagnose --html`.
    fn page(&self, py: Python<'_>) -> PyResult<Page> {
        self.page_with(py, Comparison::default())
    }

    /// Returns the figures of `mindgap diagnose --figures`.
    fn figures(&self, py: Python<'_>) -> Vec<Figure> {
        show::figures(py.detach(|| pictures::figures_of_diagnosis(self.diagnosis())))
    }

    /// Writes the figures into a folder as SVG and PNG.
    #[pyo3(signature = (folder, *, force=false))]
    fn write_figures(&self, py: Python<'_>, folder: PathBuf, force: bool) -> PyResult<()> {
        places::folder(&folder, force)?;
        py.detach(|| pictures::diagnosis(&folder, self.diagnosis())).map_err(raised)
    }

    fn _repr_html_(&self, py: Python<'_>) -> String {
        show::below_each_other(&py.detach(|| pictures::figures_of_diagnosis(self.diagnosis())))
    }

    /// What the command prints.
    fn __str__(&self) -> String {
        text::diagnosis(self.diagnosis())
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let ids: Vec<&str> = self.diagnosis().effects.iter().map(|effect| effect.id).collect();
        let effects = if ids.is_empty() { String::new() } else { format!(": {}", ids.join(", ")) };
        Ok(format!("<mindgap.Diagnosis {}{effects}>", self.verdict(py)?))
    }
}

impl Diagnosis {
    /// Diagnoses logs with a simulator, or the textbook's, which has this name in pages.
    pub fn of(
        py: Python<'_>,
        (simulator, name): (Option<Arc<simulator::Simulator>>, String),
        logs: &Logs,
        controller: Option<&mindgap_core::controller::Controller>,
        method: Method,
        step_ms: Option<f64>,
    ) -> PyResult<Self> {
        let request = Request { simulator: simulator.as_deref(), controller, method, step_ms };
        let read = (*logs.inner).clone();
        let answered = interruptible(py, |interrupt| request.of(read, |_| interrupt.check()))?.map_err(raised)?;
        Ok(Diagnosis { answered, simulator, method, names: [name, logs.name()], folder: logs.folder.clone() })
    }

    /// Returns the page, with a comparison.
    pub fn page_with(&self, py: Python<'_>, comparison: Comparison) -> PyResult<Page> {
        Page::made(py.detach(|| {
            let Answered { findings, logs } = &self.answered;
            let written = files::days_written(self.folder.as_slice())?;
            let [simulator, name] = self.names.clone();
            let source = Source { simulator, logs: name, written, seed: self.method.seed };
            let (baseline, catalogue) = (&self.request().baseline(logs)?, self.method.catalogue);
            page(&Subject { findings, logs, baseline, catalogue, source, comparison })
        }))
    }

    /// Returns what was found.
    pub fn diagnosis(&self) -> &gap::Diagnosis {
        &self.answered.findings.diagnosis
    }

    /// Returns the request, without the controller and the steps, which are in the answer.
    fn request(&self) -> Request<'_> {
        Request { simulator: self.simulator.as_deref(), controller: None, method: self.method, step_ms: None }
    }
}

/// Finds the gap between a simulator and logs.
#[pyfunction]
#[pyo3(signature = (simulator, logs, *, controller=None, effects=Vec::new(), step_ms=None, seed=1))]
pub fn diagnose(
    py: Python<'_>,
    simulator: &Bound<PyAny>,
    logs: &Logs,
    controller: Option<&Controller>,
    effects: Vec<PathBuf>,
    step_ms: Option<f64>,
    seed: u64,
) -> PyResult<Diagnosis> {
    let (simulator, name) = against(simulator)?;
    let controller = controller.map(|controller| &controller.file);
    if let Some((controller, simulator)) = controller.zip(simulator.as_ref()) {
        controller.check_for(&simulator.robot).map_err(raised)?;
    }
    let method = Method { catalogue: own::beside_built_in(&effects).map_err(raised)?, seed, ..Method::default() };
    Diagnosis::of(py, (simulator, name), logs, controller.map(|file| &file.controller), method, step_ms)
}

/// Returns a simulator, or `None` for the textbook's, and its name in pages.
fn against(given: &Bound<PyAny>) -> PyResult<(Option<Arc<simulator::Simulator>>, String)> {
    if let Ok(simulator) = given.cast::<Simulator>() {
        return Ok((Some(simulator.get().inner.clone()), simulator.get().name.clone()));
    }
    if given.extract::<&str>().is_ok_and(|word| word == KINEMATIC) {
        return Ok((None, textbook::NAME.into()));
    }
    Err(PyTypeError::new_err(format!("simulator: expected a mindgap.Simulator or {KINEMATIC:?}")))
}
