//! The figures of the demo: 2, 3 and 4 of the paper.

use std::path::Path;

use glam::{DVec2, DVec3};

use super::Trial;
use crate::error::Result;
use crate::evaluation::accuracy::Evaluation;
use crate::learn::dataset::{Dataset, Datasets};
use crate::logs::{Logs, Scene};
use crate::report;
use crate::report::expected_against_predicted::{Panel, Samples};
use crate::report::paths::{PathPanel, Trace};
use crate::report::sonar_surfaces::Surface;
use crate::simulator::Simulator;
use crate::simulator::rollout::REACHED_CM;

/// Figure 3 shows one test sample in this many, so that single ones are visible.
const EVERY: usize = 4;

/// Figure 2, expected against predicted, and figure 3, the sonar surfaces.
pub fn networks(out: &Path, simulator: &Simulator, evaluation: &Evaluation, held_out: &Logs) -> Result<()> {
    let n = &evaluation.networks;
    let values = [
        ("Forward", "cm", &n.forward),
        ("Lateral", "cm", &n.lateral),
        ("Turn", "deg", &n.turn),
        ("Echo reading", "cm", &n.echo_value),
    ];
    let mut panels: Vec<Panel> = values
        .into_iter()
        .filter_map(|(title, unit, value)| {
            let pairs = value.as_ref()?.points.iter().map(|p| DVec2::from_array(*p)).collect();
            Some(Panel { title: title.into(), samples: Samples::Values { unit: unit.into(), pairs } })
        })
        .collect();
    if let Some(probability) = &n.echo_probability {
        let events = probability.points.iter().map(|[happened, predicted]| (*predicted, *happened > 0.5)).collect();
        panels.insert(3, Panel { title: "Echo probability".into(), samples: Samples::Events(events) });
    }
    report::expected_against_predicted(&panels).write(out, "figure-2-expected-against-predicted")?;
    let probability = &simulator.need(&simulator.echo_probability, "echo_probability")?.network;
    let value = &simulator.need(&simulator.echo_value, "echo_value")?.network;
    let data = Datasets::from_logs(held_out);
    let max_cm = simulator.robot.ultrasonic.max_cm;
    let ask = |network: &mindgap_core::network::Network<f32, 2>, d: f64, alpha: f64| {
        f64::from(network.evaluate([d as f32, alpha as f32]))
    };
    let surface = |title: &str, value_name: &str, at, value, data: &Dataset<2>| Surface {
        title: title.into(),
        value_name: value_name.into(),
        at,
        distance_cm: 0.0..max_cm,
        incidence_deg: 0.0..90.0,
        value,
        test: test_points(data),
    };
    let probability = |d: f64, alpha: f64| ask(probability, d, alpha);
    let value = |d: f64, alpha: f64| ask(value, d, alpha);
    let surfaces = [
        surface(
            "Probability of an echo",
            "probability",
            &probability as &dyn Fn(f64, f64) -> f64,
            0.0..1.0,
            &data.echo_probability,
        ),
        surface("Reading", "reading (cm)", &value, 0.0..max_cm, &data.echo_value),
    ];
    report::sonar_surfaces(&surfaces).write(out, "figure-3-sonar-surfaces")
}

/// Figure 4: simulated and real paths, a panel a start.
pub fn paths(out: &Path, scene: &Scene, trials: &[Trial]) -> Result<()> {
    let panels: Vec<PathPanel> = trials
        .iter()
        .zip(&scene.starts)
        .enumerate()
        .map(|(i, (trial, start))| PathPanel {
            title: format!("Start {}", i + 1),
            scene: scene.clone(),
            start: *start,
            target_radius_cm: REACHED_CM,
            simulated: trial.rollouts.runs.iter().map(simulated).collect(),
            real: trial.trajectories.iter().map(real).collect(),
        })
        .collect();
    report::paths(&panels).write(out, "figure-4-simulated-and-real-paths")
}

fn simulated(run: &crate::simulator::rollout_report::Rollout) -> Trace {
    let points_cm = run.path.iter().map(|p| DVec2::new(p.x_cm, p.y_cm)).collect();
    Trace { points_cm, crashed: run.termination == "crashed" }
}

fn real(trajectory: &crate::built_in_robot::Trajectory) -> Trace {
    let points_cm = trajectory.points.iter().map(|m| m.true_pose.position_cm).collect();
    Trace { points_cm, crashed: trajectory.termination == crate::built_in_robot::Termination::Crashed }
}

fn test_points(data: &Dataset<2>) -> Vec<DVec3> {
    let samples = data.inputs.iter().zip(&data.targets).step_by(EVERY);
    samples.map(|(x, target)| DVec3::new(f64::from(x[0]), f64::from(x[1]), f64::from(*target))).collect()
}
