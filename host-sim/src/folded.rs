//! A network folded for speed: hidden summation units are linear and so is the output unit, so together they are one
//! affine map of the inputs. What remains are the product units.

use mindgap_core::maths::{self, Binary32};
use mindgap_core::network::{Activation, MAX_HALF, Network, ProductForm, ProductUnit, Scaling};
use mindgap_core::scalar::{LEAST_MAGNITUDE, Scalar};

use crate::lanes::twice::Twice;

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
            // Two at a time, which keep a processor busy.
            let (pairs, last) = self.product.as_chunks::<2>();
            for [one, other] in pairs {
                let powers = maths::exp2_within(Twice(log2_power(one, log2_x), log2_power(other, log2_x)));
                sum = sum + powers.0 * sum.weight(one.output);
                sum = sum + powers.1 * sum.weight(other.output);
            }
            for unit in last {
                sum = sum + maths::exp2_within(log2_power(unit, log2_x)) * sum.weight(unit.output);
            }
        } else {
            sum = self.wild_sum(sum, x, log2_x);
        }
        self.activation.apply(sum)
    }

    /// The same for two inputs, which keep a processor busy with one unit after the other.
    #[inline(always)]
    pub fn evaluate_twice<S: Scalar<Weight = f32> + Binary32>(
        &self,
        x: &[Twice<S>; N],
        log2_x: &[Twice<S>; N],
    ) -> Twice<S> {
        let mut sum = Twice::weighted_sum(x[0].weight(self.bias), x, &self.slope);
        if self.tame {
            for unit in &self.product {
                sum = sum + maths::exp2_within(log2_power(unit, log2_x)) * sum.weight(unit.output);
            }
        } else {
            sum = self.wild_sum(sum, x, log2_x);
        }
        self.activation.apply(sum)
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
fn log2_power<S: Scalar<Weight = f32> + Binary32, const N: usize>(unit: &ProductUnit<f32, N>, log2_x: &[S; N]) -> S {
    let mut terms = log2_x.iter().zip(&unit.exponents);
    let Some((x, exponent)) = terms.next() else { return log2_x[0].zero() };
    let mut log2 = *x * x.weight(*exponent);
    for (x, exponent) in terms {
        log2 = log2 + *x * x.weight(*exponent);
    }
    log2
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::Lanes;
    use crate::lanes::twice::Twice;
    use mindgap_core::network::SummationUnit;
    use proptest::prelude::*;

    /// Numbers of every size, zero and denormal ones among them.
    fn any_size() -> impl Strategy<Value = f32> {
        prop_oneof![
            Just(0.0f32),
            Just(f32::MIN_POSITIVE / 8.0),
            -3.0f32..3.0,
            -1e4f32..1e4,
            Just(1e30f32),
            Just(-1e30f32),
            Just(f32::INFINITY)
        ]
    }

    fn network(genes: &[f32], product_form: ProductForm) -> Network<f32, 2> {
        let scaling = match product_form {
            ProductForm::Positive => Scaling::onto_one_to_two(0.0, 100.0),
            ProductForm::Signed => Scaling::onto_minus_one_to_one(0.0, 100.0),
        };
        let mut network = Network::constant([scaling; 2], genes[0]);
        network.product_form = product_form;
        let unit = SummationUnit { weights: [genes[1], genes[2]], bias: genes[3], output: genes[4] };
        network.summation.push(unit).unwrap();
        for unit in genes[5..].chunks_exact(3) {
            let unit = ProductUnit { exponents: [unit[0], unit[1]], output: unit[2] };
            network.product.push(unit).unwrap();
        }
        network
    }

    fn number(lane: Lanes<pulp::Scalar>) -> f32 {
        let mut number = [0.0];
        lane.store(&mut number);
        number[0]
    }

    fn same(a: f32, b: f32) -> bool {
        a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan())
    }

    proptest! {
        #[test]
        fn lanes_twice_and_one_by_one_give_the_same_bits(
            genes in prop::collection::vec(any_size(), 14), inputs in prop::array::uniform2(any_size()), signed in any::<bool>(),
        ) {
            let form = if signed { ProductForm::Signed } else { ProductForm::Positive };
            let folded = Folded::new(&network(&genes, form));
            let (x, log2_x) = folded.scale(inputs);
            let single = folded.evaluate(&x, &log2_x);
            let (x, log2_x) = folded.scale(inputs.map(|input| Twice(input, input)));
            let twice = folded.evaluate_twice(&x, &log2_x);
            let lanes = inputs.map(|input| Lanes::splat(pulp::Scalar::new(), input));
            let (x, log2_x) = folded.scale(lanes);
            let lane = number(folded.evaluate(&x, &log2_x));
            prop_assert!(same(single, lane) && same(single, twice.0) && same(single, twice.1), "{single} {lane} {twice:?}");
        }

        #[test]
        fn tame_powers_are_taken_like_wild_ones(
            genes in prop::collection::vec(-20f32..20.0, 20), inputs in prop::array::uniform2(-20f32..120.0),
        ) {
            let folded = Folded::new(&network(&genes, ProductForm::Positive));
            prop_assert!(folded.tame);
            let wild = Folded { tame: false, ..folded.clone() };
            let evaluate = |f: &Folded<2>| {
                let (x, log2_x) = f.scale(inputs);
                f.evaluate(&x, &log2_x)
            };
            prop_assert_eq!(evaluate(&folded).to_bits(), evaluate(&wild).to_bits());
        }

        #[test]
        fn folding_changes_a_network_by_no_more_than_rounding(
            genes in prop::collection::vec(-3f32..3.0, 20), inputs in prop::array::uniform2(-20f32..120.0),
        ) {
            let network = network(&genes, ProductForm::Positive);
            let [folded] = evaluate_all(&[Folded::new(&network)], inputs);
            let plain = network.evaluate(inputs);
            prop_assert!((folded - plain).abs() <= 1e-4 * (1.0 + plain.abs()), "{folded} {plain}");
        }
    }
}
