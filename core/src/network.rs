//! A simulator neural network (SNN): one hidden layer, half summation and half product units (paper, section VII).

use core::fmt;

use serde::{Deserialize, Serialize};

use crate::folded::{add_terms, scale};
use crate::maths::Binary32;
use crate::scalar::Scalar;

/// The most units of one kind in a hidden layer; Table I needs 20.
pub const MAX_HALF: usize = 32;

/// A trained network with `N` inputs and one output, its weights stored as `W`: a description, which is evaluated
/// quickly once it is folded (see [`FoldedNetwork`](crate::folded::FoldedNetwork)).
///
/// ```
/// use mindgap_core::network::{Activation, Network, ProductForm, ProductUnit, Scaling};
///
/// // The square of an input of 0..10: scaled to 1..2 it is (1 + x/10)^2.
/// let mut square = Network::constant([Scaling::onto_one_to_two(0.0, 10.0)], 0.0);
/// square.product.push(ProductUnit { exponents: [2.0], output: 1.0 }).unwrap();
/// assert_eq!(square.activation, Activation::Linear);
/// assert_eq!(square.product_form, ProductForm::Positive);
/// let y: f32 = square.evaluate([5.0]);
/// assert!((y - 2.25).abs() < 1e-5);
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(bound(serialize = "W: Serialize", deserialize = "W: Deserialize<'de>"))]
pub struct Network<W, const N: usize> {
    /// How each input is brought to the range that the units work in.
    #[serde(with = "array_as_sequence")]
    pub inputs: [Scaling<W>; N],
    /// The range in which product units take their inputs.
    pub product_form: ProductForm,
    /// What the output unit does with its sum.
    pub activation: Activation,
    /// Bias of the output unit.
    pub bias: W,
    /// The summation half of the hidden layer.
    pub summation: heapless::Vec<SummationUnit<W, N>, MAX_HALF>,
    /// The product half of the hidden layer.
    pub product: heapless::Vec<ProductUnit<W, N>, MAX_HALF>,
}

/// An affine map of one input, clamped to the range that was trained: `clamp(x · gain + offset, low, high)`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Scaling<W> {
    /// Factor.
    pub gain: W,
    /// Summand.
    pub offset: W,
    /// Least scaled value; an input further out counts as this.
    pub low: W,
    /// Largest scaled value.
    pub high: W,
}

/// A summation unit of the hidden layer, linear, with its weight in the output sum.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(bound(serialize = "W: Serialize", deserialize = "W: Deserialize<'de>"))]
pub struct SummationUnit<W, const N: usize> {
    /// One weight an input.
    #[serde(with = "array_as_sequence")]
    pub weights: [W; N],
    /// Added to the weighted sum.
    pub bias: W,
    /// Weight of this unit in the output sum.
    pub output: W,
}

/// A product unit of the hidden layer: its inputs raised to trained powers and multiplied (Durbin and Rumelhart 1989),
/// without bias, with its weight in the output sum.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(bound(serialize = "W: Serialize", deserialize = "W: Deserialize<'de>"))]
pub struct ProductUnit<W, const N: usize> {
    /// One exponent an input.
    #[serde(with = "array_as_sequence")]
    pub exponents: [W; N],
    /// Weight of this unit in the output sum.
    pub output: W,
}

/// The range in which product units take their inputs. Files name it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ProductForm {
    /// [1, 2]: every logarithm is finite and no power needs a sign.
    Positive,
}

/// What the output unit does with its sum.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Activation {
    /// The identity.
    Linear,
    /// Clamped to [0, 1], for a probability.
    Ramp,
}

/// Why a network cannot be evaluated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum InvalidNetwork {
    /// A weight, exponent, bias or scaling is NaN or infinite.
    NotFinite,
    /// An input's scaled range is empty, or not above zero.
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
    /// A network without hidden units, whose output is `bias` everywhere.
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

    /// The number of trained parameters: 422 over the five networks of Table I.
    pub fn parameters(&self) -> usize {
        self.summation.len() * (N + 2) + self.product.len() * (N + 1) + 1
    }
}

impl<const N: usize> Network<f32, N> {
    /// The output for one sample, in the unit that the network was trained in. NaN in, NaN out; an input outside
    /// the trained range counts as the range's end.
    ///
    /// Summation units are evaluated one by one, as the paper defines them, and so round otherwise than folded ones: the
    /// residuals and the accuracy in files are those of this form.
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

    /// Checks what a file could have broken, so that a network that passes never yields NaN for finite inputs.
    ///
    /// # Errors
    /// [`InvalidNetwork`] names the first thing found.
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

impl Scaling<f32> {
    /// Brings `from..=to` onto [1, 2], for [`ProductForm::Positive`].
    pub fn onto_one_to_two(from: f32, to: f32) -> Self {
        let gain = 1.0 / (to - from);
        Scaling { gain, offset: 1.0 - from * gain, low: 1.0, high: 2.0 }
    }

    /// The scaled and clamped input.
    #[inline(always)]
    pub fn apply<S: Scalar<Weight = f32>>(&self, x: S) -> S {
        (x * x.constant(self.gain) + x.constant(self.offset)).clamp(x.constant(self.low), x.constant(self.high))
    }
}

impl Activation {
    /// The output for the sum that reaches the output unit.
    #[inline(always)]
    pub fn apply<S: Scalar>(self, sum: S) -> S {
        match self {
            Activation::Linear => sum,
            Activation::Ramp => sum.clamp(sum.zero(), sum.one()),
        }
    }
}

/// Arrays of any length in serde, as sequences of exactly that length.
mod array_as_sequence {
    use serde::de::{Deserialize, Deserializer, Error};
    use serde::ser::{Serialize, Serializer};

    pub fn serialize<T: Serialize, S: Serializer, const N: usize>(array: &[T; N], out: S) -> Result<S::Ok, S::Error> {
        out.collect_seq(array)
    }

    pub fn deserialize<'de, T: Deserialize<'de>, D: Deserializer<'de>, const N: usize>(
        input: D,
    ) -> Result<[T; N], D::Error> {
        heapless::Vec::<T, N>::deserialize(input)?
            .into_array()
            .map_err(|v| D::Error::invalid_length(v.len(), &"one entry an input"))
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

    /// The same network by the formulas of the paper and of Durbin and Rumelhart, in f64.
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
        fn both_forms_follow_the_formula(a in -10f32..110.0, b in -10f32..110.0) {
            let expected = by_formula(&network(), [a, b]);
            let folded = FoldedNetwork::fold(&network());
            for y in [network().evaluate([a, b]), folded.evaluate([a, b])] {
                prop_assert!((f64::from(y) - expected).abs() < 1e-5, "{y} {expected}");
            }
        }

        #[test]
        fn checked_networks_stay_finite(
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
    fn text_gives_back_the_same() {
        let text = serde_json::to_string(&network()).unwrap();
        assert!(text.contains(r#""product_form":"positive""#), "{text}");
        assert_eq!(serde_json::from_str::<Network<f32, 2>>(&text).unwrap(), network());
    }

    #[test]
    fn ramp_clamps_to_a_probability() {
        let mut n = Network::constant([Scaling::onto_one_to_two(0.0, 1.0)], 1.5f32);
        n.activation = Activation::Ramp;
        assert_eq!(n.evaluate([0.3f32]), 1.0);
        n.bias = -0.5;
        assert_eq!(n.evaluate([0.3f32]), 0.0);
    }

    #[test]
    fn nan_is_passed_on_and_refused_as_a_weight() {
        let mut n = network();
        assert!(n.evaluate([f32::NAN, 1.0]).is_nan() && FoldedNetwork::fold(&n).evaluate([f32::NAN, 1.0]).is_nan());
        n.product[1].exponents[0] = f32::INFINITY;
        assert_eq!(n.check(), Err(InvalidNetwork::NotFinite));
    }

    #[test]
    fn a_scaled_range_that_meets_zero_is_refused() {
        let mut n = network();
        n.inputs[1].low = 0.0;
        assert_eq!(n.check(), Err(InvalidNetwork::BadScaling));
    }

    #[test]
    fn table_one_has_422_parameters() {
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
