//! Final-position error: the distance between the predicted and the logged final positions of a controller's runs.

use glam::DVec2;
use mindgap_core::controller::Controller;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use mindgap_foundations::error::{Error, Result};
use mindgap_foundations::geometry::Pose;
use mindgap_foundations::statistics::summary::median;
use mindgap_logs::Logs;
use mindgap_models::simulator::environment::Environment;
use mindgap_models::simulator::rollout_report::RolloutReport;
use mindgap_models::simulator::{Noise, Simulator};

/// Median distances between logged and expected final positions of a controller's runs.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FinalPositionErrors {
    /// Number of runs with a pose at the first row and a later one.
    pub runs: usize,
    /// Error of the simulator as it is, cm.
    pub before_cm: f64,
    /// Error with the effects added, cm; the same as before if there are none.
    pub after_cm: f64,
    /// Distance of simulated runs with the effects from their own expected final position, cm.
    pub floor_cm: f64,
}

/// Simulated runs per logged start.
const DRAWS: usize = 64;
/// Added to the seed, so that these draws are independent of those of a diagnosis.
const STREAM: u64 = 5;

/// Compares logs of a controller's runs with the simulator as it is (first) and with effects added (second). `seed` fixes the
/// noise of the simulated runs.
///
/// # Errors
/// If no run has a pose at its first row and at a later one, or if the simulator cannot run a controller from there.
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
        return Err(Error::new("no run has a pose at its first row and at a later one: no final position is known"));
    }
    let [before, after] = simulators.map(|simulator| Distances::of(simulator, controller, logs, &logged, seed));
    let (before, after) = (before?, after?);
    Ok(FinalPositionErrors {
        runs: logged.len(),
        before_cm: median(before.logged_cm.into_iter()),
        after_cm: median(after.logged_cm.into_iter()),
        floor_cm: median(after.simulated_cm.into_iter()),
    })
}

/// Distances from the final positions that a simulator expects.
struct Distances {
    /// Those of the logged final positions.
    logged_cm: Vec<f64>,
    /// Those of the simulated final positions.
    simulated_cm: Vec<f64>,
}

impl Distances {
    fn of(
        simulator: &Simulator,
        controller: &Controller,
        logs: &Logs,
        logged: &[(Pose, DVec2)],
        seed: u64,
    ) -> Result<Self> {
        let mut distances = Distances { logged_cm: Vec::new(), simulated_cm: Vec::new() };
        for (run, (start, end)) in logged.iter().enumerate() {
            let environment = Environment::new(simulator, &logs.scene, *start, Noise::Learned)?;
            let seed = seed.wrapping_add(STREAM + run as u64);
            let drawn = RolloutReport::new(&environment, &logs.scene, controller, DRAWS, seed);
            let drawn: Vec<DVec2> = drawn.runs.iter().map(|run| DVec2::new(run.end_x_cm, run.end_y_cm)).collect();
            let expected = DVec2::new(median(drawn.iter().map(|e| e.x)), median(drawn.iter().map(|e| e.y)));
            distances.logged_cm.push(expected.distance(*end));
            distances.simulated_cm.extend(drawn.iter().map(|e| expected.distance(*e)));
        }
        Ok(distances)
    }
}
