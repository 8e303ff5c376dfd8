//! What cannot be done, as an exception with the command's one line; what is odd, as a warning.

use std::ffi::CString;

use mindgap_foundations::error;
use pyo3::exceptions::{PyException, PyUserWarning};
use pyo3::prelude::*;

pyo3::create_exception!(mindgap, Error, PyException, "Why something could not be done, in one line.");

/// A problem as an exception.
pub fn raised(problem: error::Error) -> PyErr {
    Error::new_err(problem.to_string())
}

/// Warns of oddities that keep nothing from being done.
pub fn warn(py: Python<'_>, oddities: Vec<String>) -> PyResult<()> {
    let category = py.get_type::<PyUserWarning>();
    oddities.into_iter().try_for_each(|oddity| PyErr::warn(py, &category, &CString::new(oddity)?, 1))
}
