//! The parts of a network: how inputs are scaled, the units of the hidden layer, and what the output unit does.

#[cfg(feature = "schemars")]
use schemars::JsonSchema;
#[cfg(feature = "serde")]
use serde::{Deserialize, Serialize};

use crate::maths::{self, Binary32};
use crate::scalar::Scalar;

/// An affine map of one input, clamped to the trained range: `clamp(x · gain + offset, low, high)`.
///
/// ```
/// use mindgap_core::network::Scaling;
///
/// let scaling = Scaling::onto_one_to_two(-100.0, 100.0);
/// assert_eq!(scaling.apply(0.0f32), 1.5);
/// assert_eq!(scaling.apply(1000.0f32), 2.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "schemars", derive(JsonSchema))]
pub struct Scaling<W> {
    /// Factor.
    pub gain: W,
    /// Summand.
    pub offset: W,
    /// Smallest scaled value; an input further out counts as this one.
    pub low: W,
    /// Largest scaled value; an input further out counts as this one.
    pub high: W,
}

/// A linear summation unit of the hidden layer, with its weight in the output sum.
///
/// It adds `output · (bias + Σ weights · x)` to the sum that reaches the output unit.
///
/// ```
/// use mindgap_core::network::{Network, Scaling, SummationUnit};
///
/// let mut network = Network::constant([Scaling::onto_one_to_two(0.0, 10.0)], 0.0);
/// network.summation.push(SummationUnit { weights: [3.0], bias: 1.0, output: 2.0 }).unwrap();
/// assert_eq!(network.evaluate([5.0f32]), 2.0 * (1.0 + 3.0 * 1.5));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "serde", serde(bound(serialize = "W: Serialize", deserialize = "W: Deserialize<'de>")))]
#[cfg_attr(feature = "schemars", derive(JsonSchema))]
pub struct SummationUnit<W, const N: usize> {
    /// One weight per input.
    #[cfg_attr(feature = "serde", serde(with = "array_as_sequence"))]
    #[cfg_attr(feature = "schemars", schemars(with = "[W]"))]
    pub weights: [W; N],
    /// Bias, added to the weighted sum.
    pub bias: W,
    /// Weight of this unit in the output sum.
    pub output: W,
}

/// A product unit of the hidden layer, with its weight in the output sum.
///
/// It raises its inputs to trained powers and multiplies them (Durbin and Rumelhart, 1989), without a bias: it adds
/// `output · Π x^exponents` to the sum that reaches the output unit.
///
/// ```
/// use mindgap_core::network::{Network, ProductUnit, Scaling};
///
/// let mut network = Network::constant([Scaling::onto_one_to_two(0.0, 10.0)], 0.0);
/// network.product.push(ProductUnit { exponents: [2.0], output: 4.0 }).unwrap();
/// let y: f32 = network.evaluate([5.0]);
/// assert!((y - 4.0 * 1.5 * 1.5).abs() < 1e-5);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "serde", serde(bound(serialize = "W: Serialize", deserialize = "W: Deserialize<'de>")))]
#[cfg_attr(feature = "schemars", derive(JsonSchema))]
pub struct ProductUnit<W, const N: usize> {
    /// One exponent per input.
    #[cfg_attr(feature = "serde", serde(with = "array_as_sequence"))]
    #[cfg_attr(feature = "schemars", schemars(with = "[W]"))]
    pub exponents: [W; N],
    /// Weight of this unit in the output sum.
    pub output: W,
}

/// The range to which inputs of product units are scaled. Simulator files name it.
///
/// ```
/// use mindgap_core::network::{Network, ProductForm, Scaling};
///
/// let network = Network::constant([Scaling::onto_one_to_two(0.0, 10.0)], 0.0f32);
/// assert_eq!(network.product_form, ProductForm::Positive);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize), serde(rename_all = "snake_case"))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "schemars", derive(JsonSchema))]
pub enum ProductForm {
    /// The range [1, 2], in which every logarithm is finite and no power needs a sign.
    Positive,
}

/// The activation function of the output unit.
///
/// ```
/// use mindgap_core::network::Activation;
///
/// assert_eq!(Activation::Linear.apply(1.5f32), 1.5);
/// assert_eq!(Activation::Ramp.apply(1.5f32), 1.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(Serialize, Deserialize), serde(rename_all = "snake_case"))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "schemars", derive(JsonSchema))]
pub enum Activation {
    /// The identity.
    Linear,
    /// Clamped to [0, 1], for a probability.
    Ramp,
}

/// A weighted product of powers that can be evaluated on numbers of type `S`.
///
/// [`ProductUnit`] implements it for floats.
///
/// ```
/// use mindgap_core::network::{ProductUnit, Term};
///
/// let unit = ProductUnit { exponents: [2.0], output: 3.0 };
/// // 1 + 3 x² at x = 4, whose logarithm to base two is 2.
/// assert_eq!(unit.add_to(1.0f32, &[2.0]), 49.0);
/// ```
pub trait Term<S, const N: usize> {
    /// Returns `sum` plus this term, given the logarithms to base two of its `N` inputs.
    fn add_to(&self, sum: S, log2_x: &[S; N]) -> S;
}

impl Scaling<f32> {
    /// Returns the scaling that maps `from..=to` onto [1, 2], for [`ProductForm::Positive`].
    pub fn onto_one_to_two(from: f32, to: f32) -> Self {
        let gain = 1.0 / (to - from);
        Scaling { gain, offset: 1.0 - from * gain, low: 1.0, high: 2.0 }
    }

    /// Returns the scaled and clamped input.
    #[inline(always)]
    pub fn apply<S: Scalar<Weight = f32>>(&self, x: S) -> S {
        (x * x.constant(self.gain) + x.constant(self.offset)).clamp(x.constant(self.low), x.constant(self.high))
    }
}

impl Activation {
    /// Returns the output for the sum that reaches the output unit.
    #[inline(always)]
    pub fn apply<S: Scalar>(self, sum: S) -> S {
        match self {
            Activation::Linear => sum,
            Activation::Ramp => sum.clamp(sum.zero(), sum.one()),
        }
    }
}

impl<const N: usize> ProductUnit<f32, N> {
    /// Returns the logarithm to base two of the product of powers, without the output weight.
    #[inline(always)]
    pub(crate) fn log2_power<S: Binary32>(&self, log2_x: &[S; N]) -> S {
        let mut terms = log2_x.iter().zip(&self.exponents);
        let Some((x, exponent)) = terms.next() else { return log2_x[0].zero() };
        let mut log2 = *x * x.constant(*exponent);
        for (x, exponent) in terms {
            log2 = log2 + *x * x.constant(*exponent);
        }
        log2
    }
}

impl<S: Binary32, const N: usize> Term<S, N> for ProductUnit<f32, N> {
    #[inline(always)]
    fn add_to(&self, sum: S, log2_x: &[S; N]) -> S {
        sum + maths::exp2(self.log2_power(log2_x)) * sum.constant(self.output)
    }
}

/// Returns `start` plus all terms, added from the first to the last.
#[inline(always)]
pub(crate) fn add_terms<S: Copy, T: Term<S, N>, const N: usize>(terms: &[T], start: S, log2_x: &[S; N]) -> S {
    let mut sum = start;
    for term in terms {
        sum = term.add_to(sum, log2_x);
    }
    sum
}

/// Returns the scaled inputs and their logarithms to base two. `is_normal` promises that every scaled input is a normal
/// positive number, which makes the logarithm cheaper.
#[inline(always)]
pub(crate) fn scale<S: Binary32, const N: usize>(
    scalings: &[Scaling<f32>; N],
    inputs: [S; N],
    is_normal: bool,
) -> ([S; N], [S; N]) {
    // Loops and not closures: a closure would not be compiled for the vectors of a lane.
    let mut x = inputs;
    for (x, scaling) in x.iter_mut().zip(scalings) {
        *x = scaling.apply(*x);
    }
    let mut log2_x = x;
    for value in &mut log2_x {
        *value = if is_normal { maths::log2_normal(*value) } else { maths::log2(*value) };
    }
    (x, log2_x)
}

/// Serialises an array of any length as a sequence of exactly that length.
#[cfg(feature = "serde")]
pub(super) mod array_as_sequence {
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
            .map_err(|v| D::Error::invalid_length(v.len(), &"one entry per input"))
    }
}
