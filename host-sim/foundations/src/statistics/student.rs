//! Student's t distribution with five degrees of freedom, scaled: errors that are nearly normal with heavier tails.

use std::f64::consts::{PI, TAU};

/// Degrees of freedom. With an odd number the distribution function is closed; [`density`] and [`cumulative`] are
/// written for five.
pub const DEGREES: f64 = 5.0;
/// 8 / (3 π √5): the density at the middle for scale one.
const PEAK: f64 = 0.379_606_689_822_494_4;
/// [`quantile`] looks within this many scales of the middle, beyond which lies less than 2e-9 of the distribution.
const WIDEST: f64 = 100.0;
/// Bisections of that interval until it is as narrow as double precision.
const BISECTIONS: usize = 60;

/// The density at `x` from the middle.
pub fn density(x: f64, scale: f64) -> f64 {
    let t = x / scale;
    let base = 1.0 + t * t / DEGREES;
    PEAK / (scale * base * base * base)
}

/// The probability of less than `t`, for scale one (Abramowitz and Stegun 1964, equation 26.7.3).
pub fn cumulative(t: f64) -> f64 {
    let root = DEGREES.sqrt();
    let cos_squared = DEGREES / (DEGREES + t * t);
    let sin_cos = t * root / (DEGREES + t * t);
    0.5 + (libm::atan(t / root) + sin_cos * (1.0 + 2.0 / 3.0 * cos_squared)) / PI
}

/// What a share `p` of the distribution lies below, for scale one.
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

/// A draw for scale one, from draws in [0, 1) (Bailey 1994, Polar generation of random variates with the
/// t-distribution, Mathematics of Computation 62).
pub fn draw(mut uniform: impl FnMut() -> f64) -> f64 {
    // Away from zero, whose logarithm would be infinite.
    let radius = 1.0 - uniform();
    (DEGREES * (libm::pow(radius, -2.0 / DEGREES) - 1.0)).sqrt() * libm::cos(TAU * uniform())
}

#[cfg(test)]
mod tests {
    use rand::RngExt;

    use super::*;
    use crate::chance::generator;

    #[test]
    fn quantiles_are_those_of_the_tables() {
        for (p, t) in [(0.5, 0.0), (0.75, 0.726_687), (0.95, 2.015_048), (0.995, 4.032_143), (0.9995, 6.868_827)] {
            assert!((quantile(p) - t).abs() < 1e-6, "{p}: {}", quantile(p));
            assert!((quantile(1.0 - p) + t).abs() < 1e-6, "{p}");
        }
    }

    #[test]
    fn the_density_is_the_slope_of_the_distribution_function() {
        for i in -40..=40 {
            let (t, h) = (0.2 * f64::from(i), 1e-5);
            let slope = (cumulative(t + h) - cumulative(t - h)) / (2.0 * h);
            assert!((slope - density(t, 1.0)).abs() < 1e-9, "{t}");
            assert!((density(2.5 * t, 2.5) - density(t, 1.0) / 2.5).abs() < 1e-15, "{t}");
        }
    }

    #[test]
    fn a_tenth_of_the_draws_lies_in_each_tenth_of_the_distribution() {
        const DRAWS: usize = 100_000;
        let mut rng = generator(5, &[]);
        let mut tenths = [0.0; 10];
        for _ in 0..DRAWS {
            tenths[(10.0 * cumulative(draw(|| rng.random()))) as usize] += 1.0;
        }
        let expected = DRAWS as f64 / 10.0;
        let squares: f64 = tenths.iter().map(|n| (n - expected) * (n - expected) / expected).sum();
        // Of nine degrees of freedom; one sample in a thousand exceeds it.
        assert!(squares < 27.9, "{tenths:?}");
    }
}
