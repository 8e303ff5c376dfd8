//! Long operations that Ctrl-C interrupts, as anything else in Python.

use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::{Mutex, PoisonError};

use pyo3::prelude::*;

/// Checks for interrupts during an operation.
#[derive(Default)]
pub struct Interrupt(Mutex<Option<PyErr>>);

/// Runs an operation with the interpreter released, until a signal handler raises in one of its checks.
///
/// # Errors
/// If the handler raises; the error is what it raised: `KeyboardInterrupt` after Ctrl-C.
pub fn interruptible<T: Send>(py: Python<'_>, work: impl FnOnce(&Interrupt) -> T + Send) -> PyResult<T> {
    let interrupt = Interrupt::default();
    let done = py.detach(|| catch_unwind(AssertUnwindSafe(|| work(&interrupt))));
    let Interrupt(raised) = interrupt;
    match (done, raised.into_inner().unwrap_or_else(PoisonError::into_inner)) {
        (Ok(done), _) => Ok(done),
        (Err(_), Some(raised)) => Err(raised),
        (Err(panic), None) => resume_unwind(panic),
    }
}

impl Interrupt {
    /// Unwinds to [`interruptible`] if a signal handler raises. The library has no other way to stop an operation: its
    /// progress callbacks return nothing.
    pub fn check(&self) {
        if let Err(raised) = Python::attach(|py| py.check_signals()) {
            *self.0.lock().unwrap_or_else(PoisonError::into_inner) = Some(raised);
            resume_unwind(Box::new("interrupted"));
        }
    }
}
