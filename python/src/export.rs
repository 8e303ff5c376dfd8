//! Onboard programs.

use std::path::Path;
use std::str::FromStr;

use mindgap_applications::export::{self as programs, Format, Options, Program, Subject};
use mindgap_controller_export::ExportError;
use mindgap_controller_export::names::BrickName;
use mindgap_controller_export::onboard::Safety;
use mindgap_controller_export::wiring::Wiring;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyString};

use crate::controller::Controller;
use crate::error::{Error, raised};
use crate::simulator::Simulator;

/// A controller or a simulator.
#[derive(FromPyObject)]
pub enum Exportable<'py> {
    /// A controller.
    Controller(PyRef<'py, Controller>),
    /// A simulator, for its networks.
    Simulator(PyRef<'py, Simulator>),
}

/// Whether steps are logged on a brick, or the name of the logs.
#[derive(FromPyObject)]
pub enum Log {
    /// Whether they are.
    Is(bool),
    /// Name of the logs.
    Named(String),
}

/// Exports a controller as an onboard program, or a simulator's networks as constants for a board.
#[pyfunction]
#[pyo3(signature = (
    what, format, *, name="controller", left="B", right="C", sonar="4", log=Log::Is(false), display=false, stop_cm=None,
    stall=false, monitor=false,
))]
#[expect(clippy::too_many_arguments, reason = "the options of the command")]
pub fn export<'py>(
    py: Python<'py>,
    what: Exportable<'py>,
    format: &str,
    name: &str,
    left: &str,
    right: &str,
    sonar: &str,
    log: Log,
    display: bool,
    stop_cm: Option<i64>,
    stall: bool,
    monitor: bool,
) -> PyResult<Bound<'py, PyAny>> {
    let log = match log {
        Log::Is(is_logged) => is_logged.then_some(None),
        Log::Named(name) => Some(Some(parsed::<BrickName>(&name)?)),
    };
    let stop_cm = stop_cm.map(stop_distance).transpose()?;
    let options = Options {
        format: format.parse().map_err(Error::new_err)?,
        file: Path::new(name),
        wiring: Wiring { left: parsed(left)?, right: parsed(right)?, sonar: parsed(sonar)? },
        safety: Safety { stop_cm, stall },
        log,
        display,
        monitor,
    };
    let exported = match &what {
        Exportable::Controller(controller) => programs::export(&Subject::Controller(&controller.file), &options),
        Exportable::Simulator(simulator) => programs::export(&Subject::Simulator(&simulator.inner), &options),
    };
    let Program { content, .. } = exported.map_err(raised)?;
    Ok(match options.format {
        Format::Rxe => PyBytes::new(py, &content).into_any(),
        _ => PyString::from_bytes(py, &content)?.into_any(),
    })
}

fn stop_distance(cm: i64) -> PyResult<u8> {
    let valid = u8::try_from(cm).ok().filter(|cm| (1..=254).contains(cm));
    valid.ok_or_else(|| Error::new_err(format!("stop_cm = {cm} lies outside 1..254")))
}

fn parsed<T: FromStr<Err = ExportError>>(text: &str) -> PyResult<T> {
    text.parse().map_err(|why: ExportError| Error::new_err(why.to_string()))
}
