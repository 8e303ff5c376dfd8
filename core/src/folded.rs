//! Networks with their linear part folded together.
//!
//! Summation units are linear and so is the output, so a network of the positive form is exactly
//! `bias + Σ slopes·x + Σ ±2^(log2 weight + Σ exponents·log2 x)`. Over the five networks of Table I that leaves 206 of
//! 422 parameters, one logarithm an input and one power of two a product unit.

use core::array;

use crate::network::{Activation, MAX_HALF, Network, ProductForm, ProductUnit, Scaling};
use crate::scalar::Scalar;

/// A [`Network`] of the positive form, folded: `N` inputs, room for `POWERS` product units.
///
/// ```
/// use mindgap_core::folded::FoldedNetwork;
/// use mindgap_core::network::{Network, ProductUnit, Scaling, SummationUnit};
///
/// let mut network = Network::constant([Scaling::onto_one_to_two(0.0, 10.0)], 0.5);
/// network.summation.push(SummationUnit { weights: [3.0], bias: 1.0, output: 2.0 }).unwrap();
/// network.product.push(ProductUnit { exponents: [2.0], output: -4.0 }).unwrap();
/// let folded = FoldedNetwork::fold(&network).unwrap();
/// assert_eq!((folded.sum.bias, folded.sum.slopes), (2.5, [6.0]));
/// // 2.5 + 6 x - 4 x^2 at x = 1.5.
/// assert!((folded.evaluate([5.0f64]) - 2.5).abs() < 1e-6);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct FoldedNetwork<W, const N: usize, const POWERS: usize = MAX_HALF> {
    /// How each input is brought to the range that was trained.
    pub inputs: [Scaling<W>; N],
    /// What reaches the output unit.
    pub sum: PowerSum<W, N, POWERS>,
    /// What the output unit does with it.
    pub activation: Activation,
}

/// An affine map and powers of positive numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct PowerSum<W, const N: usize, const POWERS: usize = MAX_HALF> {
    /// The constant.
    pub bias: W,
    /// One factor an input.
    pub slopes: [W; N],
    /// One a product unit.
    pub powers: heapless::Vec<Power<W, N>, POWERS>,
}

/// A product unit with its weight in the output sum, as one power of two.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Power<W, const N: usize> {
    /// One exponent an input.
    pub exponents: [W; N],
    /// The logarithm to base two of the output weight's magnitude.
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

impl<W: Copy, const N: usize, const POWERS: usize> FoldedNetwork<W, N, POWERS> {
    /// The output for one sample, in the unit that the network was trained in; an input outside the trained range
    /// counts as the range's end.
    pub fn evaluate<S: Scalar<Weight = W>>(&self, inputs: [S; N]) -> S {
        let x = array::from_fn(|i| self.inputs[i].apply(inputs[i]));
        self.activation.apply(self.sum.evaluate(&x, &x.map(S::log2_magnitude)))
    }
}

impl<W: Copy, const N: usize, const POWERS: usize> PowerSum<W, N, POWERS> {
    /// The sum at a scaled sample, every member of which is above zero, given with its logarithms to base two.
    #[inline(always)]
    pub fn evaluate<S: Scalar<Weight = W>>(&self, x: &[S; N], log2_x: &[S; N]) -> S {
        const { assert!(N > 0, "a network has at least one input") };
        let mut sum = S::weighted_sum(x[0].weight(self.bias), x, &self.slopes);
        for power in &self.powers {
            let term = S::product_of_powers(x[0].weight(power.log2_weight), log2_x, &power.exponents);
            sum = match power.sign {
                Sign::Plus => sum + term,
                Sign::Minus => sum - term,
            };
        }
        sum
    }
}

impl<const N: usize> FoldedNetwork<f64, N> {
    /// Folds a network; `None` for the signed form, whose product units change their sign.
    /// Units keep their order; one of weight zero becomes 2 to the power of minus infinity.
    pub fn fold(network: &Network<f32, N>) -> Option<Self> {
        if network.product_form == ProductForm::Signed {
            return None;
        }
        let mut bias = f64::from(network.bias);
        let mut slopes = [0.0; N];
        for unit in &network.summation {
            let output = f64::from(unit.output);
            bias += output * f64::from(unit.bias);
            for (slope, weight) in slopes.iter_mut().zip(unit.weights) {
                *slope += output * f64::from(weight);
            }
        }
        let mut powers = heapless::Vec::new();
        for unit in &network.product {
            // There is room for as many as there are product units.
            let _ = powers.push(Power::fold(unit));
        }
        let inputs = network.inputs.map(|s| Scaling {
            gain: f64::from(s.gain),
            offset: f64::from(s.offset),
            low: f64::from(s.low),
            high: f64::from(s.high),
        });
        Some(FoldedNetwork { inputs, sum: PowerSum { bias, slopes, powers }, activation: network.activation })
    }
}

impl<const N: usize> Power<f64, N> {
    fn fold(unit: &ProductUnit<f32, N>) -> Self {
        Power {
            exponents: unit.exponents.map(f64::from),
            log2_weight: libm::log2(libm::fabs(f64::from(unit.output))),
            sign: if unit.output < 0.0 { Sign::Minus } else { Sign::Plus },
        }
    }
}
