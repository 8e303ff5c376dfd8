//! A simulated robot under a controller that is written in Python.

use mindgap_foundations::random::{Generator, generator};
use mindgap_models::simulator::Noise;
use mindgap_models::simulator::body::SimulatedBody;
use mindgap_models::simulator::environment::Environment;
use pyo3::prelude::*;
use pyo3::types::IntoPyDict;
use serde::Serialize;

use crate::convert;
use crate::error::{Error, raised};
use crate::simulator::Simulator;

/// A row of the frame, as in a run of logs.
#[derive(Serialize)]
struct Row {
    t_ms: f64,
    left: f64,
    right: f64,
    #[serde(flatten)]
    seen: Seen,
}

/// What the controller sees.
#[derive(Clone, Copy, Serialize)]
struct Seen {
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
    let scene = convert::scene(scene)?;
    let robot = simulator.inner.robot;
    let pose = scene.start(start, robot.body_radius_cm).map_err(raised)?;
    let environment = Environment::new(&simulator.inner, &scene, pose, Noise::Learned).map_err(raised)?;
    let rng = &mut generator(seed, &[]);
    let mut body = SimulatedBody::at_rest(&environment, &scene);
    let mut rows = Vec::new();
    for step in 0..steps {
        let (t_ms, seen) = (f64::from(step) * robot.step_ms, look(&mut body, rng));
        let observation = convert::facts(py, &seen)?;
        observation.set_item("t_ms", t_ms)?;
        let (left, right) = controller.call1((observation,))?.extract::<(f64, f64)>()?;
        if ![left, right].iter().all(|command| (-100.0..=100.0).contains(command)) {
            let problem = format!("step {step}: commands {left} and {right}: both must lie in -100..100");
            return Err(Error::new_err(problem));
        }
        rows.push(Row { t_ms, left, right, seen });
        body.drive([left, right], robot.step_ms, rng);
        if body.crashed() {
            break;
        }
    }
    let t_ms = rows.len() as f64 * robot.step_ms;
    rows.push(Row { t_ms, left: 0.0, right: 0.0, seen: look(&mut body, rng) });
    let frame = convert::frame(py, &rows)?;
    let attributes = [("crashed", body.crashed())].into_py_dict(py)?;
    frame.getattr("attrs")?.call_method1("update", (attributes,))?;
    Ok(frame)
}

fn look(body: &mut SimulatedBody, rng: &mut Generator) -> Seen {
    let (pose, echo_cm) = (body.pose(), body.read_sonar(rng));
    let [x_cm, y_cm] = pose.position_cm.to_array();
    Seen { x_cm, y_cm, heading_deg: pose.heading_rad.to_degrees(), echo_cm }
}
