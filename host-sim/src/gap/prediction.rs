//! What a simulator with added effects predicts of logs, beside what was logged.

use super::baseline::Baseline;
use super::evidence::Evidence;
use super::hypothesis::Hypothesis;
use crate::logs::Logs;
use crate::problem::Result;
use crate::simulator::Simulator;

/// Logged and predicted, sample by sample.
#[derive(Clone, Debug, Default)]
pub struct Predictions {
    /// Way forward, cm.
    pub forward: Vec<[f64; 2]>,
    /// Way to the left, cm.
    pub lateral: Vec<[f64; 2]>,
    /// Turn, degrees.
    pub turn: Vec<[f64; 2]>,
    /// One for an echo and zero for none, and the probability of one.
    pub echo_probability: Vec<[f64; 2]>,
    /// The reading, cm.
    pub echo_value: Vec<[f64; 2]>,
}

/// Predicts every row of logs.
///
/// # Errors
/// When the simulator does not know how its training logs scattered.
pub fn predict(simulator: &Simulator, logs: &Logs) -> Result<Predictions> {
    let baseline = Baseline::learned(simulator)?;
    let evidence = Evidence::of(logs, baseline.sonar.as_ref().map_or(1.0, |sonar| sonar.fan_width));
    let effects = Hypothesis::none(&baseline);
    let mut all = Predictions::default();
    for row in &evidence.rows {
        if let (Some(drive), Some(logged)) = (&baseline.motion, &row.motion) {
            let predicted = effects.predicted(drive, row, &[]);
            all.forward.push([logged.forward_cm, predicted.forward_cm]);
            all.lateral.push([logged.lateral_cm, predicted.lateral_cm]);
            all.turn.push([logged.turn_rad, predicted.turn_rad].map(f64::to_degrees));
        }
        if let (Some(sonar), Some(_)) = (&baseline.sonar, row.moment.faced) {
            let (fan, change) = effects.facing(&evidence, row, &[]);
            let [none, _] = sonar.log_likelihood(&fan, &change, None, None);
            all.echo_probability.push([f64::from(u8::from(row.echo_cm.is_some())), 1.0 - libm::exp(none)]);
            if let (Some(echo_cm), Some(expected_cm)) = (row.echo_cm, sonar.expected_cm(&fan, &change)) {
                all.echo_value.push([echo_cm, expected_cm]);
            }
        }
    }
    Ok(all)
}
