//! The trainer of the paper, section VII: the genetic algorithm on all weights, with the inverse of the mean squared
//! error as fitness.

use mindgap_core::network::{Activation, Network, Scaling};
use rand::RngExt;

use super::dataset::Dataset;
use super::genome::{NetworkTemplate, Shape, unscale_output};
use super::kernel::Samples;
use crate::genetic::{self, Settings};
use mindgap_foundations::error::Result;
use mindgap_foundations::random::Generator;

/// Parameters of the trainer. The defaults are those of the paper; where it gives none (marked "open"), they are common
/// choices.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// The genetic algorithm.
    pub genetic: Settings,
    /// Weights and exponents start uniformly in ± this (open; 1).
    pub start: f32,
    /// Exponents stay in ± this (open; 5).
    pub exponent_bound: f32,
}

/// A trained network and its cost.
#[derive(Clone, Debug, PartialEq)]
pub struct Trained<const N: usize> {
    /// The network, in the units of its data set.
    pub network: Network<f32, N>,
    /// Number of evaluations of a network over the data set: individuals times generations.
    pub evaluations: usize,
}

impl Default for Options {
    fn default() -> Self {
        Options { genetic: Settings::default(), start: 1.0, exponent_bound: 5.0 }
    }
}

/// Trains one network. The data set must have samples whose inputs and targets vary. `watch` receives the generation and
/// the best fitness up to it.
///
/// # Errors
/// As [`genetic::run`].
pub fn train<const N: usize>(
    data: &Dataset<N>,
    shape: Shape,
    activation: Activation,
    options: &Options,
    seed: u64,
    watch: impl FnMut(usize, f64),
) -> Result<Trained<N>> {
    // The paper is silent on how inputs are scaled; on [1, 2] every power is real.
    let inputs = data.ranges().map(|range| Scaling::onto_one_to_two(*range.start(), *range.end()));
    let template = NetworkTemplate { shape, inputs, activation };
    // A probability is learned as it is; other targets are scaled to [1, 2], which weights of about one can reach.
    let (low, high) = match activation {
        Activation::Ramp => (1.0, 2.0),
        Activation::Linear => data.target_range().into_inner(),
    };
    let samples = Samples::new(data, &inputs, |target| 1.0 + (target - low) / (high - low));
    let problem = Weights { template, samples, options };
    let outcome = genetic::run(&options.genetic, &problem, seed, watch)?;
    let mut network = template.network(&outcome.best);
    unscale_output(&mut network, low, high);
    Ok(Trained { network, evaluations: outcome.generations * options.genetic.population })
}

/// The search for weights as an optimisation problem: the genes are the weights.
struct Weights<'a, const N: usize> {
    template: NetworkTemplate<N>,
    samples: Samples<N>,
    options: &'a Options,
}

impl<const N: usize> genetic::Problem for Weights<'_, N> {
    fn random(&self, rng: &mut Generator) -> Vec<f32> {
        let start = self.options.start;
        (0..self.template.genes()).map(|_| rng.random_range(-start..=start)).collect()
    }

    fn repair(&self, genes: &mut [f32]) {
        let bound = self.options.exponent_bound;
        for place in self.template.exponents() {
            genes[place] = genes[place].clamp(-bound, bound);
        }
    }

    fn fitness(&self, _: usize, _: usize, individuals: &[Vec<f32>]) -> Vec<f64> {
        let error = |genes: &Vec<f32>| self.samples.mean_squared_error(&self.template.network(genes));
        individuals.iter().map(|genes| 1.0 / error(genes)).collect()
    }
}
