//! A simulator neural network (SNN): one hidden layer, half summation and half product units (paper, section VII).

use core::fmt;

use serde::{Deserialize, Serialize};

use crate::scalar::Scalar;

/// The most units of one kind in a hidden layer; Table I needs 20.
pub const MAX_HALF: usize = 32;

/// A trained network with `N` inputs and one output, its weights stored as `W`.
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
    /// What the product units do with their inputs' signs.
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

/// What product units do with their inputs' signs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ProductForm {
    /// Inputs are scaled to [1, 2]: every logarithm is finite and no sign is needed.
    Positive,
    /// Inputs are scaled to [-1, 1]; the real part of the complex power, exp(Σ w ln|x|) · cos(π Σ w over negative x).
    /// A magnitude under 2^-10 counts as 2^-10.
    Signed,
}

/// What the output unit does with its sum.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Activation {
    /// Nothing.
    Linear,
    /// Clamp to [0, 1], for a probability.
    Ramp,
}

/// Why a network cannot be evaluated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum InvalidNetwork {
    /// A weight, exponent, bias or scaling is NaN or infinite.
    NotFinite,
    /// An input's range is empty, or holds a value that product units of this form cannot take.
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
    /// The output for one sample, in the unit that the network was trained in. NaN in, NaN out; an input outside
    /// the trained range counts as the range's end.
    #[inline(always)]
    pub fn evaluate<S: Scalar<Weight = W>>(&self, inputs: [S; N]) -> S {
        const { assert!(N > 0, "a network has at least one input") };
        // Loops and not closures: a closure would not be compiled for the vectors of a lane.
        let mut x = inputs;
        for (x, scaling) in x.iter_mut().zip(&self.inputs) {
            *x = scaling.apply(*x);
        }
        let mut log2_x = x;
        for value in &mut log2_x {
            *value = value.log2_magnitude();
        }
        let mut sum = x[0].weight(self.bias);
        for unit in &self.summation {
            let inner = S::weighted_sum(sum.weight(unit.bias), &x, &unit.weights);
            sum = sum + inner * inner.weight(unit.output);
        }
        for unit in &self.product {
            let mut power = unit.magnitude(&log2_x);
            if self.product_form == ProductForm::Signed {
                power = power * unit.sign(&x);
            }
            sum = sum + power * power.weight(unit.output);
        }
        self.activation.apply(sum)
    }

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

    /// The number of trained numbers: 422 over the five networks of Table I.
    pub fn parameters(&self) -> usize {
        self.summation.len() * (N + 2) + self.product.len() * (N + 1) + 1
    }
}

impl<const N: usize> Network<f32, N> {
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
        let positive = self.product_form == ProductForm::Positive;
        if self.inputs.iter().any(|s| s.low > s.high || (positive && s.low <= 0.0)) {
            return Err(InvalidNetwork::BadScaling);
        }
        Ok(())
    }
}

impl<W: Copy> Scaling<W> {
    /// The scaled and clamped input.
    #[inline(always)]
    pub fn apply<S: Scalar<Weight = W>>(&self, x: S) -> S {
        (x * x.weight(self.gain) + x.weight(self.offset)).clamp(x.weight(self.low), x.weight(self.high))
    }
}

impl Scaling<f32> {
    /// Brings `from..=to` onto [1, 2], for [`ProductForm::Positive`].
    pub fn onto_one_to_two(from: f32, to: f32) -> Self {
        let gain = 1.0 / (to - from);
        Scaling { gain, offset: 1.0 - from * gain, low: 1.0, high: 2.0 }
    }

    /// Brings `from..=to` onto [-1, 1], for [`ProductForm::Signed`].
    pub fn onto_minus_one_to_one(from: f32, to: f32) -> Self {
        let gain = 2.0 / (to - from);
        Scaling { gain, offset: -1.0 - from * gain, low: -1.0, high: 1.0 }
    }
}

impl<W: Copy, const N: usize> ProductUnit<W, N> {
    /// Magnitude of the product, from the logarithms of the inputs.
    #[inline(always)]
    pub fn magnitude<S: Scalar<Weight = W>>(&self, log2_x: &[S; N]) -> S {
        S::product_of_powers(log2_x[0].zero(), log2_x, &self.exponents)
    }

    /// Real part of the complex sign of the product.
    #[inline(always)]
    pub fn sign<S: Scalar<Weight = W>>(&self, x: &[S; N]) -> S {
        let mut negative = *x;
        for value in &mut negative {
            *value = value.negative();
        }
        S::weighted_sum(x[0].zero(), &negative, &self.exponents).cos_pi()
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
    use proptest::prelude::*;

    fn network(form: ProductForm, scaling: Scaling<f32>) -> Network<f32, 2> {
        let mut n = Network::constant([scaling; 2], 0.5);
        n.product_form = form;
        n.summation.push(SummationUnit { weights: [0.25, -1.0], bias: 0.125, output: 2.0 }).unwrap();
        n.product.push(ProductUnit { exponents: [1.5, -0.75], output: -0.5 }).unwrap();
        n.product.push(ProductUnit { exponents: [3.0, 2.0], output: 0.1 }).unwrap();
        n
    }

    /// The same network by the formulas of the paper and of Durbin and Rumelhart, in f64.
    fn by_formula(n: &Network<f32, 2>, inputs: [f32; 2]) -> f64 {
        let x: [f64; 2] = core::array::from_fn(|i| {
            let s = n.inputs[i];
            f64::from((inputs[i] * s.gain + s.offset).clamp(s.low, s.high))
        });
        let mut sum = f64::from(n.bias);
        for u in &n.summation {
            let inner = f64::from(u.bias) + x[0] * f64::from(u.weights[0]) + x[1] * f64::from(u.weights[1]);
            sum += inner * f64::from(u.output);
        }
        for u in &n.product {
            let mut magnitude = 1.0;
            let mut half_turns = 0.0;
            for (x, e) in x.iter().zip(u.exponents) {
                magnitude *= libm::pow(x.abs().max(1.0 / 1024.0), f64::from(e));
                half_turns += if *x < 0.0 { f64::from(e) } else { 0.0 };
            }
            sum += magnitude * libm::cos(core::f64::consts::PI * half_turns) * f64::from(u.output);
        }
        sum
    }

    proptest! {
        #[test]
        fn positive_form_follows_the_formula(a in -10f32..110.0, b in -10f32..110.0) {
            let n = network(ProductForm::Positive, Scaling::onto_one_to_two(0.0, 100.0));
            let y: f32 = n.evaluate([a, b]);
            prop_assert!((f64::from(y) - by_formula(&n, [a, b])).abs() < 1e-5);
        }

        #[test]
        fn signed_form_follows_the_formula(a in -100f32..100.0, b in -100f32..100.0) {
            let n = network(ProductForm::Signed, Scaling::onto_minus_one_to_one(-100.0, 100.0));
            let y: f32 = n.evaluate([a, b]);
            let expected = by_formula(&n, [a, b]);
            // A negative exponent on an input near zero makes the output large: the tolerance is relative.
            prop_assert!((f64::from(y) - expected).abs() < 1e-4 * (1.0 + expected.abs()));
        }

        #[test]
        fn checked_networks_stay_finite(
            exponents in prop::array::uniform2(-5f32..5.0), a in any::<f32>(), b in any::<f32>(),
        ) {
            prop_assume!(a.is_finite() && b.is_finite());
            let mut n = network(ProductForm::Positive, Scaling::onto_one_to_two(0.0, 100.0));
            n.product[0].exponents = exponents;
            prop_assert_eq!(n.check(), Ok(()));
            let y: f32 = n.evaluate([a, b]);
            prop_assert!(y.is_finite());
        }
    }

    #[test]
    fn one_definition_serves_both_floats() {
        let n = network(ProductForm::Positive, Scaling::onto_one_to_two(0.0, 100.0));
        let text = serde_json::to_string(&n).unwrap();
        let wide: Network<f64, 2> = serde_json::from_str(&text).unwrap();
        let (narrow, wide): (f32, f64) = (n.evaluate([20.0, 70.0]), wide.evaluate([20.0, 70.0]));
        assert!((f64::from(narrow) - wide).abs() < 1e-5);
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
        let mut n = network(ProductForm::Positive, Scaling::onto_one_to_two(0.0, 100.0));
        let y: f32 = n.evaluate([f32::NAN, 1.0]);
        assert!(y.is_nan());
        n.product[1].exponents[0] = f32::INFINITY;
        assert_eq!(n.check(), Err(InvalidNetwork::NotFinite));
    }

    #[test]
    fn scaling_that_meets_zero_is_refused_for_the_positive_form() {
        let n = network(ProductForm::Positive, Scaling::onto_minus_one_to_one(0.0, 100.0));
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
