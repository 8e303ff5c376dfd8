//! Scaled Student's t distribution with five degrees of freedom: nearly normal, with heavier tails.

use std::f64::consts::{PI, TAU};

/// Degrees of freedom. With an odd number the distribution function has a closed form; [`density`] and [`cumulative`] are
/// written for five.
pub const DEGREES: f64 = 5.0;
/// 8 / (3 π √5): the density at zero for scale one.
const PEAK: f64 = 0.379_606_689_822_494_4;
/// [`quantile`] searches within this many scales of zero; less than 2e-9 of the distribution lies beyond.
const WIDEST: f64 = 100.0;
/// Bisections that narrow this interval to double precision.
const BISECTIONS: usize = 60;

/// Returns the density at `x`.
pub fn density(x: f64, scale: f64) -> f64 {
    let t = x / scale;
    let base = 1.0 + t * t / DEGREES;
    PEAK / (scale * base * base * base)
}

/// Returns the probability of a value below `t`, for scale one (Abramowitz and Stegun 1964, equation 26.7.3).
pub fn cumulative(t: f64) -> f64 {
    let root = DEGREES.sqrt();
    let cos_squared = DEGREES / (DEGREES + t * t);
    let sin_cos = t * root / (DEGREES + t * t);
    0.5 + (libm::atan(t / root) + sin_cos * (1.0 + 2.0 / 3.0 * cos_squared)) / PI
}

/// Returns the `p`-quantile, for scale one.
pub fn quantile(p: f64) -> f64 {
    let (mut low, mut high) = (-WIDEST, WIDEST);
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (low + high);
        if cumulative(middle) < p {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

/// Draws a value for scale one, given uniform draws in [0, 1) (Bailey 1994, Polar generation of random variates with the
/// t-distribution, Mathematics of Computation 62).
pub fn draw(mut uniform: impl FnMut() -> f64) -> f64 {
    // In (0, 1], since zero would give an infinite radius.
    let radius = 1.0 - uniform();
    (DEGREES * (libm::pow(radius, -2.0 / DEGREES) - 1.0)).sqrt() * libm::cos(TAU * uniform())
}

#[cfg(test)]
mod tests {
    use rand::RngExt;

    use super::*;
    use crate::random::generator;

    #[test]
    fn quantiles_match_published_tables() {
        for (p, t) in [(0.5, 0.0), (0.75, 0.726_687), (0.95, 2.015_048), (0.995, 4.032_143), (0.9995, 6.868_827)] {
            assert!((quantile(p) - t).abs() < 1e-6, "{p}: {}", quantile(p));
            assert!((quantile(1.0 - p) + t).abs() < 1e-6, "{p}");
        }
    }

    #[test]
    fn density_is_the_derivative_of_the_distribution_function() {
        for i in -40..=40 {
            let (t, h) = (0.2 * f64::from(i), 1e-5);
            let slope = (cumulative(t + h) - cumulative(t - h)) / (2.0 * h);
            assert!((slope - density(t, 1.0)).abs() < 1e-9, "{t}");
            assert!((density(2.5 * t, 2.5) - density(t, 1.0) / 2.5).abs() < 1e-15, "{t}");
        }
    }

    #[test]
    fn draws_are_uniform_over_deciles() {
        const DRAWS: usize = 100_000;
        let mut rng = generator(5, &[]);
        let mut tenths = [0.0; 10];
        for _ in 0..DRAWS {
            tenths[(10.0 * cumulative(draw(|| rng.random()))) as usize] += 1.0;
        }
        let expected = DRAWS as f64 / 10.0;
        let squares: f64 = tenths.iter().map(|n| (n - expected) * (n - expected) / expected).sum();
        // Chi-squared with nine degrees of freedom; one sample in a thousand exceeds it.
        assert!(squares < 27.9, "{tenths:?}");
    }
}
