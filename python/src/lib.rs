//! The Python package `mindgap`: arrays and frames in, the library's work, and dicts, frames and pictures out.
//!
//! It has no logic of its own: each function calls the same code as the command of its name, with the interpreter released.
//! The folder `mindgap` is the package around it: types and documentation for users (`__init__.pyi`), and the environment of
//! Gymnasium (`env.py`). See also `docs/how-to/python.md`.

mod adaptation;
mod comparison;
mod controller;
mod convert;
mod diagnosis;
mod error;
mod evaluation;
mod export;
mod import;
mod interrupt;
mod logs;
mod places;
mod rollout;
mod show;
mod simulated_robot;
mod simulation;
mod simulator;

use pyo3::prelude::*;

/// Finds the gap between a small robot and its simulator, and evolves controllers that cross it.
#[pymodule]
mod mindgap {
    #[pymodule_export]
    use super::adaptation::{Adaptation, adapt};
    #[pymodule_export]
    use super::comparison::{Comparison, compare};
    #[pymodule_export]
    use super::controller::{Controller, Evolution, evolve};
    #[pymodule_export]
    use super::diagnosis::{Diagnosis, diagnose};
    #[pymodule_export]
    use super::error::Error;
    #[pymodule_export]
    use super::evaluation::{Evaluation, evaluate};
    #[pymodule_export]
    use super::export::export;
    #[pymodule_export]
    use super::import::{Imported, import_bags, import_brick, import_streams};
    #[pymodule_export]
    use super::logs::{Logs, record};
    #[pymodule_export]
    use super::rollout::rollout;
    #[pymodule_export]
    use super::show::{Figure, Page};
    #[pymodule_export]
    use super::simulated_robot::SimulatedRobot;
    #[pymodule_export]
    use super::simulation::{Simulation, simulate};
    #[pymodule_export]
    use super::simulator::{Simulator, train};

    #[pymodule_export]
    #[expect(non_upper_case_globals, reason = "name in Python")]
    const __version__: &str = env!("CARGO_PKG_VERSION");
}
