//! Learns how far commands turn the wheels from rotation counters, by ridge regression on the features of the motion.

use super::feature_regression::{self, fold};
use mindgap_logs::{Logs, samples};
use mindgap_models::effects::context::RunHistory;
use mindgap_models::effects::drive_filter::FilteredDrive;
use mindgap_models::simulator::Simulator;
use mindgap_models::simulator::ensemble::CommandScale;
use mindgap_models::simulator::nominal::WheelLaw;
use mindgap_models::simulator::nominal::motion_bias::features;

/// Ratios of noise variance to prior variance that are tried. Counters are a thousand times as exact as a step is long.
const STRENGTHS: [f64; 9] = [1.0, 0.1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8];
/// Minimum number of steps: more than there are features.
const FEWEST: usize = 200;

/// Returns the law of the wheels; `None` where too few steps have rotation counters.
pub fn learn(simulator: &Simulator, logs: &Logs) -> Option<WheelLaw> {
    let scale = CommandScale::of(simulator.commands);
    let drive = FilteredDrive::from(simulator.filter.up_to_the_rims());
    let (mut rows, mut turned_cm, mut folds) = (Vec::new(), Vec::new(), Vec::new());
    for (index, run) in logs.runs.iter().enumerate() {
        let mut history = RunHistory::default();
        for (k, row) in run.rows.iter().enumerate() {
            history.command(row.command());
            let Some(wheels_cm) = samples::wheels_cm(&logs.robot, run, k) else { continue };
            let speeds = drive.speeds(history.commands(), 0, &logs.robot);
            rows.push(features(speeds.inputs(), scale.share()).to_vec());
            turned_cm.push(wheels_cm);
            folds.push(fold(logs, index, k));
        }
    }
    if rows.len() < FEWEST {
        return None;
    }
    let [left, right] = [0, 1].map(|side| feature_regression::fit(&rows, &folds, &STRENGTHS, |i| turned_cm[i][side]));
    let scatter_cm = [left.scatter, right.scatter];
    Some(WheelLaw { scale, weights: [left.weights, right.weights], scatter_cm })
}
