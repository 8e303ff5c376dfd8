//! Robust statistics of a quantity over many robots.

use schemars::JsonSchema;
use serde::Serialize;

use mindgap_foundations::statistics::rounding::three_digits;
use mindgap_foundations::statistics::summary::QUARTILE;

/// Half-width of the 95 % interval of the rank of a median, in units of the square root of the sample size.
const RANKS: f64 = 0.98;

/// The distribution of a sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    /// Sample size.
    pub n: usize,
    /// Median.
    pub median: f64,
    /// Lower and upper quartile.
    pub quartiles: [f64; 2],
    /// 95 % interval of the median by order statistics; `None` for fewer than six values.
    pub median_ci95: Option<[f64; 2]>,
    /// Median absolute deviation, scaled to the standard deviation of a normal distribution.
    pub deviation: f64,
}

impl Spread {
    /// Computes the distribution of a sample; `None` if it is empty.
    pub fn of(mut values: Vec<f64>) -> Option<Self> {
        let n = values.len();
        values.sort_by(f64::total_cmp);
        let median = quantile(&values, 0.5)?;
        let mut deviations: Vec<f64> = values.iter().map(|value| (value - median).abs()).collect();
        deviations.sort_by(f64::total_cmp);
        Some(Spread {
            n,
            median,
            quartiles: [quantile(&values, 0.25)?, quantile(&values, 0.75)?],
            median_ci95: lowest_rank(n).map(|rank| [values[rank], values[n - 1 - rank]]),
            deviation: quantile(&deviations, 0.5)? / QUARTILE,
        })
    }

    /// Returns the distribution rounded for output.
    pub fn rounded(&self) -> RoundedSpread {
        RoundedSpread {
            median: three_digits(self.median),
            quartiles: self.quartiles.map(three_digits),
            median_ci95: self.median_ci95.map(|ends| ends.map(three_digits)),
            deviation: three_digits(self.deviation),
        }
    }
}

/// A distribution for output, rounded to three digits.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct RoundedSpread {
    /// Median.
    pub median: f64,
    /// Lower and upper quartile.
    pub quartiles: [f64; 2],
    /// 95 % interval of the median; null for fewer than six robots.
    pub median_ci95: Option<[f64; 2]>,
    /// Median absolute deviation, scaled to a standard deviation.
    pub deviation: f64,
}

/// Returns a quantile of sorted values by interpolation; `None` if there are none.
fn quantile(sorted: &[f64], share: f64) -> Option<f64> {
    let place = share * sorted.len().checked_sub(1)? as f64;
    let below = place as usize;
    let above = sorted.get(below + 1).unwrap_or(&sorted[below]);
    Some(sorted[below] + (place - below as f64) * (above - sorted[below]))
}

/// Returns the rank, from 0, of the lower end of the 95 % interval of the median; the upper end has the same rank from the
/// top (sign test, by the normal approximation of the binomial distribution with continuity correction).
fn lowest_rank(n: usize) -> Option<usize> {
    let rank = 0.5 * n as f64 - RANKS * (n as f64).sqrt() - 0.5;
    (rank >= 0.0).then_some(rank as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_few_outliers_hardly_change_the_statistics() {
        let mut values: Vec<f64> = (0..99).map(|i| f64::from(i) / 98.0).collect();
        let calm = Spread::of(values.clone()).unwrap();
        values.extend([1e9; 3]);
        let odd = Spread::of(values).unwrap();
        assert!((calm.median - 0.5).abs() < 1e-9 && (calm.quartiles[0] - 0.25).abs() < 1e-9);
        assert!((odd.median - calm.median).abs() < 0.02 && (odd.deviation - calm.deviation).abs() < 0.02);
        assert_eq!(Spread::of(vec![]), None);
    }

    /// Compares with the exact probability that the median lies outside the interval.
    #[test]
    fn interval_of_the_median_misses_it_one_time_in_twenty() {
        assert_eq!([0, 1, 5].map(lowest_rank), [None; 3]);
        for n in 6..200 {
            let rank = lowest_rank(n).unwrap();
            let mut term = libm::pow(0.5, n as f64);
            let mut below = term;
            for i in 0..rank {
                term *= (n - i) as f64 / (i + 1) as f64;
                below += term;
            }
            assert!(2.0 * below <= 0.05, "{n}: {}", 2.0 * below);
        }
    }
}
