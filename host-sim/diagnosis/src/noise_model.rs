//! The noise model of motion residuals: Student's t with five degrees of freedom, since real steps have heavier tails than the
//! normal distribution, and a uniform outlier component for tracker failures.
//!
//! The uniform component bounds the influence of a row: however absurd its residual, it changes a log-likelihood by at most
//! [`most_nats`]`(axis, s)` for noise of standard deviation s, about eleven nats.

use mindgap_foundations::statistics::student;
use mindgap_foundations::statistics::summary::median;

/// Fraction of steps in which the tracker fails. Trackers that fail more often should be repaired, not modelled.
const OUTLIERS: f64 = 0.01;
/// Outliers are uniform within this distance of the prediction: a room's width forward and sideways, half a turn.
pub const REACH: [f64; 3] = [100.0, 100.0, std::f64::consts::PI];
/// The scale of Student's distribution that fits the standard normal distribution best.
pub const SCALE_OF_NORMAL: f64 = 0.856_621;
/// Half of Student's distribution lies within this many scales.
const STUDENT_QUARTILE: f64 = 0.726_687;
/// Relative tolerance of a fitted standard deviation. The likelihood is flat at its maximum: the remaining error changes that of
/// ten thousand rows by 1e-4 nats.
const TOLERANCE: f64 = 1e-4;
/// Maximum number of extrapolations; two or three are usual.
const MOST_ITERATIONS: usize = 20;

/// Returns the log-density of a residual of forward (cm), lateral (cm) or turn (rad), in nats. `noise` is the standard deviation
/// of the normal distribution that the noise resembles, in the same unit.
pub fn log_density(axis: usize, residual: f64, noise: f64) -> f64 {
    libm::log(inlier_density(residual, noise) + outlier_density(axis))
}

/// Returns the most by which a single row can change a log-likelihood, in nats.
pub fn most_nats(axis: usize, noise: f64) -> f64 {
    log_density(axis, 0.0, noise) - libm::log(outlier_density(axis))
}

/// Returns the maximum-likelihood standard deviation of residuals, each given with its weight; `least` or more.
pub fn fitted_noise(axis: usize, residuals: &[[f64; 2]], least: f64) -> f64 {
    let middle = median(residuals.iter().map(|[r, _]| r.abs())) / STUDENT_QUARTILE / SCALE_OF_NORMAL;
    let squares = residuals.iter().map(|[r, weight]| (r * r, *weight)).filter(|(square, _)| square.is_finite());
    let (squares, weights): (Vec<f64>, Vec<f64>) = squares.unzip();
    let next = |noise: f64| reweighted(axis, &squares, &weights, noise).max(least);
    // The median of no residuals is NaN.
    let mut noise = if middle > least { middle } else { least };
    for _ in 0..MOST_ITERATIONS {
        let once = next(noise);
        if (once - noise).abs() <= TOLERANCE * noise {
            return once;
        }
        let twice = next(once);
        // Aitken's extrapolation of a linearly convergent sequence.
        let bend = twice - 2.0 * once + noise;
        let limit = noise - (once - noise) * (once - noise) / bend;
        noise = if (0.5 * twice..2.0 * twice).contains(&limit) { limit.max(least) } else { twice };
    }
    noise
}

/// Number of partial sums, so that the compiler vectorises them.
const LANES: usize = 4;

/// One iteration of parameter-expanded EM, which converges faster than plain EM (Liu, Rubin and Wu 1998, Biometrika 85): the mean
/// square, weighted by the probability of being an inlier and by Student's weight.
fn reweighted(axis: usize, squares: &[f64], weights: &[f64], noise: f64) -> f64 {
    let scale = SCALE_OF_NORMAL * noise;
    let per_square = 1.0 / (student::DEGREES * scale * scale);
    // Density of outliers relative to that of inliers in the middle.
    let outliers = outlier_density(axis) / inlier_density(0.0, noise);
    let weight = |square: f64, weight: f64| {
        let base = 1.0 + square * per_square;
        weight / (base * (1.0 + outliers * base * base * base))
    };
    let (mut sums, mut totals) = ([0.0; LANES], [0.0; LANES]);
    let (squares, weights) = (squares.chunks_exact(LANES), weights.chunks_exact(LANES));
    let rest = squares.remainder().iter().zip(weights.remainder()).enumerate();
    for (squares, weights) in squares.zip(weights) {
        for lane in 0..LANES {
            let w = weight(squares[lane], weights[lane]);
            sums[lane] += w * squares[lane];
            totals[lane] += w;
        }
    }
    for (lane, (square, row_weight)) in rest {
        let w = weight(*square, *row_weight);
        sums[lane] += w * square;
        totals[lane] += w;
    }
    let total: f64 = totals.iter().sum();
    if total > 0.0 { (sums.iter().sum::<f64>() / total).sqrt() / SCALE_OF_NORMAL } else { noise }
}

fn inlier_density(residual: f64, noise: f64) -> f64 {
    let density = (1.0 - OUTLIERS) * student::density(residual, SCALE_OF_NORMAL * noise);
    // A residual that is infinite or not a number is an outlier.
    if density.is_finite() { density } else { 0.0 }
}

fn outlier_density(axis: usize) -> f64 {
    OUTLIERS / (2.0 * REACH[axis])
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Returns residuals at the quantiles of a normal distribution.
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

    /// Gives all residuals the weight one.
    fn unweighted(residuals: &[f64]) -> Vec<[f64; 2]> {
        residuals.iter().map(|r| [*r, 1.0]).collect()
    }

    /// One third of the residuals is wide and has a weight of one thousandth.
    #[test]
    fn residuals_of_little_weight_hardly_widen_the_noise() {
        let mut residuals = unweighted(&normal(2000, 0.4));
        residuals.extend(normal(1000, 2.0).into_iter().map(|r| [r, 0.001]));
        assert!((fitted_noise(0, &residuals, 1e-6) / 0.4 - 1.0).abs() < 0.03);
        residuals.iter_mut().for_each(|[_, weight]| *weight = 1.0);
        assert!(fitted_noise(0, &residuals, 1e-6) > 0.5);
    }

    #[test]
    fn noise_of_normal_residuals_is_their_standard_deviation() {
        for (axis, deviation) in [(0, 0.4), (1, 3.0), (2, 0.02)] {
            let fitted = fitted_noise(axis, &unweighted(&normal(2000, deviation)), 1e-6);
            assert!((fitted / deviation - 1.0).abs() < 0.02, "{fitted} {deviation}");
        }
        assert_eq!(fitted_noise(0, &unweighted(&normal(200, 0.4)), 0.5), 0.5, "never below the least");
        assert_eq!(fitted_noise(0, &[], 0.5), 0.5);
    }

    /// A fine grid of noise contains no higher likelihood.
    #[test]
    fn fitted_noise_is_the_most_likely() {
        let mut residuals = normal(300, 0.3);
        residuals.extend([40.0, -7.0, 2.0, -2.5, 1e9]);
        let sum = |noise: f64| residuals.iter().map(|r| log_density(0, *r, noise)).sum::<f64>();
        let fitted = fitted_noise(0, &unweighted(&residuals), 0.01);
        let best = (50..1000).map(|i| 0.001 * f64::from(i)).max_by(|a, b| sum(*a).total_cmp(&sum(*b))).unwrap();
        assert!((fitted - best).abs() <= 0.001, "{fitted} {best}");
    }

    proptest! {
        #[test]
        fn no_row_exceeds_the_bound(residual in prop::num::f64::ANY, noise in 1e-3..1e3f64, axis in 0usize..3) {
            let nats = log_density(axis, residual, noise);
            let [least, most] = [libm::log(outlier_density(axis)), log_density(axis, 0.0, noise)];
            prop_assert!((least..=most).contains(&nats), "{} not in {} to {}", nats, least, most);
            prop_assert!((most - least - most_nats(axis, noise)).abs() < 1e-9);
        }

        /// The noise is fitted to all rows, so a row changes the sum by no more than its own bound.
        #[test]
        fn no_row_changes_a_sum_by_more_than_the_bound(absurd in prop::num::f64::ANY, at in 0usize..200) {
            let usual = normal(200, 0.3);
            let mut changed = usual.clone();
            changed[at] = absurd;
            let least = 0.1;
            let sum = |residuals: &[f64]| {
                let noise = fitted_noise(0, &unweighted(residuals), least);
                residuals.iter().map(|r| log_density(0, *r, noise)).sum::<f64>()
            };
            let moved = (sum(&usual) - sum(&changed)).abs();
            prop_assert!(moved <= most_nats(0, least), "{}", moved);
        }
    }
}
