//! Final-position error: the distance between the predicted and the logged final positions of a controller's runs.

use glam::DVec2;
use mindgap_core::controller::Controller;
use serde::{Deserialize, Serialize};

use mindgap_foundations::error::{Error, Result};
use mindgap_foundations::geometry::Pose;
use mindgap_foundations::statistics::summary::median;
use mindgap_logs::Logs;
use mindgap_models::simulator::environment::Environment;
use mindgap_models::simulator::rollout_report::RolloutReport;
use mindgap_models::simulator::{Noise, Simulator};

/// How far the runs of a controller end from where they are expected to, as medians over the runs, cm.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FinalPositionErrors {
    /// Runs with a pose at the first row and a later one.
    pub runs: usize,
    /// With the simulator as it is.
    pub before_cm: f64,
    /// With the effects added; the same where none is.
    pub after_cm: f64,
    /// How far simulated runs with the effects end from where they are expected to themselves.
    pub floor_cm: f64,
}

/// Simulated runs from each logged start.
const DRAWS: usize = 64;
/// Added to the seed, so that these draws are not those of a diagnosis.
const STREAM: u64 = 5;

/// Compares logs of a controller's runs with the simulator as it is (first) and with effects added (second). Simulated
/// runs draw from `seed`.
///
/// # Errors
/// When no run has a pose at its first row and at a later one, or when the simulator cannot run a controller from there.
pub fn final_position_errors(
    simulators: [&Simulator; 2],
    controller: &Controller,
    logs: &Logs,
    seed: u64,
) -> Result<FinalPositionErrors> {
    let logged: Vec<(Pose, DVec2)> = logs
        .runs
        .iter()
        .filter_map(|run| {
            let end = run.rows.between(1..run.rows.len()).rev().find_map(|row| row.pose)?;
            Some((run.rows.at(0).pose?, end.position_cm))
        })
        .collect();
    if logged.is_empty() {
        return Err(Error::new(
            "no run has a pose at its first row and at a later one: where a controller ends is not known",
        ));
    }
    let [before, after] = simulators.map(|simulator| Ends::of(simulator, controller, logs, &logged, seed));
    let (before, after) = (before?, after?);
    Ok(FinalPositionErrors {
        runs: logged.len(),
        before_cm: median(before.off_cm.into_iter()),
        after_cm: median(after.off_cm.into_iter()),
        floor_cm: median(after.scatter_cm.into_iter()),
    })
}

/// Distances from where a simulator expects the runs to end.
struct Ends {
    /// Of the logged ends.
    off_cm: Vec<f64>,
    /// Of its own.
    scatter_cm: Vec<f64>,
}

impl Ends {
    fn of(
        simulator: &Simulator,
        controller: &Controller,
        logs: &Logs,
        logged: &[(Pose, DVec2)],
        seed: u64,
    ) -> Result<Self> {
        let mut ends = Ends { off_cm: Vec::new(), scatter_cm: Vec::new() };
        for (run, (start, end)) in logged.iter().enumerate() {
            let environment = Environment::new(simulator, &logs.scene, *start, Noise::Learned)?;
            let drawn = RolloutReport::new(
                &environment,
                &logs.scene,
                controller,
                DRAWS,
                seed.wrapping_add(STREAM + run as u64),
            );
            let drawn: Vec<DVec2> = drawn.runs.iter().map(|run| DVec2::new(run.end_x_cm, run.end_y_cm)).collect();
            let expected = DVec2::new(median(drawn.iter().map(|e| e.x)), median(drawn.iter().map(|e| e.y)));
            ends.off_cm.push(expected.distance(*end));
            ends.scatter_cm.extend(drawn.iter().map(|e| expected.distance(*e)));
        }
        Ok(ends)
    }
}
