//! The accuracy of a simulator's networks on logs.

use std::path::PathBuf;
use std::sync::Arc;

use mindgap_figures::pictures;
use mindgap_learning::evaluation::accuracy::{self, Networks, Probability, Value};
use mindgap_logs as logs;
use mindgap_models::simulator;
use mindgap_pages::evaluation::{Subject, page};
use pyo3::prelude::*;
use serde::Serialize;

use crate::error::raised;
use crate::logs::Logs;
use crate::show::{self, Figure, Page};
use crate::simulator::Simulator;
use crate::{convert, places};

/// The accuracy of a simulator's networks.
#[pyclass(frozen, module = "mindgap")]
pub struct Evaluation {
    evaluation: accuracy::Evaluation,
    simulator: Arc<simulator::Simulator>,
    logs: logs::Logs,
    names: [String; 2],
}

/// The row of a network.
#[derive(Default, Serialize)]
struct Row {
    network: &'static str,
    n: usize,
    r2: Option<f64>,
    mse: Option<f64>,
    mae_cm: Option<f64>,
    brier: Option<f64>,
    log_loss: Option<f64>,
    auc: Option<f64>,
}

#[pymethods]
impl Evaluation {
    /// The facts of `mindgap evaluate --json`.
    #[getter]
    fn facts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        convert::facts(py, &self.evaluation)
    }

    /// The accuracy of each network, as a frame.
    #[getter]
    fn networks<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let Networks { turn, forward, lateral, echo_probability, echo_value, .. } = &self.evaluation.networks;
        let values = [("turn", turn), ("forward", forward), ("lateral", lateral), ("echo_value", echo_value)];
        let value = |(network, value): (&'static str, &Option<Value>)| {
            let Value { r2, mse, mae_cm, n, .. } = value.as_ref()?;
            Some(Row { network, n: *n, r2: *r2, mse: Some(*mse), mae_cm: *mae_cm, ..Row::default() })
        };
        let probability = |p: &Probability| Row {
            network: "echo_probability",
            n: p.n,
            r2: p.r2,
            brier: Some(p.brier),
            log_loss: Some(p.log_loss),
            auc: p.auc,
            ..Row::default()
        };
        let rows: Vec<Row> =
            values.into_iter().filter_map(value).chain(echo_probability.iter().map(probability)).collect();
        convert::frame(py, &rows)
    }

    /// Returns the page of `mindgap evaluate --html`.
    fn page(&self, py: Python<'_>) -> PyResult<Page> {
        let names = self.names.each_ref().map(String::as_str);
        let subject = Subject { evaluation: &self.evaluation, simulator: &self.simulator, logs: &self.logs, names };
        Page::made(py.detach(|| Ok(page(&subject))))
    }

    /// Returns the figures of `mindgap evaluate --figures`.
    fn figures(&self, py: Python<'_>) -> Vec<Figure> {
        show::figures(py.detach(|| self.drawn()))
    }

    /// Writes the figures into a folder as SVG and PNG.
    #[pyo3(signature = (folder, *, force=false))]
    fn write_figures(&self, py: Python<'_>, folder: PathBuf, force: bool) -> PyResult<()> {
        places::folder(&folder, force)?;
        py.detach(|| pictures::networks(&folder, &self.simulator, &self.evaluation, &self.logs)).map_err(raised)
    }

    fn _repr_html_(&self, py: Python<'_>) -> String {
        show::below_each_other(&py.detach(|| self.drawn()))
    }

    fn __repr__(&self) -> String {
        format!("<mindgap.Evaluation of {} on {}>", self.names[0], self.names[1])
    }
}

impl Evaluation {
    fn drawn(&self) -> Vec<pictures::NamedFigure> {
        pictures::figures_of_networks(&self.simulator, &self.evaluation, &self.logs)
    }
}

/// Evaluates a simulator's networks on logs, preferably logs that it was not trained on.
#[pyfunction]
pub fn evaluate(py: Python<'_>, simulator: &Simulator, logs: &Logs) -> PyResult<Evaluation> {
    let sound = logs.sound(py, Some(&simulator.inner))?;
    let evaluation = py.detach(|| accuracy::evaluate(&simulator.inner, &sound, |_, _| ())).map_err(raised)?;
    let names = [simulator.name.clone(), logs.name()];
    Ok(Evaluation { evaluation, simulator: simulator.inner.clone(), logs: sound, names })
}
