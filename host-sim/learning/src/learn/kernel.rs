//! The training kernel: the mean squared error of one network over all samples, vectorised.
//!
//! Scaled inputs and their logarithms do not depend on the weights and are computed once for each data set.

use std::array;

use mindgap_core::folded::FoldedNetwork;
use mindgap_core::maths;
use mindgap_core::network::{Network, Scaling};
use mindgap_core::pair::Pair;
use pulp::{Arch, Simd, WithSimd};

use super::dataset::Dataset;
use mindgap_foundations::lanes::{Lanes, WIDEST};

/// Samples laid out for vector lanes.
#[derive(Clone, Debug)]
pub struct Samples<const N: usize> {
    blocks: Vec<Block<N>>,
    count: usize,
}

/// Two of the widest vectors of samples, padded by samples of weight zero.
#[derive(Clone, Debug)]
struct Block<const N: usize> {
    scaled: [[f32; BLOCK]; N],
    log2: [[f32; BLOCK]; N],
    targets: [f32; BLOCK],
    weights: [f32; BLOCK],
}

const BLOCK: usize = 2 * WIDEST;

impl<const N: usize> Samples<N> {
    /// Lays out a data set whose inputs are scaled by `inputs` and whose targets are mapped by `target`.
    pub fn new(data: &Dataset<N>, inputs: &[Scaling<f32>; N], target: impl Fn(f32) -> f32) -> Self {
        let block = |first: usize| {
            let exists = |lane: usize| first + lane < data.len();
            let scaled: [[f32; BLOCK]; N] = array::from_fn(|n| {
                let scaled = |lane: usize| inputs[n].apply(data.inputs[first + lane][n]);
                array::from_fn(|lane| if exists(lane) { scaled(lane) } else { inputs[n].high })
            });
            Block {
                log2: scaled.map(|row| row.map(maths::log2)),
                scaled,
                targets: array::from_fn(|lane| if exists(lane) { target(data.targets[first + lane]) } else { 0.0 }),
                weights: array::from_fn(|lane| if exists(lane) { 1.0 } else { 0.0 }),
            }
        };
        Samples { blocks: (0..data.len()).step_by(BLOCK).map(block).collect(), count: data.len() }
    }

    /// Returns the mean squared error of a network over the samples, in the unit of the mapped targets; NaN without samples.
    pub fn mean_squared_error(&self, network: &Network<f32, N>) -> f64 {
        Arch::new().dispatch(SquaredError { samples: self, network: &FoldedNetwork::fold(network) }) / self.count as f64
    }
}

struct SquaredError<'a, const N: usize> {
    samples: &'a Samples<N>,
    network: &'a FoldedNetwork<f32, N>,
}

impl<const N: usize> WithSimd for SquaredError<'_, N> {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> f64 {
        let mut sums = [Lanes::splat(simd, 0.0); WIDEST];
        let width = Lanes::<S>::WIDTH;
        let parts = WIDEST / width;
        // Each sum adds its samples in their order, whatever the width of the vectors.
        for block in &self.samples.blocks {
            for part in (0..2 * parts).step_by(2) {
                let at = [part * width, (part + 1) * width];
                let x = rows(simd, &block.scaled, at);
                let log2_x = rows(simd, &block.log2, at);
                let outputs = self.network.evaluate_scaled_pair(&x, &log2_x);
                let errors = (outputs - row(simd, &block.targets, at)) * row(simd, &block.weights, at);
                let squares = errors * errors;
                sums[part % parts] = sums[part % parts] + squares.0;
                sums[(part + 1) % parts] = sums[(part + 1) % parts] + squares.1;
            }
        }
        let mut total = [0.0; WIDEST];
        for (sum, part) in sums.iter().zip(total.chunks_mut(Lanes::<S>::WIDTH)) {
            sum.store(part);
        }
        total.into_iter().map(f64::from).sum()
    }
}

/// Two vectors of each row.
#[inline(always)]
fn rows<S: Simd, const N: usize>(simd: S, rows: &[[f32; BLOCK]; N], at: [usize; 2]) -> [Pair<Lanes<S>>; N] {
    let zero = Lanes::splat(simd, 0.0);
    let mut vectors = [Pair(zero, zero); N];
    for (vectors, row) in vectors.iter_mut().zip(rows) {
        *vectors = self::row(simd, row, at);
    }
    vectors
}

/// Two vectors of a row.
#[inline(always)]
fn row<S: Simd>(simd: S, row: &[f32; BLOCK], at: [usize; 2]) -> Pair<Lanes<S>> {
    Pair(Lanes::load(simd, &row[at[0]..]), Lanes::load(simd, &row[at[1]..]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::learn::genome::{NetworkTemplate, Shape};
    use mindgap_core::network::Activation;
    use mindgap_foundations::random::generator;
    use proptest::prelude::*;
    use rand::RngExt;

    fn data(count: usize) -> Dataset<2> {
        let mut rng = generator(1, &[count as u64]);
        let mut data = Dataset::default();
        for i in 0..count {
            data.push([rng.random_range(0.0..100.0), rng.random_range(0.0..90.0)], rng.random(), i);
        }
        data
    }

    fn template() -> NetworkTemplate<2> {
        let inputs = [Scaling::onto_one_to_two(0.0, 100.0), Scaling::onto_one_to_two(0.0, 90.0)];
        NetworkTemplate { shape: Shape::halves(6), inputs, activation: Activation::Linear }
    }

    proptest! {
        #[test]
        fn kernel_agrees_with_the_network(
            genes in prop::collection::vec(-1.5f32..1.5, 22), count in 1usize..70,
        ) {
            let (template, data) = (template(), data(count));
            let network = template.network(&genes);
            let one_by_one: f64 = data.inputs.iter().zip(&data.targets).map(|(x, t)| {
                let error = f64::from(network.evaluate(*x) - t);
                error * error
            }).sum::<f64>() / count as f64;
            let mse = Samples::new(&data, &template.inputs, |t| t).mean_squared_error(&network);
            prop_assert!((mse - one_by_one).abs() <= 1e-3 * (1e-3 + one_by_one), "{mse} {one_by_one}");
        }

        #[test]
        fn every_instruction_set_gives_the_same_bits(genes in prop::collection::vec(-3f32..3.0, 22)) {
            let template = template();
            let samples = &Samples::new(&data(100), &template.inputs, |t| t);
            let network = template.network(&genes);
            let network = &FoldedNetwork::fold(&network);
            let scalar = pulp::Scalar::new().vectorize(SquaredError { samples, network });
            let widest = Arch::new().dispatch(SquaredError { samples, network });
            prop_assert_eq!(scalar.to_bits(), widest.to_bits());
        }
    }
}
