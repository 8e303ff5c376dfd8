//! The law of motion residuals: Student's t with five degrees of freedom, since real steps scatter with heavier tails than
//! the normal law, and a uniform share of steps in which the tracker is anywhere.
//!
//! The uniform part bounds what a row can say: with a scatter of s it moves a log-likelihood by no more than
//! [`most_nats`]`(axis, s)`, about eleven, however absurd its residual is.

use mindgap_foundations::statistics::student;
use mindgap_foundations::statistics::summary::median;

/// Share of steps in which the tracker is anywhere: trackers that err more often are looked into, not modelled.
const OUTLIERS: f64 = 0.01;
/// Outliers are uniform to this far from the prediction: a room's width forward and to the side, half a turn.
const REACH: [f64; 3] = [100.0, 100.0, std::f64::consts::PI];
/// The scale of Student's distribution that fits a normal law of standard deviation one best.
pub const SCALE_OF_NORMAL: f64 = 0.856_621;
/// Half of Student's distribution lies within so many scales.
const QUARTILE: f64 = 0.726_687;
/// The scatter is found to this share: since the likelihood is flat at its maximum, what is left of it changes that of ten
/// thousand rows by 1e-4 nats.
const TOLERANCE: f64 = 1e-4;
/// Extrapolations at most; two or three are usual.
const MOST_ITERATIONS: usize = 20;

/// Logarithm of the density of a residual of forward (cm), lateral (cm) or turn (rad). `scatter` is the standard deviation
/// of the normal law that the distribution resembles, in the same unit.
pub fn log_density(axis: usize, residual: f64, scatter: f64) -> f64 {
    libm::log(usual(residual, scatter) + outlying(axis))
}

/// By how much a single row can change a log-likelihood, nats.
pub fn most_nats(axis: usize, scatter: f64) -> f64 {
    log_density(axis, 0.0, scatter) - libm::log(outlying(axis))
}

/// The most likely scatter of residuals, `least` or more; with each stands how much it counts.
pub fn fitted_scatter(axis: usize, residuals: &[[f64; 2]], least: f64) -> f64 {
    let middle = median(residuals.iter().map(|[r, _]| r.abs())) / QUARTILE / SCALE_OF_NORMAL;
    let squares = residuals.iter().map(|[r, counts]| (r * r, *counts)).filter(|(square, _)| square.is_finite());
    let (squares, counts): (Vec<f64>, Vec<f64>) = squares.unzip();
    let next = |scatter: f64| reweighted(axis, &squares, &counts, scatter).max(least);
    // NaN where there are no residuals.
    let mut scatter = if middle > least { middle } else { least };
    for _ in 0..MOST_ITERATIONS {
        let once = next(scatter);
        if (once - scatter).abs() <= TOLERANCE * scatter {
            return once;
        }
        let twice = next(once);
        // Aitken's extrapolation of what three of a sequence that converges linearly converge to.
        let bend = twice - 2.0 * once + scatter;
        let limit = scatter - (once - scatter) * (once - scatter) / bend;
        scatter = if (0.5 * twice..2.0 * twice).contains(&limit) { limit.max(least) } else { twice };
    }
    scatter
}

/// Sums are added up side by side.
const LANES: usize = 4;

/// One round of expectation and maximisation with an expanded parameter, which converges faster than the plain one (Liu,
/// Rubin and Wu 1998, Biometrika 85): the mean of squares, each weighed by how usual it is.
fn reweighted(axis: usize, squares: &[f64], counts: &[f64], scatter: f64) -> f64 {
    let scale = SCALE_OF_NORMAL * scatter;
    let per_square = 1.0 / (student::DEGREES * scale * scale);
    // Density of outliers relative to the usual one in the middle.
    let outlying = outlying(axis) / usual(0.0, scatter);
    let weight = |square: f64, counts: f64| {
        let base = 1.0 + square * per_square;
        counts / (base * (1.0 + outlying * base * base * base))
    };
    let (mut sums, mut weights) = ([0.0; LANES], [0.0; LANES]);
    let (squares, counts) = (squares.chunks_exact(LANES), counts.chunks_exact(LANES));
    let rest = squares.remainder().iter().zip(counts.remainder()).enumerate();
    for (squares, counts) in squares.zip(counts) {
        for lane in 0..LANES {
            let w = weight(squares[lane], counts[lane]);
            sums[lane] += w * squares[lane];
            weights[lane] += w;
        }
    }
    for (lane, (square, counts)) in rest {
        let w = weight(*square, *counts);
        sums[lane] += w * square;
        weights[lane] += w;
    }
    let weights: f64 = weights.iter().sum();
    if weights > 0.0 { (sums.iter().sum::<f64>() / weights).sqrt() / SCALE_OF_NORMAL } else { scatter }
}

fn usual(residual: f64, scatter: f64) -> f64 {
    let density = (1.0 - OUTLIERS) * student::density(residual, SCALE_OF_NORMAL * scatter);
    // What is not a number, or infinitely far off, is an outlier.
    if density.is_finite() { density } else { 0.0 }
}

fn outlying(axis: usize) -> f64 {
    OUTLIERS / (2.0 * REACH[axis])
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Residuals at the quantiles of a normal law.
    fn normal(n: usize, deviation: f64) -> Vec<f64> {
        let normal = |p: f64| {
            let (mut low, mut high) = (-9.0, 9.0);
            for _ in 0..60 {
                let middle: f64 = 0.5 * (low + high);
                let below = 0.5 * libm::erfc(-middle / std::f64::consts::SQRT_2);
                if below < p { low = middle } else { high = middle }
            }
            low
        };
        (0..n).map(|i| deviation * normal((i as f64 + 0.5) / n as f64)).collect()
    }

    /// Residuals of which each counts as much.
    fn alike(residuals: &[f64]) -> Vec<[f64; 2]> {
        residuals.iter().map(|r| [*r, 1.0]).collect()
    }

    /// A third of them is wide and counts a thousandth.
    #[test]
    fn what_counts_little_hardly_widens_the_scatter() {
        let mut residuals = alike(&normal(2000, 0.4));
        residuals.extend(normal(1000, 2.0).into_iter().map(|r| [r, 0.001]));
        assert!((fitted_scatter(0, &residuals, 1e-6) / 0.4 - 1.0).abs() < 0.03);
        residuals.iter_mut().for_each(|[_, counts]| *counts = 1.0);
        assert!(fitted_scatter(0, &residuals, 1e-6) > 0.5);
    }

    #[test]
    fn the_scatter_of_normal_residuals_is_their_standard_deviation() {
        for (axis, deviation) in [(0, 0.4), (1, 3.0), (2, 0.02)] {
            let fitted = fitted_scatter(axis, &alike(&normal(2000, deviation)), 1e-6);
            assert!((fitted / deviation - 1.0).abs() < 0.02, "{fitted} {deviation}");
        }
        assert_eq!(fitted_scatter(0, &alike(&normal(200, 0.4)), 0.5), 0.5, "never less than the least");
        assert_eq!(fitted_scatter(0, &[], 0.5), 0.5);
    }

    /// The scatter is where the likelihood is highest, compared on a fine grid.
    #[test]
    fn the_scatter_is_the_most_likely_one() {
        let mut residuals = normal(300, 0.3);
        residuals.extend([40.0, -7.0, 2.0, -2.5, 1e9]);
        let sum = |scatter: f64| residuals.iter().map(|r| log_density(0, *r, scatter)).sum::<f64>();
        let fitted = fitted_scatter(0, &alike(&residuals), 0.01);
        let best = (50..1000).map(|i| 0.001 * f64::from(i)).max_by(|a, b| sum(*a).total_cmp(&sum(*b))).unwrap();
        assert!((fitted - best).abs() <= 0.001, "{fitted} {best}");
    }

    proptest! {
        #[test]
        fn no_row_says_more_than_is_stated(residual in prop::num::f64::ANY, scatter in 1e-3..1e3f64, axis in 0usize..3) {
            let nats = log_density(axis, residual, scatter);
            let [least, most] = [libm::log(outlying(axis)), log_density(axis, 0.0, scatter)];
            prop_assert!((least..=most).contains(&nats), "{} of {} to {}", nats, least, most);
            prop_assert!((most - least - most_nats(axis, scatter)).abs() < 1e-9);
        }

        /// Scatter is chosen to suit all rows, so that a row changes the sum by no more than itself.
        #[test]
        fn no_row_moves_a_sum_by_more_than_is_stated(absurd in prop::num::f64::ANY, at in 0usize..200) {
            let usual = normal(200, 0.3);
            let mut changed = usual.clone();
            changed[at] = absurd;
            let least = 0.1;
            let sum = |residuals: &[f64]| {
                let scatter = fitted_scatter(0, &alike(residuals), least);
                residuals.iter().map(|r| log_density(0, *r, scatter)).sum::<f64>()
            };
            let moved = (sum(&usual) - sum(&changed)).abs();
            prop_assert!(moved <= most_nats(0, least), "{}", moved);
        }
    }
}
