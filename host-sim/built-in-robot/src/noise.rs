//! Random variables of the built-in robot.

use rand::RngExt;

use mindgap_foundations::chance::Generator;

/// A standard normal variable, by Marsaglia's polar method with libm's logarithm: a platform's own would make logs differ
/// between machines.
pub(super) fn normal(rng: &mut Generator) -> f64 {
    loop {
        let (x, y) = (rng.random_range(-1.0..1.0f64), rng.random_range(-1.0..1.0f64));
        let r2 = x * x + y * y;
        if r2 < 1.0 && r2 > 0.0 {
            return x * (-2.0 * libm::log(r2) / r2).sqrt();
        }
    }
}

/// A Bernoulli variable of this probability.
pub(super) fn happens(probability: f64, rng: &mut Generator) -> bool {
    rng.random::<f64>() < probability
}

/// A stationary first-order autoregressive process of mean 0 and standard deviation 1, such as the floor under a wheel.
#[derive(Clone, Debug, Default)]
pub(super) struct Wander(f64);

impl Wander {
    /// Autocorrelation over one [`Wander::step`].
    const KEPT: f64 = 0.85;

    /// A value from the stationary distribution.
    pub fn anywhere(rng: &mut Generator) -> Self {
        Wander(normal(rng))
    }

    pub fn step(&mut self, rng: &mut Generator) {
        self.0 = Self::KEPT * self.0 + (1.0 - Self::KEPT * Self::KEPT).sqrt() * normal(rng);
    }

    pub fn value(&self) -> f64 {
        self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mindgap_foundations::chance::generator;

    #[test]
    fn both_kinds_have_mean_zero_and_deviation_one() {
        let mut rng = generator(5, &[]);
        let mut wander = Wander::anywhere(&mut rng);
        let white: Vec<f64> = (0..40_000).map(|_| normal(&mut rng)).collect();
        let brown: Vec<f64> = (0..40_000)
            .map(|_| {
                wander.step(&mut rng);
                wander.value()
            })
            .collect();
        for (values, slack) in [(white, 0.02), (brown, 0.06)] {
            let mean = values.iter().sum::<f64>() / values.len() as f64;
            let variance = values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / values.len() as f64;
            assert!(mean.abs() < slack && (variance - 1.0).abs() < 2.0 * slack, "{mean} {variance}");
        }
    }
}
