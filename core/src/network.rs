//! A simulator neural network (SNN): one hidden layer, half summation and half product units (paper, section VII).

mod units;

use core::fmt;

#[cfg(feature = "schemars")]
use schemars::JsonSchema;
#[cfg(feature = "serde")]
use serde::{Deserialize, Serialize};

#[cfg(feature = "serde")]
use units::array_as_sequence;
pub use units::{Activation, ProductForm, ProductUnit, Scaling, SummationUnit, Term};
pub(crate) use units::{add_terms, scale};

use crate::maths::Binary32;

/// The largest number of units of one kind in a hidden layer. The networks of Table I in the paper have up to 20.
pub const MAX_HALF: usize = 32;

/// A trained network with `N` inputs and one output, whose weights have the type `W`.
///
/// This is the form in which networks are trained and stored. To evaluate one quickly, fold it into a
/// [`FoldedNetwork`](crate::folded::FoldedNetwork).
///
/// ```
/// use mindgap_core::network::{Activation, Network, ProductUnit, Scaling};
///
/// // The square of an input in 0..=10: scaled to 1..=2 it is (1 + x/10)².
/// let mut square = Network::constant([Scaling::onto_one_to_two(0.0, 10.0)], 0.0);
/// square.product.push(ProductUnit { exponents: [2.0], output: 1.0 }).unwrap();
/// assert_eq!(square.activation, Activation::Linear);
/// assert_eq!(square.check(), Ok(()));
/// let y: f32 = square.evaluate([5.0]);
/// assert!((y - 2.25).abs() < 1e-5);
/// ```
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "serde", serde(bound(serialize = "W: Serialize", deserialize = "W: Deserialize<'de>")))]
#[cfg_attr(feature = "schemars", derive(JsonSchema), schemars(description = "A trained network."))]
pub struct Network<W, const N: usize> {
    /// Scaling of each input to the range in which the units work.
    #[cfg_attr(feature = "serde", serde(with = "array_as_sequence"))]
    #[cfg_attr(feature = "schemars", schemars(with = "[Scaling<W>]"))]
    pub inputs: [Scaling<W>; N],
    /// Range in which product units take their inputs.
    pub product_form: ProductForm,
    /// Activation function of the output unit.
    pub activation: Activation,
    /// Bias of the output unit.
    pub bias: W,
    /// Summation half of the hidden layer.
    #[cfg_attr(feature = "schemars", schemars(with = "[SummationUnit<W, N>]"))]
    pub summation: heapless::Vec<SummationUnit<W, N>, MAX_HALF>,
    /// Product half of the hidden layer.
    #[cfg_attr(feature = "schemars", schemars(with = "[ProductUnit<W, N>]"))]
    pub product: heapless::Vec<ProductUnit<W, N>, MAX_HALF>,
}

/// The reason why a network cannot be evaluated.
///
/// ```
/// use mindgap_core::network::{InvalidNetwork, Network, Scaling};
///
/// let network = Network::constant([Scaling::onto_one_to_two(0.0, 10.0)], f32::NAN);
/// assert_eq!(network.check(), Err(InvalidNetwork::NotFinite));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum InvalidNetwork {
    /// A weight, exponent, bias or scaling is NaN or infinite.
    NotFinite,
    /// The scaled range of an input is empty, or not above zero.
    BadScaling,
}

impl fmt::Display for InvalidNetwork {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            InvalidNetwork::NotFinite => "a weight, exponent, bias or scaling is not a finite number",
            InvalidNetwork::BadScaling => "an input's range is empty, or not above zero as product units need it",
        })
    }
}

impl core::error::Error for InvalidNetwork {}

impl<W: Copy, const N: usize> Network<W, N> {
    /// Returns a network without hidden units, whose output is `bias` everywhere.
    pub fn constant(inputs: [Scaling<W>; N], bias: W) -> Self {
        Network {
            inputs,
            product_form: ProductForm::Positive,
            activation: Activation::Linear,
            bias,
            summation: heapless::Vec::new(),
            product: heapless::Vec::new(),
        }
    }

    /// Returns the number of trained parameters. The five networks of Table I in the paper have 422.
    pub fn parameters(&self) -> usize {
        self.summation.len() * (N + 2) + self.product.len() * (N + 1) + 1
    }
}

impl<const N: usize> Network<f32, N> {
    /// Returns the output for one sample, in the unit that the network was trained in.
    ///
    /// An input outside the trained range counts as the end of the range. A NaN input gives NaN.
    ///
    /// Summation units are evaluated one by one, as the paper defines them, so they round differently from folded ones.
    /// The residuals and the accuracy in simulator files are those of this form.
    #[inline(always)]
    pub fn evaluate<S: Binary32>(&self, inputs: [S; N]) -> S {
        const { assert!(N > 0, "a network has at least one input") };
        let (x, log2_x) = scale(&self.inputs, inputs, false);
        let mut sum = x[0].constant(self.bias);
        for unit in &self.summation {
            let inner = S::weighted_sum(sum.constant(unit.bias), &x, &unit.weights);
            sum = sum + inner * inner.constant(unit.output);
        }
        self.activation.apply(add_terms(&self.product, sum, &log2_x))
    }

    /// Checks everything that a damaged file could break. A network that passes never gives NaN for finite inputs.
    ///
    /// # Errors
    /// Returns an [`InvalidNetwork`] that names the first fault found.
    pub fn check(&self) -> Result<(), InvalidNetwork> {
        let summation = self.summation.iter().flat_map(|u| u.weights.iter().chain([&u.bias, &u.output]));
        let product = self.product.iter().flat_map(|u| u.exponents.iter().chain([&u.output]));
        let scaling = self.inputs.iter().flat_map(|s| [&s.gain, &s.offset, &s.low, &s.high]);
        if !summation.chain(product).chain(scaling).chain([&self.bias]).all(|w| w.is_finite()) {
            return Err(InvalidNetwork::NotFinite);
        }
        if self.inputs.iter().any(|s| s.low > s.high || s.low <= 0.0) {
            return Err(InvalidNetwork::BadScaling);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::folded::FoldedNetwork;
    use proptest::prelude::*;

    fn network() -> Network<f32, 2> {
        let mut n = Network::constant([Scaling::onto_one_to_two(0.0, 100.0); 2], 0.5);
        n.summation.push(SummationUnit { weights: [0.25, -1.0], bias: 0.125, output: 2.0 }).unwrap();
        n.product.push(ProductUnit { exponents: [1.5, -0.75], output: -0.5 }).unwrap();
        n.product.push(ProductUnit { exponents: [3.0, 2.0], output: 0.1 }).unwrap();
        n
    }

    /// The output by the formulas of the paper and of Durbin and Rumelhart, in f64.
    fn by_formula(n: &Network<f32, 2>, inputs: [f32; 2]) -> f64 {
        let x: [f64; 2] = core::array::from_fn(|i| f64::from(n.inputs[i].apply(inputs[i])));
        let mut sum = f64::from(n.bias);
        for u in &n.summation {
            let inner = f64::from(u.bias) + x[0] * f64::from(u.weights[0]) + x[1] * f64::from(u.weights[1]);
            sum += inner * f64::from(u.output);
        }
        for u in &n.product {
            let power = x.iter().zip(u.exponents).map(|(x, e)| libm::pow(*x, f64::from(e))).product::<f64>();
            sum += power * f64::from(u.output);
        }
        sum
    }

    proptest! {
        #[test]
        fn trained_and_folded_forms_follow_the_formula(a in -10f32..110.0, b in -10f32..110.0) {
            let expected = by_formula(&network(), [a, b]);
            let folded = FoldedNetwork::fold(&network());
            for y in [network().evaluate([a, b]), folded.evaluate([a, b])] {
                prop_assert!((f64::from(y) - expected).abs() < 1e-5, "{y} {expected}");
            }
        }

        #[test]
        fn network_that_passes_the_check_stays_finite(
            exponents in prop::array::uniform2(-5f32..5.0), a in any::<f32>(), b in any::<f32>(),
        ) {
            prop_assume!(a.is_finite() && b.is_finite());
            let mut n = network();
            n.product[0].exponents = exponents;
            prop_assert_eq!(n.check(), Ok(()));
            prop_assert!(n.evaluate([a, b]).is_finite());
        }
    }

    #[test]
    fn ramp_clamps_the_output_to_a_probability() {
        let mut n = Network::constant([Scaling::onto_one_to_two(0.0, 1.0)], 1.5f32);
        n.activation = Activation::Ramp;
        assert_eq!(n.evaluate([0.3f32]), 1.0);
        n.bias = -0.5;
        assert_eq!(n.evaluate([0.3f32]), 0.0);
    }

    #[test]
    fn nan_input_gives_nan_and_a_weight_that_is_not_finite_is_rejected() {
        let mut n = network();
        assert!(n.evaluate([f32::NAN, 1.0]).is_nan() && FoldedNetwork::fold(&n).evaluate([f32::NAN, 1.0]).is_nan());
        n.product[1].exponents[0] = f32::INFINITY;
        assert_eq!(n.check(), Err(InvalidNetwork::NotFinite));
    }

    #[test]
    fn scaled_range_that_reaches_zero_is_rejected() {
        let mut n = network();
        n.inputs[1].low = 0.0;
        assert_eq!(n.check(), Err(InvalidNetwork::BadScaling));
    }

    #[test]
    fn networks_of_table_one_have_422_parameters() {
        fn parameters<const N: usize>(hidden: usize) -> usize {
            let mut n = Network::constant([Scaling::onto_one_to_two(0.0, 1.0); N], 0.0f32);
            for _ in 0..hidden / 2 {
                n.summation.push(SummationUnit { weights: [0.0; N], bias: 0.0, output: 0.0 }).unwrap();
                n.product.push(ProductUnit { exponents: [0.0; N], output: 0.0 }).unwrap();
            }
            n.parameters()
        }
        let motion = parameters::<4>(4) + 2 * parameters::<4>(20);
        assert_eq!(motion + parameters::<2>(10) + parameters::<2>(40), 422);
    }
}
