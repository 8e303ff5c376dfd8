//! Bootstrap intervals over blocks of runs, since steps within a run are correlated.

use rand::RngExt;

use crate::random::generator;

/// Number of bootstrap draws: fifty lie beyond each end of a 95 % interval.
const RESAMPLES: usize = 2000;

/// Returns the 95 % percentile interval of a `statistic` of two sums over blocks of runs, resampling as many blocks with
/// replacement. Draws for which the statistic is undefined are skipped; without any defined draw the interval is `[0, 0]`.
pub fn interval(first: &[f64], second: &[f64], seed: u64, statistic: impl Fn(f64, f64) -> Option<f64>) -> [f64; 2] {
    let mut rng = generator(seed, &[]);
    let mut values: Vec<f64> = (0..RESAMPLES)
        .filter_map(|_| {
            let drawn = (0..first.len()).map(|_| rng.random_range(0..first.len()));
            let sums = drawn.fold((0.0, 0.0), |sums, i| (sums.0 + first[i], sums.1 + second[i]));
            statistic(sums.0, sums.1)
        })
        .collect();
    values.sort_by(f64::total_cmp);
    let percentile = |share: f64| values.get((share * values.len() as f64) as usize).copied().unwrap_or(0.0);
    [percentile(0.025), percentile(0.975)]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The standard error of a mean of n numbers is their standard deviation over √n.
    #[test]
    fn interval_of_a_mean_spans_two_standard_errors_each_side() {
        let values: Vec<f64> = (0..100).map(|i| if i % 2 == 0 { 4.0 } else { 6.0 }).collect();
        let ones = vec![1.0; values.len()];
        let [low, high] = interval(&values, &ones, 1, |sum, count| Some(sum / count));
        assert!((low - 4.8).abs() < 0.05 && (high - 5.2).abs() < 0.05, "{low} {high}");
    }

    #[test]
    fn undefined_draws_are_skipped() {
        assert_eq!(interval(&[1.0, -1.0], &[1.0, 1.0], 1, |sum, _| (sum > 0.0).then_some(sum)), [2.0, 2.0]);
        assert_eq!(interval(&[1.0], &[1.0], 1, |_, _| None), [0.0, 0.0]);
    }
}
