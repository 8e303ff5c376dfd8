//! Bootstrap intervals over blocks of runs, since the steps of a run are correlated.

use rand::RngExt;

use crate::chance::generator;

/// The ends of a 95 % interval then lie fifty draws from either end.
const RESAMPLES: usize = 2000;

/// The 95 % percentile interval of a `statistic` of two sums over blocks of runs, from as many blocks drawn with
/// replacement. Draws in which the statistic is undefined do not count; zeros when none counts.
pub fn interval(one: &[f64], other: &[f64], seed: u64, statistic: impl Fn(f64, f64) -> Option<f64>) -> [f64; 2] {
    let mut rng = generator(seed, &[]);
    let mut values: Vec<f64> = (0..RESAMPLES)
        .filter_map(|_| {
            let drawn = (0..one.len()).map(|_| rng.random_range(0..one.len()));
            let sums = drawn.fold((0.0, 0.0), |sums, i| (sums.0 + one[i], sums.1 + other[i]));
            statistic(sums.0, sums.1)
        })
        .collect();
    values.sort_by(f64::total_cmp);
    let at = |share: f64| values.get((share * values.len() as f64) as usize).copied().unwrap_or(0.0);
    [at(0.025), at(0.975)]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A mean of n numbers scatters by their deviation over √n.
    #[test]
    fn the_interval_of_a_mean_is_two_standard_errors_to_either_side() {
        let values: Vec<f64> = (0..100).map(|i| if i % 2 == 0 { 4.0 } else { 6.0 }).collect();
        let ones = vec![1.0; values.len()];
        let [low, high] = interval(&values, &ones, 1, |sum, count| Some(sum / count));
        assert!((low - 4.8).abs() < 0.05 && (high - 5.2).abs() < 0.05, "{low} {high}");
    }

    #[test]
    fn draws_without_a_value_do_not_count() {
        assert_eq!(interval(&[1.0, -1.0], &[1.0, 1.0], 1, |sum, _| (sum > 0.0).then_some(sum)), [2.0, 2.0]);
        assert_eq!(interval(&[1.0], &[1.0], 1, |_, _| None), [0.0, 0.0]);
    }
}
