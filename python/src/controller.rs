//! Controllers, and their evolution.

use std::path::PathBuf;

use mindgap_command::kinds;
use mindgap_core::controller::Tuple;
use mindgap_figures::pictures;
use mindgap_learning::evolve::request::{Answered, Request};
use mindgap_learning::evolve::success_probability::SuccessProbability;
use mindgap_logs::Scene;
use mindgap_logs::controller_file::{ControllerFile, Origin};
use mindgap_models::simulator::Noise;
use mindgap_models::simulator::environment::SensorModel;
use mindgap_workers::Workers;
use pyo3::prelude::*;
use serde::Serialize;

use crate::error::raised;
use crate::interrupt::interruptible;
use crate::show::{self, Figure};
use crate::simulator::Simulator;
use crate::{convert, places};

/// A six-tuple controller.
#[pyclass(frozen, module = "mindgap")]
pub struct Controller {
    /// The controller and its origin.
    pub file: ControllerFile,
    /// Its name in pages.
    pub name: String,
}

/// A controller, as in controller.toml.
#[derive(Serialize)]
struct Facts<'a> {
    step_ms: u16,
    max_steps: u16,
    tuple: &'a [Tuple],
    origin: Option<&'a Origin>,
}

#[pymethods]
impl Controller {
    /// Reads a controller file.
    #[staticmethod]
    fn read(path: PathBuf) -> PyResult<Self> {
        Ok(Controller { file: ControllerFile::read(&path).map_err(raised)?, name: path.display().to_string() })
    }

    /// Writes a controller file; replacing anything that mindgap did not evolve needs `force`.
    #[pyo3(signature = (path, *, force=false))]
    fn write(&self, path: PathBuf, force: bool) -> PyResult<()> {
        places::file(&path, kinds::CONTROLLER, force)?;
        self.file.write(&path).map_err(raised)
    }

    /// The contents of its file.
    #[getter]
    fn facts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let ControllerFile { controller, origin, .. } = &self.file;
        let (step_ms, max_steps) = (controller.step_ms, controller.max_steps);
        convert::facts(py, &Facts { step_ms, max_steps, tuple: &controller.tuples, origin: origin.as_ref() })
    }

    /// Its six tuples, as a frame.
    #[getter]
    fn tuples<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        convert::frame(py, &self.file.controller.tuples.as_slice())
    }

    fn __repr__(&self) -> String {
        format!("<mindgap.Controller {}>", self.name)
    }
}

/// An evolved controller and its success in simulation.
#[pyclass(frozen, module = "mindgap")]
pub struct Evolution {
    answered: Answered,
    origin: Origin,
    scene: Scene,
}

/// The success of a controller in simulation and its origin, as `mindgap evolve --json` writes them.
#[derive(Serialize)]
struct Success {
    start: usize,
    seed: u64,
    generations: usize,
    fitness: f64,
    success: f64,
    crashed: f64,
    median_cm: f64,
    chance: Option<SuccessProbability>,
}

#[pymethods]
impl Evolution {
    /// The controller.
    #[getter]
    fn controller(&self) -> Controller {
        let file = ControllerFile {
            controller: self.answered.evolved.controller.clone(),
            sensors: Default::default(),
            origin: Some(self.origin.clone()),
        };
        Controller { file, name: "a controller from Python".into() }
    }

    /// Success and crashes in fresh simulated runs, the median distance to the target, the probability of success over the
    /// posterior of robots, and how it was evolved.
    #[getter]
    fn facts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let Answered { evolved, success, chance, .. } = &self.answered;
        let &Origin { start, seed, generations, .. } = &self.origin;
        let fitness = evolved.fitness;
        let (crashed, median_cm) = (success.crashed, success.median_cm);
        let success = success.rate;
        convert::facts(py, &Success { start, seed, generations, fitness, success, crashed, median_cm, chance: *chance })
    }

    /// Returns the figures of `mindgap evolve --figures`.
    fn figures(&self, py: Python<'_>) -> PyResult<Vec<Figure>> {
        Ok(show::figures(py.detach(|| self.drawn())?))
    }

    fn _repr_html_(&self, py: Python<'_>) -> PyResult<String> {
        Ok(show::below_each_other(&py.detach(|| self.drawn())?))
    }

    fn __repr__(&self) -> String {
        format!("<mindgap.Evolution: {:.0} % reach the target in simulation>", 100.0 * self.answered.success.rate)
    }
}

impl Evolution {
    fn drawn(&self) -> PyResult<Vec<pictures::NamedFigure>> {
        let start = self.scene.start(self.origin.start, 0.0).map_err(raised)?;
        let title = format!("Start {}", self.origin.start);
        let panel = pictures::simulated_paths(title, &self.scene, start, &self.answered.rollouts);
        Ok(vec![pictures::figure_of_paths(&[panel])])
    }
}

/// Evolves one controller for a start of a scene in a simulator.
#[pyfunction]
#[pyo3(signature = (simulator, scene, *, start=1, max_steps=60, seed=1))]
pub fn evolve(
    py: Python<'_>,
    simulator: &Simulator,
    scene: &Bound<PyAny>,
    start: usize,
    max_steps: u16,
    seed: u64,
) -> PyResult<Evolution> {
    let scene = convert::scene(scene)?;
    let request = Request {
        executor: &Workers::default(),
        simulator: &simulator.inner,
        scene: &scene,
        start,
        max_steps,
        paper: false,
        noise: Noise::Learned,
        sensor: SensorModel::Beam,
        seed,
    };
    let answered = interruptible(py, |interrupt| request.evolve(|_, _| interrupt.check()))?.map_err(raised)?;
    let origin = Origin {
        simulator: simulator.name.clone(),
        scene: "a scene from Python".into(),
        start,
        seed,
        generations: answered.evolved.generations,
        fitness: Some(answered.evolved.fitness),
        success: answered.success.rate,
    };
    Ok(Evolution { answered, origin, scene })
}
