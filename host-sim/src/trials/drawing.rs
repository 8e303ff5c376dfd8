//! The picture of a loop: the path of every trial, simulated before and real after it.

use std::path::Path;

use glam::DVec2;

use super::state::{State, Trial};
use crate::error::Result;
use crate::evolve::controller_file::ControllerFile;
use crate::geometry::Pose;
use crate::logs::{Run, Scene};
use crate::report;
use crate::report::paths::{PathPanel, Trace};
use crate::simulator::environment::Environment;
use crate::simulator::rollout::REACHED_CM;
use crate::simulator::rollout_report::{Rollout, RolloutReport};
use crate::simulator::{Noise, Simulator};
use crate::trials::state::Ending;

/// Simulated runs of each controller.
const SIMULATED: usize = 5;
const SEED: u64 = 1;

/// Draws `paths.svg` and `paths.png` into the folder of a loop.
///
/// # Errors
/// When a file of the folder cannot be read or written.
pub fn paths(folder: &Path, simulator: &Simulator, scene: &Scene, start: Pose, state: &State) -> Result<()> {
    let environment = Environment::new(simulator, scene, start, Noise::Learned)?;
    let mut panels = Vec::new();
    for trial in &state.trials {
        let Some(real) = &trial.real else { continue };
        let controller = ControllerFile::read(&folder.join(&trial.controller))?.controller;
        let run = Run::read(&folder.join(&trial.log), |_| {})?;
        let points_cm = run.rows.iter().map(|row| row.pose.map_or(DVec2::NAN, |pose| pose.position_cm)).collect();
        panels.push(PathPanel {
            title: title(trial),
            scene: scene.clone(),
            start,
            target_radius_cm: REACHED_CM,
            simulated: RolloutReport::new(&environment, scene, &controller, SIMULATED, SEED)
                .runs
                .iter()
                .map(trace)
                .collect(),
            real: vec![Trace { points_cm, crashed: real.ending == Ending::Crashed }],
        });
    }
    report::paths(&panels).write(folder, "paths")
}

fn title(trial: &Trial) -> String {
    let went = trial.real.as_ref().map_or(String::new(), |real| match real.reached {
        true => "reached".into(),
        false => format!("{}, {:.0} cm off", real.ending, real.distance_cm),
    });
    format!("Trial {}: {went}", trial.number)
}

fn trace(run: &Rollout) -> Trace {
    let points_cm = run.path.iter().map(|p| DVec2::new(p.x_cm, p.y_cm)).collect();
    Trace { points_cm, crashed: run.termination == "crashed" }
}
