//! The one evaluator of networks, for floats, pairs, vectors and fixed point.
//!
//! Summation units are linear and so is the output, so they fold into one affine map: a network is exactly
//! `bias + Σ slopes·x + Σ output·2^(Σ exponents·log2 x)`. Over the five networks of Table I that leaves 206 of
//! 422 parameters, one logarithm an input and one power of two a product unit.

use crate::maths::{self, Binary32};
use crate::network::{Activation, MAX_HALF, Network, ProductUnit, Scaling};
use crate::pair::Pair;
use crate::scalar::Scalar;

/// A [`Network`] with its summation units folded together.
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
/// // 2.5 + 6 x - 4 x^2 at x = 1.5.
/// assert!((folded.evaluate([5.0f32]) - 2.5).abs() < 1e-5);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct FoldedNetwork<W, const N: usize> {
    /// How each input is brought to the range that was trained.
    pub inputs: [Scaling<W>; N],
    /// What reaches the output unit.
    pub sum: PowerSum<W, N, MAX_HALF, ProductUnit<W, N>>,
    /// What the output unit does with it.
    pub activation: Activation,
    /// Whether no power of any input can overflow, and no scaled input lacks a logarithm.
    overflow_safe: bool,
}

/// An affine map of `N` scaled inputs and up to `POWERS` product units of the form `U`.
#[derive(Clone, Debug, PartialEq)]
pub struct PowerSum<W, const N: usize, const POWERS: usize = MAX_HALF, U = Power<W, N>> {
    /// The constant.
    pub bias: W,
    /// One factor an input.
    pub slopes: [W; N],
    /// The product units.
    pub powers: heapless::Vec<U, POWERS>,
}

/// A product unit with its weight in the output sum as one power of two, as fixed point takes it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Power<W, const N: usize> {
    /// One exponent an input.
    pub exponents: [W; N],
    /// The logarithm to base two of the output weight's absolute value.
    pub log2_weight: W,
    /// The output weight's sign.
    pub sign: Sign,
}

/// Whether a power is added or subtracted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sign {
    /// Added.
    Plus,
    /// Subtracted.
    Minus,
}

/// A product unit in a form that numbers of the kind `S` can evaluate.
pub trait Term<S, const N: usize> {
    /// `sum` and the weighted power of the inputs, given by their logarithms to base two.
    fn add_to(&self, sum: S, log2_x: &[S; N]) -> S;
}

/// The outputs of several networks for the same inputs. Those that scale them alike share the logarithms.
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
            // There is room for as many as there were.
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
    /// The output for one sample, in the unit that the network was trained in; an input outside the trained range
    /// counts as the range's end.
    #[inline(always)]
    pub fn evaluate<S: Binary32>(&self, inputs: [S; N]) -> S {
        let (x, log2_x) = self.scale(inputs);
        self.evaluate_scaled(&x, &log2_x)
    }

    /// The inputs scaled, and their logarithms to base two, which networks of equal `inputs` can share.
    #[inline(always)]
    pub fn scale<S: Binary32>(&self, inputs: [S; N]) -> ([S; N], [S; N]) {
        scale(&self.inputs, inputs, self.overflow_safe)
    }

    /// The output for a scaled sample. Two product units at a time keep a processor busy.
    #[inline(always)]
    pub fn evaluate_scaled<S: Binary32>(&self, x: &[S; N], log2_x: &[S; N]) -> S {
        let sum = if self.overflow_safe {
            let mut sum = self.sum.affine(x);
            let (pairs, last) = self.sum.powers.as_chunks::<2>();
            for [one, other] in pairs {
                let powers = maths::exp2_within(Pair(log2_power(one, log2_x), log2_power(other, log2_x)));
                sum = sum + powers.0 * sum.constant(one.output);
                sum = sum + powers.1 * sum.constant(other.output);
            }
            add_safe_units(last, sum, log2_x)
        } else {
            self.sum.evaluate(x, log2_x)
        };
        self.activation.apply(sum)
    }

    /// The same for two scaled samples, which keep a processor busy with one product unit at a time.
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
    /// The sum at a scaled sample, every member of which is above zero, given with its logarithms to base two.
    #[inline(always)]
    pub fn evaluate<S: Scalar<Weight = W>>(&self, x: &[S; N], log2_x: &[S; N]) -> S
    where
        U: Term<S, N>,
    {
        add_terms(&self.powers, self.affine(x), log2_x)
    }

    #[inline(always)]
    fn affine<S: Scalar<Weight = W>>(&self, x: &[S; N]) -> S {
        const { assert!(N > 0, "a network has at least one input") };
        S::weighted_sum(x[0].constant(self.bias), x, &self.slopes)
    }
}

impl<S: Binary32, const N: usize> Term<S, N> for ProductUnit<f32, N> {
    #[inline(always)]
    fn add_to(&self, sum: S, log2_x: &[S; N]) -> S {
        sum + maths::exp2(log2_power(self, log2_x)) * sum.constant(self.output)
    }
}

/// `start` and all terms, from the first to the last.
#[inline(always)]
pub(crate) fn add_terms<S: Copy, T: Term<S, N>, const N: usize>(terms: &[T], start: S, log2_x: &[S; N]) -> S {
    let mut sum = start;
    for term in terms {
        sum = term.add_to(sum, log2_x);
    }
    sum
}

/// [`add_terms`] to the bit, where no power overflows.
#[inline(always)]
fn add_safe_units<S: Binary32, const N: usize>(units: &[ProductUnit<f32, N>], start: S, log2_x: &[S; N]) -> S {
    let mut sum = start;
    for unit in units {
        sum = sum + maths::exp2_within(log2_power(unit, log2_x)) * sum.constant(unit.output);
    }
    sum
}

#[inline(always)]
fn log2_power<S: Binary32, const N: usize>(unit: &ProductUnit<f32, N>, log2_x: &[S; N]) -> S {
    let mut terms = log2_x.iter().zip(&unit.exponents);
    let Some((x, exponent)) = terms.next() else { return log2_x[0].zero() };
    let mut log2 = *x * x.constant(*exponent);
    for (x, exponent) in terms {
        log2 = log2 + *x * x.constant(*exponent);
    }
    log2
}

/// Scaled inputs and their logarithms to base two; `normal` says that the former are normal positive numbers.
#[inline(always)]
pub(crate) fn scale<S: Binary32, const N: usize>(
    scalings: &[Scaling<f32>; N],
    inputs: [S; N],
    normal: bool,
) -> ([S; N], [S; N]) {
    // Loops and not closures: a closure would not be compiled for the vectors of a lane.
    let mut x = inputs;
    for (x, scaling) in x.iter_mut().zip(scalings) {
        *x = scaling.apply(*x);
    }
    let mut log2_x = x;
    for value in &mut log2_x {
        *value = if normal { maths::log2_normal(*value) } else { maths::log2(*value) };
    }
    (x, log2_x)
}

/// Logarithms of powers that are safe stay within this, far from what [`maths::exp2_within`] needs.
const SAFE_LOG2: f32 = 100.0;

fn is_overflow_safe<const N: usize>(network: &Network<f32, N>) -> bool {
    let largest_log2 = network.inputs.map(|s| maths::log2(s.low).abs().max(maths::log2(s.high).abs()));
    let log2_of = |unit: &ProductUnit<f32, N>| {
        unit.exponents.iter().zip(&largest_log2).map(|(exponent, log2)| exponent.abs() * log2).sum::<f32>()
    };
    network.inputs.iter().all(|s| s.low >= f32::MIN_POSITIVE)
        && network.product.iter().all(|unit| log2_of(unit) <= SAFE_LOG2)
}
