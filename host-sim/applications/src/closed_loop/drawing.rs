//! The figure of a loop: predicted and real paths of every trial.

use std::path::Path;

use glam::DVec2;

use super::state::{State, Trial};
use mindgap_figures::report;
use mindgap_figures::report::paths::{PathPanel, Trace};
use mindgap_foundations::error::Result;
use mindgap_foundations::geometry::Pose;
use mindgap_logs::{Scene, Termination};
use mindgap_models::simulator::rollout::REACHED_CM;

/// Files of the figure.
pub const FILES: [&str; 2] = ["paths.svg", "paths.png"];

/// Writes the figure `paths` into the folder of a loop.
///
/// # Errors
/// If it cannot be written.
pub fn paths(folder: &Path, scene: &Scene, start: Pose, state: &State) -> Result<()> {
    let driven = state.trials.iter().filter(|trial| trial.real.is_some());
    let panels: Vec<PathPanel> =
        driven.map(|trial| PathPanel { title: title(trial), ..panel(trial, scene, start) }).collect();
    report::paths(&panels).write(folder, "paths")
}

/// The predicted paths of a trial and the robot's, if it was driven, without a title.
pub fn panel(trial: &Trial, scene: &Scene, start: Pose) -> PathPanel {
    PathPanel {
        title: String::new(),
        scene: scene.clone(),
        start,
        target_radius_cm: REACHED_CM,
        simulated: trial.predicted_paths.iter().map(|path| trace(&path.path_cm, path.ending)).collect(),
        real: trial.real.iter().map(|real| trace(&real.path_cm, real.ending)).collect(),
    }
}

fn title(trial: &Trial) -> String {
    let went = match &trial.real {
        None => "not driven".into(),
        Some(real) if real.reached => "reached".into(),
        Some(real) => format!("{}, {:.0} cm off", real.ending, real.distance_cm),
    };
    format!("Trial {}: {went}", trial.number)
}

fn trace(path_cm: &[[f64; 2]], ending: Termination) -> Trace {
    Trace { points_cm: path_cm.iter().copied().map(DVec2::from).collect(), crashed: ending == Termination::Crashed }
}
