//! Direct encoding of networks: "each individual in the GA encoded potential weight values directly"
//! (paper, section VII).

use mindgap_core::network::{Activation, MAX_HALF, Network, ProductForm, ProductUnit, Scaling, SummationUnit};

/// Number of hidden units of each kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shape {
    /// Summation units, at most [`MAX_HALF`].
    pub summation: usize,
    /// Product units, at most [`MAX_HALF`].
    pub product: usize,
}

/// A network without its weights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NetworkTemplate<const N: usize> {
    /// Number of hidden units.
    pub shape: Shape,
    /// Scaling of the inputs.
    pub inputs: [Scaling<f32>; N],
    /// Activation of the output unit.
    pub activation: Activation,
}

impl Shape {
    /// Returns a hidden layer of `hidden` neurons, half of each kind (paper, Table I).
    ///
    /// # Panics
    /// When `hidden` is odd or a half exceeds [`MAX_HALF`].
    pub const fn halves(hidden: usize) -> Self {
        assert!(hidden.is_multiple_of(2) && hidden / 2 <= MAX_HALF, "a hidden layer has two halves that fit");
        Shape { summation: hidden / 2, product: hidden / 2 }
    }

    /// As [`halves`](Self::halves), but returns `None` if that would panic or if `hidden` is 0.
    pub fn checked_halves(hidden: usize) -> Option<Self> {
        (hidden > 0 && hidden.is_multiple_of(2) && hidden / 2 <= MAX_HALF).then(|| Self::halves(hidden))
    }
}

impl<const N: usize> NetworkTemplate<N> {
    /// Returns the number of genes.
    pub fn genes(&self) -> usize {
        self.shape.summation * (N + 2) + self.shape.product * (N + 1) + 1
    }

    /// Returns the indices of the exponents among the genes.
    pub fn exponents(&self) -> impl Iterator<Item = usize> + use<N> {
        let first = self.shape.summation * (N + 2);
        (0..self.shape.product).flat_map(move |unit| (0..N).map(move |i| first + unit * (N + 1) + i))
    }

    /// Decodes [`genes`](Self::genes) numbers: summation units (weights, bias, output), product units (exponents,
    /// output), bias of the output.
    pub fn network(&self, genes: &[f32]) -> Network<f32, N> {
        let (summation, rest) = genes.split_at(self.shape.summation * (N + 2));
        let (product, bias) = rest.split_at(self.shape.product * (N + 1));
        Network {
            inputs: self.inputs,
            product_form: ProductForm::Positive,
            activation: self.activation,
            bias: bias[0],
            summation: summation
                .chunks_exact(N + 2)
                .map(|g| SummationUnit { weights: std::array::from_fn(|i| g[i]), bias: g[N], output: g[N + 1] })
                .collect(),
            product: product
                .chunks_exact(N + 1)
                .map(|g| ProductUnit { exponents: std::array::from_fn(|i| g[i]), output: g[N] })
                .collect(),
        }
    }
}

/// Rescales a network whose output `z` means `low + (z - 1)(high - low)` so that it returns that value itself.
pub fn unscale_output<const N: usize>(network: &mut Network<f32, N>, low: f32, high: f32) {
    let gain = high - low;
    network.bias = low + (network.bias - 1.0) * gain;
    network.summation.iter_mut().for_each(|u| u.output *= gain);
    network.product.iter_mut().for_each(|u| u.output *= gain);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn template() -> NetworkTemplate<2> {
        NetworkTemplate {
            shape: Shape::halves(4),
            inputs: [Scaling::onto_one_to_two(0.0, 1.0); 2],
            activation: Activation::Linear,
        }
    }

    #[test]
    fn every_gene_has_its_place() {
        let genes: Vec<f32> = (0..template().genes()).map(|i| i as f32).collect();
        let network = template().network(&genes);
        assert_eq!(network.parameters(), genes.len());
        assert_eq!(network.summation[1], SummationUnit { weights: [4.0, 5.0], bias: 6.0, output: 7.0 });
        assert_eq!(network.product[1], ProductUnit { exponents: [11.0, 12.0], output: 13.0 });
        assert_eq!(network.bias, 14.0);
        assert_eq!(template().exponents().collect::<Vec<_>>(), [8, 9, 11, 12]);
    }

    #[test]
    fn unscaling_moves_the_output_alone() {
        let genes: Vec<f32> = (0..template().genes()).map(|i| 0.1 * i as f32 - 0.7).collect();
        let scaled = template().network(&genes);
        let mut plain = scaled.clone();
        unscale_output(&mut plain, -20.0, 30.0);
        for inputs in [[0.0f32, 0.0], [0.3, 0.9]] {
            let z: f32 = scaled.evaluate(inputs);
            let y: f32 = plain.evaluate(inputs);
            assert!((y - (-20.0 + (z - 1.0) * 50.0)).abs() < 1e-3);
        }
    }
}
