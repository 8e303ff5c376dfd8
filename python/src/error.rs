//! Errors as exceptions with the command's one-line message, and oddities as warnings.

use std::ffi::CString;

use mindgap_foundations::error;
use pyo3::exceptions::{PyException, PyUserWarning};
use pyo3::prelude::*;

pyo3::create_exception!(mindgap, Error, PyException, "An operation that failed; the message is one line.");

/// Converts an error to an exception.
pub fn raised(problem: error::Error) -> PyErr {
    Error::new_err(problem.to_string())
}

/// Warns of oddities that do not prevent the operation.
pub fn warn(py: Python<'_>, oddities: Vec<String>) -> PyResult<()> {
    let category = py.get_type::<PyUserWarning>();
    oddities.into_iter().try_for_each(|oddity| PyErr::warn(py, &category, &CString::new(oddity)?, 1))
}
