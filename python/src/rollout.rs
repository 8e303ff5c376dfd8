//! A simulated robot under a controller that is written in Python.

use pyo3::prelude::*;
use pyo3::types::IntoPyDict;
use serde::Serialize;

use crate::convert;
use crate::simulated_robot::SimulatedRobot;
use crate::simulator::Simulator;

/// A row of the frame, as in a run of logs.
#[derive(Serialize)]
struct Row {
    t_ms: f64,
    left: f64,
    right: f64,
    x_cm: f64,
    y_cm: f64,
    heading_deg: f64,
    echo_cm: Option<f64>,
}

/// Drives a simulated robot by a controller that is called once per step.
#[pyfunction]
#[pyo3(signature = (simulator, controller, scene, *, start=1, steps=100, seed=1))]
pub fn rollout<'py>(
    py: Python<'py>,
    simulator: &Simulator,
    controller: &Bound<'py, PyAny>,
    scene: &Bound<'py, PyAny>,
    start: usize,
    steps: u32,
    seed: u64,
) -> PyResult<Bound<'py, PyAny>> {
    let mut robot = SimulatedRobot::at(simulator, convert::scene(scene)?, start, seed)?;
    let mut rows = Vec::new();
    let mut seen = robot.seen(py)?;
    for _ in 0..steps {
        let (left, right) = controller.call1((seen,))?.extract::<(f64, f64)>()?;
        rows.push(Row::of(&robot, [left, right]));
        seen = robot.drive(py, left, right)?;
        if robot.crashed() {
            break;
        }
    }
    rows.push(Row::of(&robot, [0.0, 0.0]));
    let frame = convert::frame(py, &rows)?;
    let attributes = [("crashed", robot.crashed())].into_py_dict(py)?;
    frame.getattr("attrs")?.call_method1("update", (attributes,))?;
    Ok(frame)
}

impl Row {
    fn of(robot: &SimulatedRobot, [left, right]: [f64; 2]) -> Self {
        let [x_cm, y_cm, heading_deg] = robot.pose();
        Row { t_ms: robot.t_ms(), left, right, x_cm, y_cm, heading_deg, echo_cm: robot.echo_cm() }
    }
}
