//! The distribution over robots given all evidence: exact, by one Cholesky factor per axis.
//!
//! Nodes are u = L a v with v standard normal a priori, L the unit factor of `basis` and a the prior's sizes. Evidence
//! with weights W and variances N leaves v normal with precision B = 1 + a Lᵀ Wᵀ N⁻¹ W L a.

use std::sync::Arc;

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use rand_distr::{Distribution, StandardNormal};

use super::basis::{LINE, SIZE, part, unit_factor, weights};
use super::evidence::{by_cell, cells, one};
use super::member::Member;
use super::noise::MotionNoise;
use super::nugget::Nuggets;
use super::{Ensemble, Evidence, Held, PARTS};
use mindgap_foundations::motion::{Axis, Motion};
use mindgap_foundations::random::generator;

/// Prior standard deviation of the line at full command, in cm and degrees of a step: far more than robots move, so that logs
/// alone say what it is.
const LINE_SIZE: f64 = 1000.0;

/// A distribution over robots.
pub struct Posterior {
    factor: DMatrix<f64>,
    axes: Motion<AxisPosterior>,
    nuggets: Arc<Nuggets>,
}

/// Sums over the evidence along one axis: all that its likelihood needs.
pub struct Likelihood {
    /// Lᵀ Wᵀ N⁻¹ W L.
    gram: DMatrix<f64>,
    /// Lᵀ Wᵀ N⁻¹ y.
    pull: DVector<f64>,
}

struct AxisPosterior {
    sizes: DVector<f64>,
    precision: Cholesky<f64, Dyn>,
    /// Mean of v.
    mean: DVector<f64>,
}

/// Logarithm of the probability of all evidence of a distribution, up to what depends on its variances alone: which of two
/// explanations of the same steps it prefers.
pub fn log_evidence(ensemble: &Ensemble, held: Held) -> f64 {
    let factor = unit_factor();
    let cells = cells(ensemble.evidence.iter().copied(), held.scale());
    let means: Vec<Evidence> = cells.iter().map(|together| one(together)).collect();
    let about =
        |(together, mean): (&Vec<Evidence>, &Evidence)| together.iter().map(|e| e.squares_about(mean)).sum::<f64>();
    let within: f64 = cells.iter().zip(&means).map(about).sum();
    let of = |axis: Axis| {
        let square = |e: &Evidence| {
            let motion = e.motion(held)[axis];
            motion * motion / e.variance_about_process(&ensemble.noise, held, axis)
        };
        let squares: f64 = means.iter().map(square).sum();
        let likelihood = Likelihood::new(&factor, &means, &ensemble.noise, held, axis);
        likelihood.log_evidence(&ensemble.prior[axis]) - 0.5 * squares
    };
    Axis::ALL.into_iter().map(of).sum::<f64>() - 0.5 * within
}

impl Posterior {
    /// Given all evidence, which is relative to `held`; none if its numbers have no inverse.
    pub fn new(ensemble: &Ensemble, held: Held) -> Option<Self> {
        let factor = unit_factor();
        let noise = ensemble.noise;
        let cells = by_cell(ensemble.evidence.iter().copied(), held.scale());
        let axis = |axis: Axis| Likelihood::new(&factor, &cells, &noise, held, axis).given(&ensemble.prior[axis]);
        let axes = Motion { forward: axis(Axis::Forward)?, lateral: axis(Axis::Lateral)?, turn: axis(Axis::Turn)? };
        Some(Posterior { factor, axes, nuggets: Arc::new(Nuggets::new(&cells, noise, held)) })
    }

    /// The robot in the middle.
    pub fn mean(&self) -> Member {
        let nodes = |axis: &AxisPosterior| self.nodes(axis, &axis.mean);
        Member::new(self.axes.each_ref().map(nodes), self.nuggets.clone(), None)
    }

    /// A robot of it, fixed by `seed`.
    pub fn draw(&self, seed: u64) -> Member {
        let mut rng = generator(seed, &[]);
        let nodes = self.axes.each_ref().map(|axis| {
            let normal = DVector::from_fn(SIZE, |_, _| StandardNormal.sample(&mut rng));
            let off = axis.precision.l_dirty().tr_solve_lower_triangular(&normal);
            self.nodes(axis, &(&axis.mean + off.unwrap_or(normal)))
        });
        Member::new(nodes, self.nuggets.clone(), Some(seed))
    }

    /// Mean and standard deviation of the motion under a held command.
    pub fn motion(&self, command: [f64; 2]) -> Motion<[f64; 2]> {
        let command = self.nuggets.scale.percent(command);
        let place = weights(command);
        let process = Motion::from_fn(|axis| self.along(&place, axis).dot(&self.axes[axis].mean));
        let known = self.nuggets.known(command, process);
        Motion::from_fn(|axis| {
            // What the process does there, but for what of it the command's own takes back where it is known.
            let (posterior, known) = (&self.axes[axis], &known[axis]);
            let along = self.along(&place, axis) - known.share * self.along(known.place, axis);
            let off = posterior.precision.l_dirty().solve_lower_triangular(&along);
            let of_process = off.map_or(0.0, |off| off.norm());
            let motion = along.dot(&posterior.mean) + known.share * known.motion;
            [motion, (of_process * of_process + known.deviation * known.deviation).sqrt()]
        })
    }

    /// Variances of what the first step of a command does beyond later ones, the same whenever one command follows the other.
    pub fn first_step_variances(&self) -> Motion<f64> {
        self.nuggets.noise.first_step.map(|deviation| deviation * deviation)
    }

    /// The process in a place as a sum over v.
    fn along(&self, weights: &[(usize, f64)], axis: Axis) -> DVector<f64> {
        let mut along = DVector::zeros(SIZE);
        for (node, weight) in weights {
            along += self.factor.row(*node).transpose() * *weight;
        }
        along.component_mul(&self.axes[axis].sizes)
    }

    fn nodes(&self, axis: &AxisPosterior, v: &DVector<f64>) -> Vec<f64> {
        (&self.factor * v.component_mul(&axis.sizes)).as_slice().to_vec()
    }
}

impl Likelihood {
    /// Sums [cells](by_cell) of evidence along an axis, which is relative to `held`; `factor` is that of
    /// [`basis`](super::basis).
    pub fn new(factor: &DMatrix<f64>, cells: &[Evidence], noise: &MotionNoise, held: Held, axis: Axis) -> Self {
        let (mut precision, mut pull) = (DMatrix::zeros(SIZE, SIZE), DVector::zeros(SIZE));
        for e in cells {
            let weights = e.weights(held.scale());
            let (motion, certainty) = (e.motion(held)[axis], 1.0 / e.variance_about_process(noise, held, axis));
            for &(i, a) in &weights {
                pull[i] += a * motion * certainty;
                for &(j, b) in &weights {
                    precision[(i, j)] += a * b * certainty;
                }
            }
        }
        Likelihood { gram: factor.tr_mul(&(precision * factor)), pull: factor.tr_mul(&pull) }
    }

    /// Logarithm of the probability of the evidence for sizes of the parts, up to a constant.
    pub fn log_evidence(&self, prior: &[f64; PARTS]) -> f64 {
        let Some(axis) = self.given(prior) else { return f64::NEG_INFINITY };
        let spread: f64 = axis.precision.l_dirty().diagonal().iter().map(|d| libm::log(*d)).sum();
        0.5 * axis.mean.dot(&self.pull.component_mul(&axis.sizes)) - spread
    }

    /// The distribution of the nodes for sizes of the parts.
    fn given(&self, prior: &[f64; PARTS]) -> Option<AxisPosterior> {
        let size = |part: usize| if part == LINE { LINE_SIZE } else { prior[part] };
        let sizes = DVector::from_fn(SIZE, |node, _| size(part(node)));
        let mut precision = DMatrix::from_fn(SIZE, SIZE, |i, j| sizes[i] * self.gram[(i, j)] * sizes[j]);
        precision.iter_mut().step_by(SIZE + 1).for_each(|diagonal| *diagonal += 1.0);
        let precision = Cholesky::new(precision)?;
        let mean = precision.solve(&self.pull.component_mul(&sizes));
        Some(AxisPosterior { sizes, precision, mean })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mindgap_foundations::statistics::summary::{mean, root_mean_square};

    /// Networks that turn a tenth less than the robot does.
    fn held([left, right]: [f64; 2]) -> Motion<f64> {
        Motion { turn: 0.9 * (right - left), ..Motion::ZERO }
    }

    /// Twenty commands whose turn is biased by a tenth of their difference, known to 0.2 degrees each.
    fn ensemble() -> Ensemble {
        let command = |i: usize| [(i * 7 % 20) as f32 * 8.0 - 76.0, (i * 11 % 20) as f32 * 8.0 - 76.0];
        let evidence = |i: usize| {
            let [left, right] = command(i);
            let bias = Motion { turn: 0.1 * (right - left), ..Motion::splat(0.0) };
            Evidence { command: [left, right], bias, variance: Motion::splat(0.04), after_training: false }
        };
        Ensemble {
            prior: Motion::splat([1.0, 1.0, 1.0, 5.0, 1.0, 0.0]),
            noise: MotionNoise::default(),
            evidence: (0..20).map(evidence).collect(),
        }
    }

    #[test]
    fn it_passes_through_evidence_and_is_wide_elsewhere() {
        let ensemble = ensemble();
        let posterior = Posterior::new(&ensemble, &held).unwrap();
        for e in &ensemble.evidence {
            let [at, deviation] = posterior.motion(e.command.map(f64::from)).turn;
            assert!((at - e.motion(&held).turn).abs() < 0.4 && deviation < 0.2, "{at} {deviation} {e:?}");
        }
        let none = Posterior::new(&Ensemble { evidence: Vec::new(), ..ensemble.clone() }, &held).unwrap();
        let [at, deviation] = none.motion([0.0, 0.0]).turn;
        assert!(at == 0.0 && (deviation - 29f64.sqrt()).abs() < 1.0, "{at} {deviation}");
    }

    /// Where no log has driven, the robot continues as it did and not as networks happen to extrapolate.
    #[test]
    fn beyond_the_evidence_it_is_the_robot_that_goes_on() {
        let wild = |command: [f64; 2]| {
            let beyond = f64::from(u8::from(command.iter().any(|c| c.abs() > 80.0)));
            held(command).map(|said| said + 50.0 * beyond)
        };
        let posterior = Posterior::new(&ensemble(), &wild).unwrap();
        let [at, deviation] = posterior.motion([95.0, -95.0]).turn;
        assert!((at + 190.0).abs() < 3.0 * deviation && deviation < 5.0, "{at} {deviation}");
    }

    #[test]
    fn draws_scatter_as_it_says() {
        let posterior = Posterior::new(&ensemble(), &held).unwrap();
        let command = [50.0, -50.0];
        let draws: Vec<f64> = (0..400).map(|seed| posterior.draw(seed).motion(command).turn).collect();
        let [expected, deviation] = posterior.motion(command).turn;
        let middle = mean(draws.iter().copied());
        let scatter = root_mean_square(draws.iter().map(|d| d - middle));
        assert!((middle - expected).abs() < 0.2 * deviation, "{middle} {expected} {deviation}");
        assert!((scatter / deviation - 1.0).abs() < 0.15, "{scatter} {deviation}");
        assert_eq!(posterior.draw(7).motion(command), posterior.draw(7).motion(command));
    }

    #[test]
    fn the_likelihood_prefers_the_size_that_made_the_evidence() {
        let factor = unit_factor();
        // A turn that saturates in the difference of the commands is no line.
        let bent = |[left, right]: [f64; 2]| Motion { turn: 20.0 * libm::tanh(0.05 * (right - left)), ..Motion::ZERO };
        let likelihood = Likelihood::new(&factor, &ensemble().evidence, &MotionNoise::default(), &bent, Axis::Turn);
        let at = |size: f64| likelihood.log_evidence(&[0.1, 0.1, 0.1, size, 0.1, 0.0]);
        assert!(at(5.0) > at(0.05) && at(5.0) > at(5000.0));
    }
}
