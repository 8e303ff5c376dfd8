//! The distribution over robots given all evidence: exact, by one Cholesky factor a channel.
//!
//! Nodes are u = L a v with v standard normal a priori, L the unit factor of `basis` and a the prior's sizes. Evidence
//! with weights W and variances N leaves v normal with precision B = 1 + a Lᵀ Wᵀ N⁻¹ W L a.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use rand_distr::{Distribution, StandardNormal};

use super::basis::{SIZE, part, unit_factor, weights, weights_in_training};
use super::member::Member;
use super::{Ensemble, Evidence, PARTS};
use crate::chance::generator;

/// A distribution over robots.
pub struct Posterior {
    factor: DMatrix<f64>,
    channels: [Channel; 3],
    first_step: [f64; 3],
}

/// Sums of what evidence says of one channel: all that its likelihood needs.
pub struct Likelihood {
    /// Lᵀ Wᵀ N⁻¹ W L.
    gram: DMatrix<f64>,
    /// Lᵀ Wᵀ N⁻¹ y.
    pull: DVector<f64>,
}

struct Channel {
    sizes: DVector<f64>,
    precision: Cholesky<f64, Dyn>,
    /// Mean of v.
    mean: DVector<f64>,
}

/// Logarithm of the probability of all evidence of a distribution, up to what depends on its variances alone: which of two
/// explanations of the same steps it prefers.
pub fn log_evidence(ensemble: &Ensemble) -> f64 {
    let factor = unit_factor();
    let of = |channel: usize| {
        let squares =
            ensemble.evidence.iter().map(|e| f64::from(e.bias[channel] * e.bias[channel] / e.variance[channel]));
        let likelihood = Likelihood::new(&factor, &ensemble.evidence, channel);
        likelihood.log_evidence(&ensemble.prior[channel]) - 0.5 * squares.sum::<f64>()
    };
    (0..3).map(of).sum()
}

impl Posterior {
    /// Given all evidence; none if its numbers have no inverse.
    pub fn new(ensemble: &Ensemble) -> Option<Self> {
        let factor = unit_factor();
        let channel = |channel: usize| {
            let likelihood = Likelihood::new(&factor, &ensemble.evidence, channel);
            likelihood.given(&ensemble.prior[channel])
        };
        let channels = [channel(0)?, channel(1)?, channel(2)?];
        Some(Posterior { factor, channels, first_step: ensemble.first_step })
    }

    /// The robot in the middle.
    pub fn mean(&self) -> Member {
        let nodes = |channel: &Channel| self.nodes(channel, &channel.mean);
        Member::new(self.channels.each_ref().map(nodes), [0.0; 3], 0)
    }

    /// A robot of it, fixed by `seed`.
    pub fn draw(&self, seed: u64) -> Member {
        let mut rng = generator(seed, &[]);
        let nodes = self.channels.each_ref().map(|channel| {
            let normal = DVector::from_fn(SIZE, |_, _| StandardNormal.sample(&mut rng));
            let off = channel.precision.l_dirty().tr_solve_lower_triangular(&normal);
            self.nodes(channel, &(&channel.mean + off.unwrap_or(normal)))
        });
        Member::new(nodes, self.first_step, seed)
    }

    /// Mean and standard deviation of the bias under a command: forward (cm), lateral (cm), turn (degrees).
    pub fn bias(&self, command: [f64; 2]) -> [[f64; 2]; 3] {
        let mut along = DVector::zeros(SIZE);
        for (node, weight) in weights(command) {
            along += self.factor.row(node).transpose() * weight;
        }
        self.channels.each_ref().map(|channel| {
            let along = along.component_mul(&channel.sizes);
            let off = channel.precision.l_dirty().solve_lower_triangular(&along);
            [along.dot(&channel.mean), off.map_or(0.0, |off| off.norm())]
        })
    }

    fn nodes(&self, channel: &Channel, v: &DVector<f64>) -> Vec<f64> {
        (&self.factor * v.component_mul(&channel.sizes)).as_slice().to_vec()
    }
}

impl Likelihood {
    /// Of a channel of the evidence; `factor` is that of [`basis`](super::basis).
    pub fn new(factor: &DMatrix<f64>, evidence: &[Evidence], channel: usize) -> Self {
        let (mut precision, mut pull) = (DMatrix::zeros(SIZE, SIZE), DVector::zeros(SIZE));
        for e in evidence {
            let command = e.command.map(f64::from);
            let weights =
                if e.after_training { weights(command).to_vec() } else { weights_in_training(command).to_vec() };
            let (bias, certainty) = (f64::from(e.bias[channel]), 1.0 / f64::from(e.variance[channel]));
            for &(i, a) in &weights {
                pull[i] += a * bias * certainty;
                for &(j, b) in &weights {
                    precision[(i, j)] += a * b * certainty;
                }
            }
        }
        Likelihood { gram: factor.tr_mul(&(precision * factor)), pull: factor.tr_mul(&pull) }
    }

    /// Logarithm of the probability of the evidence for sizes of the parts, up to a constant.
    pub fn log_evidence(&self, prior: &[f64; PARTS]) -> f64 {
        let Some(channel) = self.given(prior) else { return f64::NEG_INFINITY };
        let spread: f64 = channel.precision.l_dirty().diagonal().iter().map(|d| libm::log(*d)).sum();
        0.5 * channel.mean.dot(&self.pull.component_mul(&channel.sizes)) - spread
    }

    fn given(&self, prior: &[f64; PARTS]) -> Option<Channel> {
        let sizes = DVector::from_fn(SIZE, |node, _| prior[part(node)]);
        let mut precision = DMatrix::from_fn(SIZE, SIZE, |i, j| sizes[i] * self.gram[(i, j)] * sizes[j]);
        precision.iter_mut().step_by(SIZE + 1).for_each(|diagonal| *diagonal += 1.0);
        let precision = Cholesky::new(precision)?;
        let mean = precision.solve(&self.pull.component_mul(&sizes));
        Some(Channel { sizes, precision, mean })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::summary::mean;

    /// Twenty commands whose turn is biased by a tenth of their difference, known to 0.2 degrees each.
    fn ensemble() -> Ensemble {
        let command = |i: usize| [(i * 7 % 20) as f32 * 8.0 - 76.0, (i * 11 % 20) as f32 * 8.0 - 76.0];
        let evidence = |i: usize| {
            let [left, right] = command(i);
            let bias = [0.0, 0.0, 0.1 * (right - left)];
            Evidence { command: [left, right], bias, variance: [0.04; 3], after_training: false }
        };
        Ensemble {
            prior: [[1.0, 1.0, 1.0, 5.0, 1.0, 0.0]; 3],
            first_step: [0.0; 3],
            evidence: (0..20).map(evidence).collect(),
        }
    }

    #[test]
    fn it_passes_through_evidence_and_is_wide_elsewhere() {
        let ensemble = ensemble();
        let posterior = Posterior::new(&ensemble).unwrap();
        for e in &ensemble.evidence {
            let [at, deviation] = posterior.bias(e.command.map(f64::from))[2];
            assert!((at - f64::from(e.bias[2])).abs() < 0.4 && deviation < 0.2, "{at} {deviation} {e:?}");
        }
        let none = Posterior::new(&Ensemble { evidence: Vec::new(), ..ensemble.clone() }).unwrap();
        let [at, deviation] = none.bias([30.0, -20.0])[2];
        assert!(at == 0.0 && (deviation - 29f64.sqrt()).abs() < 1.0, "{at} {deviation}");
    }

    #[test]
    fn draws_scatter_as_it_says() {
        let posterior = Posterior::new(&ensemble()).unwrap();
        let command = [50.0, -50.0];
        let draws: Vec<f64> = (0..400).map(|seed| posterior.draw(seed).bias(command)[2]).collect();
        let [expected, deviation] = posterior.bias(command)[2];
        let middle = mean(draws.iter().copied());
        let scatter = mean(draws.iter().map(|d| (d - middle) * (d - middle))).sqrt();
        assert!((middle - expected).abs() < 0.2 * deviation, "{middle} {expected} {deviation}");
        assert!((scatter / deviation - 1.0).abs() < 0.15, "{scatter} {deviation}");
        assert_eq!(posterior.draw(7).bias(command), posterior.draw(7).bias(command));
    }

    #[test]
    fn the_likelihood_prefers_the_size_that_made_the_evidence() {
        let factor = unit_factor();
        let likelihood = Likelihood::new(&factor, &ensemble().evidence, 2);
        let at = |size: f64| likelihood.log_evidence(&[0.1, 0.1, 0.1, size, 0.1, 0.0]);
        assert!(at(5.0) > at(0.05) && at(5.0) > at(5000.0));
    }
}
