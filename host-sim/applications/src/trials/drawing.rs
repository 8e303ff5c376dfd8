//! The picture of a loop: the paths that were predicted for every trial, and the real one.

use std::path::Path;

use glam::DVec2;

use super::state::{Real, State, Trial};
use mindgap_figures::report;
use mindgap_figures::report::paths::{PathPanel, Trace};
use mindgap_foundations::error::Result;
use mindgap_foundations::geometry::Pose;
use mindgap_logs::{Scene, Termination};
use mindgap_models::simulator::rollout::REACHED_CM;

/// Draws `paths.svg` and `paths.png` into the folder of a loop.
///
/// # Errors
/// When they cannot be written.
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

fn title(trial: &Trial, real: &Real) -> String {
    let went = match real.reached {
        true => "reached".into(),
        false => format!("{}, {:.0} cm off", real.ending, real.distance_cm),
    };
    format!("Trial {}: {went}", trial.number)
}

fn trace(path_cm: &[[f64; 2]], ending: Termination) -> Trace {
    Trace { points_cm: path_cm.iter().copied().map(DVec2::from).collect(), crashed: ending == Termination::Crashed }
}
