//! Folded networks and their evaluator, which works on floats, pairs and vectors alike.
//!
//! Summation units are linear and so is the output unit, so together they fold into one affine map: a network is exactly
//! `bias + Σ slopes·x + Σ output·2^(Σ exponents·log2 x)`. Over the five networks of Table I in the paper this leaves 206 of
//! 422 parameters, with one logarithm per input and one power of two per product unit.

use crate::maths::{self, Binary32};
use crate::network::{Activation, MAX_HALF, Network, ProductUnit, Scaling, Term, add_terms, scale};
use crate::pair::Pair;
use crate::scalar::Scalar;

/// A [`Network`] with `N` inputs whose summation units are folded together.
///
/// ```
/// use mindgap_core::folded::FoldedNetwork;
/// use mindgap_core::network::{Network, ProductUnit, Scaling, SummationUnit};
///
/// let mut network = Network::constant([Scaling::onto_one_to_two(0.0, 10.0)], 0.5);
/// network.summation.push(SummationUnit { weights: [3.0], bias: 1.0, output: 2.0 }).unwrap();
/// network.product.push(ProductUnit { exponents: [2.0], output: -4.0 }).unwrap();
/// let folded = FoldedNetwork::fold(&network);
/// assert_eq!((folded.sum.bias, folded.sum.slopes), (2.5, [6.0]));
/// // 2.5 + 6 x - 4 x² at x = 1.5.
/// assert!((folded.evaluate([5.0f32]) - 2.5).abs() < 1e-5);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct FoldedNetwork<W, const N: usize> {
    /// Scaling of each input to the trained range.
    pub inputs: [Scaling<W>; N],
    /// Sum that reaches the output unit.
    pub sum: PowerSum<W, N, MAX_HALF, ProductUnit<W, N>>,
    /// Activation function of the output unit.
    pub activation: Activation,
    /// Whether no power of any input can overflow, and every scaled input is a normal positive number.
    overflow_safe: bool,
}

/// An affine map of `N` scaled inputs plus up to `POWERS` product units of type `U`.
///
/// ```
/// use mindgap_core::folded::PowerSum;
/// use mindgap_core::heapless::Vec;
/// use mindgap_core::network::ProductUnit;
///
/// let powers = Vec::<_, 1>::from_array([ProductUnit { exponents: [2.0], output: -4.0 }]);
/// let sum = PowerSum { bias: 2.5, slopes: [6.0], powers };
/// // 2.5 + 6 x - 4 x² at x = 2, whose logarithm to base two is 1.
/// assert_eq!(sum.evaluate(&[2.0f32], &[1.0]), -1.5);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct PowerSum<W, const N: usize, const POWERS: usize = MAX_HALF, U = Power<W, N>> {
    /// Constant term.
    pub bias: W,
    /// One slope per input.
    pub slopes: [W; N],
    /// Product units.
    pub powers: heapless::Vec<U, POWERS>,
}

/// A product unit with its output weight as a power of two, as fixed point needs it.
///
/// It stands for `± 2^(log2_weight + Σ exponents·log2 x)`.
///
/// ```
/// use mindgap_core::fixed::types::I6F26;
/// use mindgap_core::folded::{Power, Sign};
///
/// // -4 x²
/// let number = |x: i32| I6F26::from_num(x);
/// let power = Power { exponents: [number(2)], log2_weight: number(2), sign: Sign::Minus };
/// assert_eq!(power.log2_weight, 2);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Power<W, const N: usize> {
    /// One exponent per input.
    pub exponents: [W; N],
    /// Logarithm to base two of the output weight's absolute value.
    pub log2_weight: W,
    /// Sign of the output weight.
    pub sign: Sign,
}

/// The sign of a [`Power`].
///
/// ```
/// use mindgap_core::folded::Sign;
///
/// let sign_of = |weight: f32| if weight < 0.0 { Sign::Minus } else { Sign::Plus };
/// assert_eq!(sign_of(-0.5), Sign::Minus);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sign {
    /// The power is added.
    Plus,
    /// The power is subtracted.
    Minus,
}

/// Returns the outputs of `K` networks for the same `N` inputs. Consecutive networks with the same scaling share the
/// logarithms.
#[inline(always)]
pub fn evaluate_all<S: Binary32, const N: usize, const K: usize>(
    networks: &[FoldedNetwork<f32, N>; K],
    inputs: [S; N],
) -> [S; K] {
    const { assert!(N > 0 && K > 0, "there is a network, and it has an input") };
    let mut outputs = [inputs[0]; K];
    let mut scaled_by = &networks[0];
    let (mut x, mut log2_x) = scaled_by.scale(inputs);
    for (output, network) in outputs.iter_mut().zip(networks) {
        if network.inputs != scaled_by.inputs {
            (x, log2_x) = network.scale(inputs);
            scaled_by = network;
        }
        *output = network.evaluate_scaled(&x, &log2_x);
    }
    outputs
}

impl<W: Scalar<Weight = W> + From<f32>, const N: usize> FoldedNetwork<W, N> {
    /// Folds a network with the precision of `W`. Units keep their order.
    pub fn fold(network: &Network<f32, N>) -> Self {
        let mut bias = W::from(network.bias);
        let mut slopes = [W::ZERO; N];
        for unit in &network.summation {
            let output = W::from(unit.output);
            bias = bias + W::from(unit.bias) * output;
            for (slope, weight) in slopes.iter_mut().zip(unit.weights) {
                *slope = *slope + W::from(weight) * output;
            }
        }
        let mut powers = heapless::Vec::new();
        for unit in &network.product {
            // The capacity is that of the network's own vector.
            let _ = powers.push(ProductUnit { exponents: unit.exponents.map(W::from), output: unit.output.into() });
        }
        FoldedNetwork {
            inputs: network.inputs.map(|s| Scaling {
                gain: s.gain.into(),
                offset: s.offset.into(),
                low: s.low.into(),
                high: s.high.into(),
            }),
            sum: PowerSum { bias, slopes, powers },
            activation: network.activation,
            overflow_safe: is_overflow_safe(network),
        }
    }
}

impl<const N: usize> FoldedNetwork<f32, N> {
    /// Returns the output for one sample, in the unit that the network was trained in.
    ///
    /// An input outside the trained range counts as the end of the range. A NaN input gives NaN.
    #[inline(always)]
    pub fn evaluate<S: Binary32>(&self, inputs: [S; N]) -> S {
        let (x, log2_x) = self.scale(inputs);
        self.evaluate_scaled(&x, &log2_x)
    }

    /// Returns the scaled inputs and their logarithms to base two. Networks with equal `inputs` can share them.
    #[inline(always)]
    pub fn scale<S: Binary32>(&self, inputs: [S; N]) -> ([S; N], [S; N]) {
        scale(&self.inputs, inputs, self.overflow_safe)
    }

    /// Returns the output for a scaled sample. Evaluates two product units at a time, which keeps a processor busy.
    #[inline(always)]
    pub fn evaluate_scaled<S: Binary32>(&self, x: &[S; N], log2_x: &[S; N]) -> S {
        let sum = if self.overflow_safe {
            let mut sum = self.sum.affine(x);
            let (pairs, last) = self.sum.powers.as_chunks::<2>();
            for [one, other] in pairs {
                let powers = maths::exp2_within(Pair(one.log2_power(log2_x), other.log2_power(log2_x)));
                sum = sum + powers.0 * sum.constant(one.output);
                sum = sum + powers.1 * sum.constant(other.output);
            }
            add_safe_units(last, sum, log2_x)
        } else {
            self.sum.evaluate(x, log2_x)
        };
        self.activation.apply(sum)
    }

    /// Returns the outputs for two scaled samples. Two samples keep a processor busy with one product unit at a time.
    #[inline(always)]
    pub fn evaluate_scaled_pair<S: Binary32>(&self, x: &[Pair<S>; N], log2_x: &[Pair<S>; N]) -> Pair<S> {
        let sum = match self.overflow_safe {
            true => add_safe_units(&self.sum.powers, self.sum.affine(x), log2_x),
            false => self.sum.evaluate(x, log2_x),
        };
        self.activation.apply(sum)
    }
}

impl<W: Copy, const N: usize, const POWERS: usize, U> PowerSum<W, N, POWERS, U> {
    /// Returns the sum for `N` scaled inputs, all above zero, and their logarithms to base two.
    #[inline(always)]
    pub fn evaluate<S: Scalar<Weight = W>>(&self, x: &[S; N], log2_x: &[S; N]) -> S
    where
        U: Term<S, N>,
    {
        add_terms(&self.powers, self.affine(x), log2_x)
    }

    #[inline(always)]
    pub(crate) fn affine<S: Scalar<Weight = W>>(&self, x: &[S; N]) -> S {
        const { assert!(N > 0, "a network has at least one input") };
        S::weighted_sum(x[0].constant(self.bias), x, &self.slopes)
    }
}

/// Equals [`add_terms`] to the bit where no power overflows.
#[inline(always)]
fn add_safe_units<S: Binary32, const N: usize>(units: &[ProductUnit<f32, N>], start: S, log2_x: &[S; N]) -> S {
    let mut sum = start;
    for unit in units {
        sum = sum + maths::exp2_within(unit.log2_power(log2_x)) * sum.constant(unit.output);
    }
    sum
}

/// Logarithms of powers within this bound are safe: it is well inside the domain of [`maths::exp2_within`].
const SAFE_LOG2: f32 = 100.0;

fn is_overflow_safe<const N: usize>(network: &Network<f32, N>) -> bool {
    let largest_log2 = network.inputs.map(|s| maths::log2(s.low).abs().max(maths::log2(s.high).abs()));
    let log2_of = |unit: &ProductUnit<f32, N>| {
        unit.exponents.iter().zip(&largest_log2).map(|(exponent, log2)| exponent.abs() * log2).sum::<f32>()
    };
    network.inputs.iter().all(|s| s.low >= f32::MIN_POSITIVE)
        && network.product.iter().all(|unit| log2_of(unit) <= SAFE_LOG2)
}
