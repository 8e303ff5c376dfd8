//! The training kernel: the error of one network over all samples, in lanes.
//!
//! What does not depend on the weights is worked out once a data set: scaled inputs and their logarithms.

use mindgap_core::network::{Network, Scaling};
use mindgap_core::scalar::Scalar;
use pulp::{Arch, Simd, WithSimd};

use super::dataset::Dataset;
use crate::folded::Folded;
use crate::lanes::{Lanes, WIDEST};

/// Two of the widest vectors.
const BLOCK: usize = 2 * WIDEST;

/// Samples laid out for lanes: one row an input, filled up to whole blocks by samples without weight.
#[derive(Clone, Debug)]
pub struct Samples<const N: usize> {
    scaled: [Vec<f32>; N],
    log2: [Vec<f32>; N],
    targets: Vec<f32>,
    weights: Vec<f32>,
    count: usize,
}

impl<const N: usize> Samples<N> {
    /// Lays out a data set whose inputs are scaled so and whose targets are mapped by `target`.
    pub fn new(data: &Dataset<N>, inputs: &[Scaling<f32>; N], target: impl Fn(f32) -> f32) -> Self {
        let blocks = data.len().div_ceil(BLOCK);
        let filled = |value: &dyn Fn(usize) -> f32, filling: f32| -> Vec<f32> {
            (0..blocks * BLOCK).map(|i| if i < data.len() { value(i) } else { filling }).collect()
        };
        let scaled: [Vec<f32>; N] =
            std::array::from_fn(|n| filled(&|i| inputs[n].apply(data.inputs[i][n]), inputs[n].high));
        Samples {
            log2: std::array::from_fn(|n| scaled[n].iter().map(|x| x.log2_magnitude()).collect()),
            scaled,
            targets: filled(&|i| target(data.targets[i]), 0.0),
            weights: filled(&|_| 1.0, 0.0),
            count: data.len(),
        }
    }

    /// Mean squared error of a network over the samples, in the unit of the mapped targets; NaN without samples.
    pub fn mean_squared_error(&self, network: &Network<f32, N>) -> f64 {
        Arch::new().dispatch(SquaredError { samples: self, network: &Folded::new(network) }) / self.count as f64
    }
}

struct SquaredError<'a, const N: usize> {
    samples: &'a Samples<N>,
    network: &'a Folded<N>,
}

impl<const N: usize> WithSimd for SquaredError<'_, N> {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> f64 {
        let samples = self.samples;
        let mut sums = [Lanes::splat(simd, 0.0); WIDEST];
        let width = Lanes::<S>::WIDTH;
        let parts = WIDEST / width;
        // Two vectors at a time, as far as there are two; each sum meets its samples in their order.
        for block in (0..samples.targets.len()).step_by(BLOCK) {
            for pair in 0..parts {
                let first = block + 2 * pair * width;
                let at = [first, first + width];
                let x = [rows(simd, &samples.scaled, at[0]), rows(simd, &samples.scaled, at[1])];
                let log2_x = [rows(simd, &samples.log2, at[0]), rows(simd, &samples.log2, at[1])];
                let outputs = self.network.evaluate_two(&x, &log2_x);
                for (i, output) in outputs.into_iter().enumerate() {
                    let target = Lanes::load(simd, &samples.targets[at[i]..]);
                    let weight = Lanes::load(simd, &samples.weights[at[i]..]);
                    let error = (output - target) * weight;
                    let sum = &mut sums[(2 * pair + i) % parts];
                    *sum = *sum + error * error;
                }
            }
        }
        let mut total = [0.0; WIDEST];
        for (sum, part) in sums.iter().zip(total.chunks_mut(Lanes::<S>::WIDTH)) {
            sum.store(part);
        }
        total.into_iter().map(f64::from).sum()
    }
}

/// One vector of each input.
#[inline(always)]
fn rows<S: Simd, const N: usize>(simd: S, inputs: &[Vec<f32>; N], at: usize) -> [Lanes<S>; N] {
    let mut rows = [Lanes::splat(simd, 0.0); N];
    for (row, input) in rows.iter_mut().zip(inputs) {
        *row = Lanes::load(simd, &input[at..]);
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chance::generator;
    use crate::learn::genome::{Frame, Shape};
    use mindgap_core::network::{Activation, ProductForm};
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

    fn frame(signed: bool) -> Frame<2> {
        let (scale, product_form): (fn(f32, f32) -> Scaling<f32>, _) = if signed {
            (Scaling::onto_minus_one_to_one, ProductForm::Signed)
        } else {
            (Scaling::onto_one_to_two, ProductForm::Positive)
        };
        let inputs = [scale(0.0, 100.0), scale(0.0, 90.0)];
        Frame { shape: Shape::halves(6), inputs, product_form, activation: Activation::Linear }
    }

    proptest! {
        #[test]
        fn the_kernel_agrees_with_the_network(
            genes in prop::collection::vec(-1.5f32..1.5, 22), count in 1usize..70, signed in any::<bool>(),
        ) {
            let (frame, data) = (frame(signed), data(count));
            let network = frame.network(&genes);
            let one_by_one: f64 = data.inputs.iter().zip(&data.targets).map(|(x, t)| {
                let error = f64::from(network.evaluate(*x) - t);
                error * error
            }).sum::<f64>() / count as f64;
            let mse = Samples::new(&data, &frame.inputs, |t| t).mean_squared_error(&network);
            prop_assert!((mse - one_by_one).abs() <= 1e-3 * (1e-3 + one_by_one), "{mse} {one_by_one}");
        }

        #[test]
        fn every_instruction_set_gives_the_same_bits(genes in prop::collection::vec(-3f32..3.0, 22), signed in any::<bool>()) {
            let frame = frame(signed);
            let samples = &Samples::new(&data(100), &frame.inputs, |t| t);
            let network = frame.network(&genes);
            let network = &Folded::new(&network);
            let scalar = pulp::Scalar::new().vectorize(SquaredError { samples, network });
            let widest = Arch::new().dispatch(SquaredError { samples, network });
            prop_assert_eq!(scalar.to_bits(), widest.to_bits());
        }
    }
}
