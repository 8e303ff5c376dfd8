//! A network folded for speed: hidden summation units are linear and so is the output unit, so together they are one
//! affine map of the inputs. What remains are the product units.

use mindgap_core::maths::{self, Binary32};
use mindgap_core::network::{Activation, MAX_HALF, Network, ProductForm, ProductUnit, Scaling};
use mindgap_core::scalar::{LEAST_MAGNITUDE, Scalar};

/// A network with `N` inputs as an affine map plus product units.
#[derive(Clone, Debug)]
pub struct Folded<const N: usize> {
    inputs: [Scaling<f32>; N],
    bias: f32,
    slope: [f32; N],
    product: heapless::Vec<ProductUnit<f32, N>, MAX_HALF>,
    product_form: ProductForm,
    /// Whether inputs are scaled to where they have no signs, and every power stays far from overflow.
    tame: bool,
    activation: Activation,
}

/// The outputs of several networks for the same inputs. Those that scale them alike share the logarithms.
#[inline(always)]
pub fn evaluate_all<S: Scalar<Weight = f32> + Binary32, const N: usize, const K: usize>(
    networks: &[Folded<N>; K],
    inputs: [S; N],
) -> [S; K] {
    let mut outputs = [inputs[0]; K];
    let (mut x, mut log2_x) = networks[0].scale(inputs);
    for (i, network) in networks.iter().enumerate() {
        if network.inputs != networks[i.saturating_sub(1)].inputs {
            (x, log2_x) = network.scale(inputs);
        }
        outputs[i] = network.evaluate(&x, &log2_x);
    }
    outputs
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
            tame: is_tame(network),
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
    pub fn evaluate<S: Scalar<Weight = f32> + Binary32>(&self, x: &[S; N], log2_x: &[S; N]) -> S {
        let mut sum = S::weighted_sum(x[0].weight(self.bias), x, &self.slope);
        if self.tame {
            // Two at a time, so that they share what the polynomial needs.
            let (pairs, last) = self.product.as_chunks::<2>();
            for [one, other] in pairs {
                let powers = [tame_power(one, log2_x), tame_power(other, log2_x)];
                sum = sum + powers[0] * sum.weight(one.output);
                sum = sum + powers[1] * sum.weight(other.output);
            }
            for unit in last {
                sum = sum + tame_power(unit, log2_x) * sum.weight(unit.output);
            }
        } else {
            sum = self.wild_sum(sum, x, log2_x);
        }
        self.activation.apply(sum)
    }

    /// The outputs for two inputs, the same bits as one after the other: they share what the polynomial needs.
    #[inline(always)]
    pub fn evaluate_two<S: Scalar<Weight = f32> + Binary32>(&self, x: &[[S; N]; 2], log2_x: &[[S; N]; 2]) -> [S; 2] {
        if !self.tame {
            return [self.evaluate(&x[0], &log2_x[0]), self.evaluate(&x[1], &log2_x[1])];
        }
        let bias = x[0][0].weight(self.bias);
        let mut sums = [S::weighted_sum(bias, &x[0], &self.slope), S::weighted_sum(bias, &x[1], &self.slope)];
        for unit in &self.product {
            let powers = [tame_power(unit, &log2_x[0]), tame_power(unit, &log2_x[1])];
            sums = [sums[0] + powers[0] * bias.weight(unit.output), sums[1] + powers[1] * bias.weight(unit.output)];
        }
        [self.activation.apply(sums[0]), self.activation.apply(sums[1])]
    }

    /// Adds the product units of a network whose inputs may have signs, or whose powers may overflow.
    #[inline(always)]
    fn wild_sum<S: Scalar<Weight = f32> + Binary32>(&self, start: S, x: &[S; N], log2_x: &[S; N]) -> S {
        let mut sum = start;
        for unit in &self.product {
            let mut power = unit.magnitude(log2_x);
            if self.product_form == ProductForm::Signed {
                power = power * unit.sign(x);
            }
            sum = sum + power * power.weight(unit.output);
        }
        sum
    }

    /// The inputs scaled, and the logarithms of their magnitudes.
    #[inline(always)]
    fn scale<S: Scalar<Weight = f32> + Binary32>(&self, inputs: [S; N]) -> ([S; N], [S; N]) {
        let mut x = inputs;
        for (x, scaling) in x.iter_mut().zip(&self.inputs) {
            *x = scaling.apply(*x);
        }
        let mut log2_x = x;
        for value in &mut log2_x {
            *value = if self.tame { maths::log2_normal(*value) } else { value.log2_magnitude() };
        }
        (x, log2_x)
    }
}

/// Logarithms of powers that are tame stay within this, far from what [`maths::exp2_within`] needs.
const TAME_LOG2: f32 = 100.0;

fn is_tame<const N: usize>(network: &Network<f32, N>) -> bool {
    let log2 = |x: f32| x.log2_magnitude().abs();
    let farthest = |(exponent, s): (&f32, &Scaling<f32>)| exponent.abs() * log2(s.low).max(log2(s.high));
    let log2_of = |u: &ProductUnit<f32, N>| u.exponents.iter().zip(&network.inputs).map(farthest).sum::<f32>();
    network.product_form == ProductForm::Positive
        && network.inputs.iter().all(|s| s.low >= LEAST_MAGNITUDE)
        && network.product.iter().all(|u| log2_of(u) <= TAME_LOG2)
}

#[inline(always)]
fn tame_power<S: Scalar<Weight = f32> + Binary32, const N: usize>(unit: &ProductUnit<f32, N>, log2_x: &[S; N]) -> S {
    let mut terms = log2_x.iter().zip(&unit.exponents);
    let Some((x, exponent)) = terms.next() else { return log2_x[0].one() };
    let mut log2 = *x * x.weight(*exponent);
    for (x, exponent) in terms {
        log2 = log2 + *x * x.weight(*exponent);
    }
    maths::exp2_within(log2)
}
