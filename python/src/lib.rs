//! The Python package `mindgap`: arrays and frames in, the library's work, and dicts, frames and pictures out.
//!
//! It holds no logic of its own: each function calls what the command of its name calls, with the interpreter released
//! meanwhile. Types and words for users are in `mindgap.pyi` and `docs/how-to/python.md`.

mod controller;
mod convert;
mod diagnosis;
mod error;
mod evaluation;
mod interrupt;
mod logs;
mod places;
mod show;
mod simulation;
mod simulator;

use pyo3::prelude::*;

/// Finds the gap between a small robot and its simulator, and evolves controllers that cross it.
#[pymodule]
mod mindgap {
    #[pymodule_export]
    use super::controller::{Controller, Evolution, evolve};
    #[pymodule_export]
    use super::diagnosis::{Diagnosis, diagnose};
    #[pymodule_export]
    use super::error::Error;
    #[pymodule_export]
    use super::evaluation::{Evaluation, evaluate};
    #[pymodule_export]
    use super::logs::{Logs, record};
    #[pymodule_export]
    use super::show::{Figure, Page};
    #[pymodule_export]
    use super::simulation::{Simulation, simulate};
    #[pymodule_export]
    use super::simulator::{Simulator, train};

    #[pymodule_export]
    #[expect(non_upper_case_globals, reason = "Python's name for it")]
    const __version__: &str = env!("CARGO_PKG_VERSION");
}
