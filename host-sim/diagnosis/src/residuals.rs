//! Residuals of a motion channel beyond predictions, and their likelihood.

use super::noise_model::{fitted_noise, log_density};
use super::sample::Sample;
use mindgap_learning::evaluation::observations::Observation;

/// Subtracts predictions from residuals.
pub fn subtract(residuals: &[Option<f64>], predictions: &[f64]) -> Vec<Option<f64>> {
    residuals.iter().zip(predictions).map(|(residual, prediction)| Some((*residual)? - prediction)).collect()
}

/// Returns the log-likelihood of each row; `residuals` are beyond all predictions, `ratios` each row's noise over `noise`.
pub fn log_likelihoods(
    axis: usize,
    noise: f64,
    sample: &Sample,
    residuals: &[Option<f64>],
    ratios: &[f64],
) -> Vec<f64> {
    let term = |((row, residual), ratio): ((&Observation, &Option<f64>), &f64)| {
        residual.map_or(0.0, |r| row.motion_weight[axis] * log_density(axis, r, ratio * noise))
    };
    sample.rows.iter().zip(residuals).zip(ratios).map(term).collect()
}

/// Fits the standard deviation, `least` or more, of residuals that are divided by their ratios.
pub fn usual_noise(axis: usize, sample: &Sample, residuals: &[Option<f64>], ratios: &[f64], least: f64) -> f64 {
    let scaled = residuals.iter().zip(ratios).zip(&sample.rows);
    let scaled = scaled.filter_map(|((residual, ratio), row)| Some([(*residual)? / ratio, row.motion_weight[axis]]));
    fitted_noise(axis, &scaled.collect::<Vec<[f64; 2]>>(), least)
}
