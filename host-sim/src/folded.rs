//! A network folded for speed: hidden summation units are linear and so is the output unit, so together they are one
//! affine map of the inputs. What remains are the product units.

use mindgap_core::network::{Activation, MAX_HALF, Network, ProductForm, ProductUnit, Scaling};
use mindgap_core::scalar::Scalar;

/// A network with `N` inputs as an affine map plus product units.
#[derive(Clone, Debug)]
pub struct Folded<const N: usize> {
    /// How each input is scaled.
    pub inputs: [Scaling<f32>; N],
    bias: f32,
    slope: [f32; N],
    product: heapless::Vec<ProductUnit<f32, N>, MAX_HALF>,
    product_form: ProductForm,
    activation: Activation,
}

impl<const N: usize> Folded<N> {
    /// Folds a network.
    pub fn new(network: &Network<f32, N>) -> Self {
        let mut folded = Folded {
            inputs: network.inputs,
            bias: network.bias,
            slope: [0.0; N],
            product: network.product.clone(),
            product_form: network.product_form,
            activation: network.activation,
        };
        for unit in &network.summation {
            folded.bias += unit.bias * unit.output;
            for (slope, weight) in folded.slope.iter_mut().zip(unit.weights) {
                *slope += weight * unit.output;
            }
        }
        folded
    }

    /// The output for scaled inputs and the logarithms of their magnitudes, which several networks may share.
    #[inline(always)]
    pub fn evaluate<S: Scalar<Weight = f32>>(&self, x: &[S; N], log2_x: &[S; N]) -> S {
        let mut sum = x[0].weight(self.bias);
        for (x, slope) in x.iter().zip(self.slope) {
            sum = sum + *x * x.weight(slope);
        }
        for unit in &self.product {
            let mut power = unit.magnitude(log2_x);
            if self.product_form == ProductForm::Signed {
                power = power * unit.sign(x);
            }
            sum = sum + power * power.weight(unit.output);
        }
        match self.activation {
            Activation::Linear => sum,
            Activation::Ramp => sum.clamp(sum.zero(), sum.one()),
        }
    }

    /// The inputs scaled, and the logarithms of their magnitudes.
    #[inline(always)]
    pub fn scale<S: Scalar<Weight = f32>>(&self, inputs: [S; N]) -> ([S; N], [S; N]) {
        let mut x = inputs;
        for (x, scaling) in x.iter_mut().zip(&self.inputs) {
            *x = scaling.apply(*x);
        }
        let mut log2_x = x;
        for value in &mut log2_x {
            *value = value.log2_magnitude();
        }
        (x, log2_x)
    }
}
