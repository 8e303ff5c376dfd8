//! Ridge regression on the features of a motion, with folds that never mix runs if there are enough.

use mindgap_foundations::statistics::ridge;
use mindgap_foundations::statistics::summary::root_mean_square;
use mindgap_logs::Logs;
use mindgap_models::simulator::nominal::motion_bias::FEATURES;

/// Number of folds of cross-validation.
const FOLDS: usize = 5;

/// A regression of one quantity.
pub struct Regression {
    /// Weight of each feature.
    pub weights: Vec<f64>,
    /// Standard deviation of what is left.
    pub scatter: f64,
    /// The ratio of noise variance to prior variance that predicts best.
    pub strength: f64,
}

/// Returns the fold of a row. If there are few runs, they are cut into parts.
pub fn fold(logs: &Logs, run: usize, row: usize) -> usize {
    let parts = if logs.runs.len() < FOLDS { FOLDS } else { 1 };
    (run + row * parts / logs.runs[run].rows.len()) % FOLDS
}

/// Fits a quantity to rows of features. `strengths` are the ratios of noise variance to prior variance that are tried.
pub fn fit(rows: &[Vec<f64>], folds: &[usize], strengths: &[f64], quantity: impl Fn(usize) -> f64) -> Regression {
    let unit = root_mean_square((0..rows.len()).map(&quantity)).max(f64::MIN_POSITIVE);
    let ridge = ridge::fit(rows, folds, strengths, |i, _| quantity(i) / unit);
    let weights: Vec<f64> = ridge.weights.iter().map(|w| unit * w).collect();
    let left = rows.iter().enumerate().map(|(i, row)| quantity(i) - ridge::predicted(row, &weights));
    let scatter = (left.map(|r| r * r).sum::<f64>() / rows.len().saturating_sub(FEATURES).max(1) as f64).sqrt();
    Regression { weights, scatter, strength: ridge.strength.unwrap_or(strengths[0]) }
}
