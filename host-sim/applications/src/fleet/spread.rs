//! How numbers of many robots are distributed, told so that a few odd ones change little.

use serde::Serialize;

use mindgap_foundations::statistics::rounding::three_digits;
use mindgap_foundations::statistics::summary::QUARTILE;

/// Half the width of a normal law's 95 % interval over twice its standard deviation: what the ranks of a median scatter by,
/// in roots of the number.
const RANKS: f64 = 0.98;

/// The distribution of some numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    /// How many.
    pub n: usize,
    /// In the middle.
    pub median: f64,
    /// A quarter lies below the first, and a quarter above the second.
    pub quartiles: [f64; 2],
    /// 95 % interval of the median, by order statistics; none of fewer than six numbers.
    pub median_ci95: Option<[f64; 2]>,
    /// Median of the absolute deviations from the median, as the standard deviation that a normal law with it has.
    pub deviation: f64,
}

impl Spread {
    /// Of some numbers; none of none.
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

    /// As it is written.
    pub fn told(&self) -> Told {
        Told {
            median: three_digits(self.median),
            quartiles: self.quartiles.map(three_digits),
            median_ci95: self.median_ci95.map(|ends| ends.map(three_digits)),
            deviation: three_digits(self.deviation),
        }
    }
}

/// A distribution as it is written, with three digits.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Told {
    /// See [`Spread::median`].
    pub median: f64,
    /// See [`Spread::quartiles`].
    pub quartiles: [f64; 2],
    /// See [`Spread::median_ci95`].
    pub median_ci95: Option<[f64; 2]>,
    /// See [`Spread::deviation`].
    pub deviation: f64,
}

/// What a share of sorted numbers lies below, interpolated; none of none.
fn quantile(sorted: &[f64], share: f64) -> Option<f64> {
    let place = share * sorted.len().checked_sub(1)? as f64;
    let below = place as usize;
    let above = sorted.get(below + 1).unwrap_or(&sorted[below]);
    Some(sorted[below] + (place - below as f64) * (above - sorted[below]))
}

/// Between the number of this rank, from 0, and the one as far from the end lies the median with 95 %: each number is as
/// likely below it as above (sign test, with the binomial law's normal approximation and correction of continuity).
fn lowest_rank(n: usize) -> Option<usize> {
    let rank = 0.5 * n as f64 - RANKS * (n as f64).sqrt() - 0.5;
    (rank >= 0.0).then_some(rank as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_few_odd_numbers_change_little() {
        let mut values: Vec<f64> = (0..99).map(|i| f64::from(i) / 98.0).collect();
        let calm = Spread::of(values.clone()).unwrap();
        values.extend([1e9; 3]);
        let odd = Spread::of(values).unwrap();
        assert!((calm.median - 0.5).abs() < 1e-9 && (calm.quartiles[0] - 0.25).abs() < 1e-9);
        assert!((odd.median - calm.median).abs() < 0.02 && (odd.deviation - calm.deviation).abs() < 0.02);
        assert_eq!(Spread::of(vec![]), None);
    }

    /// The exact probability that the median lies outside.
    #[test]
    fn the_interval_of_a_median_misses_it_one_time_in_twenty() {
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
