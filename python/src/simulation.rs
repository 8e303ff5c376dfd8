//! A controller's simulated runs.

use std::path::PathBuf;

use mindgap_figures::pictures;
use mindgap_foundations::geometry::Pose;
use mindgap_learning::evolve::trial::Trial;
use mindgap_logs::{Robot, Scene, Termination};
use mindgap_models::simulator::Noise;
use mindgap_models::simulator::environment::SensorModel;
use mindgap_models::simulator::rollout_report::{PathPoint, RolloutReport};
use mindgap_pages::simulation::{Subject, page};
use pyo3::prelude::*;
use serde::Serialize;

use crate::controller::Controller;
use crate::error::raised;
use crate::show::{self, Figure, Page};
use crate::simulator::Simulator;
use crate::{convert, places};

/// Simulated runs of a controller.
#[pyclass(frozen, module = "mindgap")]
pub struct Simulation {
    rollouts: RolloutReport,
    controller: mindgap_core::controller::Controller,
    robot: Robot,
    scene: Scene,
    names: [String; 2],
    start: usize,
    pose: Pose,
    seed: u64,
}

/// The row of a run.
#[derive(Serialize)]
struct Run {
    run: usize,
    ending: Termination,
    steps: u16,
    end_x_cm: f64,
    end_y_cm: f64,
    distance_cm: Option<f64>,
    reached: Option<bool>,
}

/// A row of a run's path.
#[derive(Serialize)]
struct Point<'a> {
    run: usize,
    step: usize,
    #[serde(flatten)]
    point: &'a PathPoint,
}

#[pymethods]
impl Simulation {
    /// The facts of `mindgap simulate --json`.
    #[getter]
    fn facts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        convert::facts(py, &self.rollouts)
    }

    /// Share of the runs that reached the target; None if the scene has no target.
    #[getter]
    fn success(&self) -> Option<f64> {
        self.rollouts.success
    }

    /// How each run ended, as a frame.
    #[getter]
    fn runs<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let runs = self.rollouts.runs.iter().enumerate().map(|(i, run)| Run {
            run: i + 1,
            ending: run.termination,
            steps: run.steps,
            end_x_cm: run.end_x_cm,
            end_y_cm: run.end_y_cm,
            distance_cm: run.distance_cm,
            reached: run.reached,
        });
        convert::frame(py, &runs.collect::<Vec<_>>())
    }

    /// The paths of all runs, step by step, as a frame.
    #[getter]
    fn paths<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let points = self.rollouts.runs.iter().enumerate().flat_map(|(i, run)| {
            run.path.iter().enumerate().map(move |(step, point)| Point { run: i + 1, step, point })
        });
        convert::frame(py, &points.collect::<Vec<_>>())
    }

    /// Returns the page of `mindgap simulate --html`.
    fn page(&self, py: Python<'_>) -> PyResult<Page> {
        let [simulator, controller] = self.names.each_ref().map(String::as_str);
        let subject = Subject {
            rollouts: &self.rollouts,
            controller: &self.controller,
            robot: &self.robot,
            scene: &self.scene,
            names: [simulator, controller, "a scene from Python"],
            start: self.start,
            seed: self.seed,
        };
        Page::made(py.detach(|| page(&subject)))
    }

    /// Returns the figures of `mindgap simulate --figures`.
    fn figures(&self, py: Python<'_>) -> Vec<Figure> {
        show::figures(py.detach(|| vec![pictures::figure_of_paths(&[self.panel()])]))
    }

    /// Writes the figures into a folder as SVG and PNG.
    #[pyo3(signature = (folder, *, force=false))]
    fn write_figures(&self, py: Python<'_>, folder: PathBuf, force: bool) -> PyResult<()> {
        places::folder(&folder, force)?;
        py.detach(|| pictures::paths(&folder, &[self.panel()])).map_err(raised)
    }

    fn _repr_html_(&self, py: Python<'_>) -> String {
        show::below_each_other(&py.detach(|| vec![pictures::figure_of_paths(&[self.panel()])]))
    }

    fn __repr__(&self) -> String {
        let success = self.success().map_or_else(String::new, |s| format!(", {:.0} % reach the target", 100.0 * s));
        format!("<mindgap.Simulation of {} runs{success}>", self.rollouts.runs.len())
    }
}

impl Simulation {
    fn panel(&self) -> mindgap_figures::report::paths::PathPanel {
        pictures::simulated_paths(format!("Start {}", self.start), &self.scene, self.pose, &self.rollouts)
    }
}

/// Runs a controller in a simulator; each run samples a robot from the posterior.
#[pyfunction]
#[pyo3(signature = (simulator, controller, scene, *, start=1, runs=10, seed=1))]
pub fn simulate(
    py: Python<'_>,
    simulator: &Simulator,
    controller: &Controller,
    scene: &Bound<PyAny>,
    start: usize,
    runs: usize,
    seed: u64,
) -> PyResult<Simulation> {
    let scene = convert::scene(scene)?;
    let robot = simulator.inner.robot;
    controller.file.check_for(&robot).map_err(raised)?;
    let pose = scene.start(start, robot.body_radius_cm).map_err(raised)?;
    let trial = Trial {
        simulator: &simulator.inner,
        controller: &controller.file.controller,
        scene: &scene,
        start: pose,
        noise: Noise::Learned,
        sensor: SensorModel::Beam,
        runs,
        seed,
    };
    let rollouts = py.detach(|| trial.run(|_, _| ())).map_err(raised)?;
    let controller = controller.file.controller.clone();
    let names = [simulator.name.clone(), "a controller from Python".into()];
    Ok(Simulation { rollouts, controller, robot, scene, names, start, pose, seed })
}
