//! Numbers that sum up many.

/// Half of a normal law's values lie within so many standard deviations.
pub const QUARTILE: f64 = 0.674;

/// The mean; NaN of nothing.
pub fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, n) = values.fold((0.0, 0.0), |(sum, n), v| (sum + v, n + 1.0));
    sum / n
}

/// Standard error of a sum of independent terms, whose variance is known from themselves.
pub fn error_of_sum(terms: &[f64]) -> f64 {
    let n = terms.len() as f64;
    let mean = terms.iter().sum::<f64>() / n;
    let variance = terms.iter().map(|d| (d - mean) * (d - mean)).sum::<f64>() / (n - 1.0).max(1.0);
    (n * variance).sqrt()
}

/// The square root of the mean of squares; NaN of nothing.
pub fn root_mean_square(values: impl Iterator<Item = f64>) -> f64 {
    mean(values.map(|v| v * v)).sqrt()
}

/// The upper median; NaN of nothing.
pub fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    if values.is_empty() {
        return f64::NAN;
    }
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// The slope through the origin of least absolute deviations, of pairs (y, x): the median of their ratios, weighted by x.
/// Half of the pairs may be wrong without moving it. `None` where every x is zero.
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

/// The logistic function: the probability whose log-odds are `x`.
pub fn logistic(x: f64) -> f64 {
    1.0 / (1.0 + libm::exp(-x))
}

/// The log-odds of a probability.
pub fn log_odds(p: f64) -> f64 {
    libm::log(p / (1.0 - p))
}
