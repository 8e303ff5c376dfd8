//! A simulated robot that Python drives step by step.

use std::sync::Arc;

use mindgap_foundations::geometry::Pose;
use mindgap_foundations::random::{Generator, generator};
use mindgap_logs::Scene;
use mindgap_models::simulator::body::{BodyState, SimulatedBody};
use mindgap_models::simulator::environment::Environment;
use mindgap_models::simulator::rollout::REACHED_CM;
use mindgap_models::simulator::{self, Noise};
use pyo3::prelude::*;
use pyo3::types::{IntoPyDict, PyDict};

use crate::convert;
use crate::error::{Error, raised};
use crate::simulator::Simulator;

/// A simulated robot in a scene.
#[pyclass(module = "mindgap")]
pub struct SimulatedRobot {
    simulator: Arc<simulator::Simulator>,
    scene: Scene,
    start: Pose,
    rng: Generator,
    state: BodyState,
    steps: u32,
    echo_cm: Option<f64>,
}

#[pymethods]
impl SimulatedRobot {
    #[new]
    #[pyo3(signature = (simulator, scene, *, start=1, seed=1))]
    fn new(simulator: &Simulator, scene: &Bound<PyAny>, start: usize, seed: u64) -> PyResult<Self> {
        SimulatedRobot::at(simulator, convert::scene(scene)?, start, seed)
    }

    /// What the robot sees at the beginning of the next step.
    #[getter]
    pub fn seen<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let [x_cm, y_cm, heading_deg] = self.pose();
        let known = [("t_ms", self.t_ms()), ("x_cm", x_cm), ("y_cm", y_cm), ("heading_deg", heading_deg)];
        let seen = known.into_py_dict(py)?;
        seen.set_item("echo_cm", self.echo_cm)?;
        Ok(seen)
    }

    /// Drives for one step, and returns what the robot sees then. A robot that touches something stays there.
    pub fn drive<'py>(&mut self, py: Python<'py>, left: f64, right: f64) -> PyResult<Bound<'py, PyDict>> {
        if ![left, right].iter().all(|command| (-100.0..=100.0).contains(command)) {
            let problem = format!("step {}: commands {left} and {right}: both must lie in -100..100", self.steps);
            return Err(Error::new_err(problem));
        }
        let step_ms = self.simulator.robot.step_ms;
        self.act(|body, rng| body.drive([left, right], step_ms, rng))?;
        self.steps += 1;
        self.seen(py)
    }

    /// The scene, as in scene.toml.
    #[getter]
    fn scene<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        convert::scene_facts(py, &self.scene)
    }

    /// Whether the robot has touched something.
    #[getter]
    pub fn crashed(&self) -> bool {
        self.state.crashed()
    }

    /// Distance to the target, cm; None if the scene has no target.
    #[getter]
    fn distance_cm(&self) -> Option<f64> {
        self.scene.target_cm.map(|target_cm| self.state.pose().position_cm.distance(target_cm))
    }

    /// Whether the robot is at the target without having touched anything; None if the scene has no target.
    #[getter]
    fn reached(&self) -> Option<bool> {
        self.distance_cm().map(|distance_cm| !self.crashed() && distance_cm <= REACHED_CM)
    }

    fn __repr__(&self) -> String {
        let [x_cm, y_cm, heading_deg] = self.pose();
        format!("<mindgap.SimulatedRobot at {x_cm:.1} cm, {y_cm:.1} cm, {heading_deg:.0} degrees>")
    }
}

impl SimulatedRobot {
    /// Returns a robot at rest at a start of a scene.
    pub fn at(simulator: &Simulator, scene: Scene, start: usize, seed: u64) -> PyResult<Self> {
        let simulator = simulator.inner.clone();
        let start = scene.start(start, simulator.robot.body_radius_cm).map_err(raised)?;
        let (rng, state) = (generator(seed, &[]), BodyState::at_rest(start));
        let mut robot = SimulatedRobot { simulator, scene, start, rng, state, steps: 0, echo_cm: None };
        robot.act(|_, _| ())?;
        Ok(robot)
    }

    /// Returns the time since the start, ms.
    pub fn t_ms(&self) -> f64 {
        f64::from(self.steps) * self.simulator.robot.step_ms
    }

    /// Returns the position, cm, and the heading, degrees.
    pub fn pose(&self) -> [f64; 3] {
        let Pose { position_cm, heading_rad, .. } = self.state.pose();
        [position_cm.x, position_cm.y, heading_rad.to_degrees()]
    }

    /// Returns the latest reading, cm; `None` if the sensor gave no value.
    pub fn echo_cm(&self) -> Option<f64> {
        self.echo_cm
    }

    /// Lets the robot act, and then read its sensor.
    fn act(&mut self, action: impl FnOnce(&mut SimulatedBody, &mut Generator)) -> PyResult<()> {
        // It is prepared for every step: it borrows its simulator, and an object of Python cannot borrow.
        let environment = Environment::new(&self.simulator, &self.scene, self.start, Noise::Learned).map_err(raised)?;
        let mut body = SimulatedBody::resumed(&environment, &self.scene, self.state.clone());
        action(&mut body, &mut self.rng);
        self.echo_cm = body.read_sonar(&mut self.rng);
        self.state = body.into_state();
        Ok(())
    }
}
