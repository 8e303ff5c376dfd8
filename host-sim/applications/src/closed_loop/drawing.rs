//! The figure of a loop: predicted and real paths of every trial.

use std::path::Path;

use glam::DVec2;

use super::state::{DrivenRun, State, Trial};
use mindgap_figures::report;
use mindgap_figures::report::paths::{PathPanel, Trace};
use mindgap_foundations::error::Result;
use mindgap_foundations::geometry::Pose;
use mindgap_logs::{Scene, Termination};
use mindgap_models::simulator::rollout::REACHED_CM;

/// Writes the figure `paths` into the folder of a loop.
///
/// # Errors
/// If it cannot be written.
pub fn paths(folder: &Path, scene: &Scene, start: Pose, state: &State) -> Result<()> {
    let panel = |trial: &Trial| {
        let real = trial.real.as_ref()?;
        Some(PathPanel {
            title: title(trial, real),
            scene: scene.clone(),
            start,
            target_radius_cm: REACHED_CM,
            simulated: trial.predicted_paths.iter().map(|path| trace(&path.path_cm, path.ending)).collect(),
            real: vec![trace(&real.path_cm, real.ending)],
        })
    };
    let panels: Vec<PathPanel> = state.trials.iter().filter_map(panel).collect();
    report::paths(&panels).write(folder, "paths")
}

fn title(trial: &Trial, real: &DrivenRun) -> String {
    let went = match real.reached {
        true => "reached".into(),
        false => format!("{}, {:.0} cm off", real.ending, real.distance_cm),
    };
    format!("Trial {}: {went}", trial.number)
}

fn trace(path_cm: &[[f64; 2]], ending: Termination) -> Trace {
    Trace { points_cm: path_cm.iter().copied().map(DVec2::from).collect(), crashed: ending == Termination::Crashed }
}
