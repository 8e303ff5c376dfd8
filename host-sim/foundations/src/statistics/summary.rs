//! Summary statistics.

/// Half of a normal distribution lies within this many standard deviations of its mean.
pub const QUARTILE: f64 = 0.674;

/// Returns the mean; NaN for an empty iterator.
pub fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, n) = values.fold((0.0, 0.0), |(sum, n), v| (sum + v, n + 1.0));
    sum / n
}

/// Returns the standard error of a sum of independent terms, with their variance estimated from the terms.
pub fn standard_error_of_sum(terms: &[f64]) -> f64 {
    let n = terms.len() as f64;
    let mean = terms.iter().sum::<f64>() / n;
    let variance = terms.iter().map(|d| (d - mean) * (d - mean)).sum::<f64>() / (n - 1.0).max(1.0);
    (n * variance).sqrt()
}

/// Returns the root mean square; NaN for an empty iterator.
pub fn root_mean_square(values: impl Iterator<Item = f64>) -> f64 {
    mean(values.map(|v| v * v)).sqrt()
}

/// Returns the upper median; NaN for an empty iterator.
pub fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    if values.is_empty() {
        return f64::NAN;
    }
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// Returns the least-absolute-deviations slope through the origin of pairs (y, x): the median of their ratios, weighted by
/// |x|. Up to half of the pairs may be outliers. `None` if every x is zero.
pub fn robust_slope(pairs: impl Iterator<Item = (f64, f64)>) -> Option<f64> {
    let pairs = pairs.filter(|(_, x)| *x != 0.0);
    let mut ratios: Vec<(f64, f64)> = pairs.map(|(y, x)| (y / x, x.abs())).collect();
    ratios.sort_by(|a, b| a.0.total_cmp(&b.0));
    let half = ratios.iter().map(|(_, weight)| weight).sum::<f64>() / 2.0;
    let mut below = 0.0;
    ratios.into_iter().find_map(|(ratio, weight)| {
        below += weight;
        (below >= half).then_some(ratio)
    })
}

/// Returns the probability whose log-odds are `x` (logistic function).
pub fn logistic(x: f64) -> f64 {
    1.0 / (1.0 + libm::exp(-x))
}

/// Returns the log-odds of a probability.
pub fn log_odds(p: f64) -> f64 {
    libm::log(p / (1.0 - p))
}

/// Returns how many standard errors a 95 % interval reaches to each side if the error was estimated from this many blocks: the
/// quantile of Student's distribution (Abramowitz and Stegun 1964, equation 26.7.5; within 1 % from four blocks on).
pub fn student_95(blocks: usize) -> f64 {
    /// Of the normal distribution.
    const Z: f64 = 1.959_964;
    let degrees = blocks.saturating_sub(1).max(1) as f64;
    let square = Z * Z;
    let terms = [
        (square + 1.0) / 4.0,
        ((5.0 * square + 16.0) * square + 3.0) / 96.0,
        (((3.0 * square + 19.0) * square + 17.0) * square - 15.0) / 384.0,
    ];
    terms.iter().rev().fold(0.0, |sum, term| (sum + Z * term) / degrees) + Z
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reach_of_an_interval_matches_published_tables() {
        for (blocks, published) in [(4, 3.182), (6, 2.571), (11, 2.228), (31, 2.042), (10_000, 1.960)] {
            assert!((student_95(blocks) / published - 1.0).abs() < 0.01, "{blocks}: {}", student_95(blocks));
        }
    }
}
