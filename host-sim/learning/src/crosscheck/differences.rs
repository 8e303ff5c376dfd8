//! One network in both arithmetics.

use fixed::types::I16F16;
use mindgap_core::folded::FoldedNetwork;
use mindgap_core::network::Scaling;
use rayon::prelude::*;
use schemars::JsonSchema;
use serde::Serialize;

use mindgap_models::simulator::fixed_point::Quantised;

/// Errors of a network in fixed point relative to float, in the unit of its output.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct NetworkCheck {
    /// Upper bound of the rounding error at any input whose output fits Q16.16, derived from the weights.
    pub error_bound: f64,
    /// Differences on the samples of the logs.
    pub samples: Differences,
    /// Differences on an even grid over the trained range of all inputs.
    pub grid: Differences,
}

/// Differences at many inputs.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct Differences {
    /// Number of inputs.
    pub n: usize,
    /// The largest absolute difference.
    pub worst: f64,
    /// The input at which it is the largest.
    pub worst_at: Vec<f32>,
    /// The mean absolute difference.
    pub mean: f64,
    /// Number of inputs outside the trained range, which both arithmetics clamp to it.
    pub clamped: usize,
}

/// Largest number of points of a grid: 25 along each of four inputs, 625 along each of two.
const GRID_POINTS: usize = 390_625;

impl NetworkCheck {
    pub(super) fn new<const N: usize>(
        float: &FoldedNetwork<f32, N>,
        fixed: &Quantised<N>,
        samples: &[[f32; N]],
    ) -> NetworkCheck {
        let at = |inputs: &[f32; N]| Differences::at(float, fixed, inputs);
        let total = |each: Vec<Differences>| each.into_iter().fold(Differences::default(), Differences::and);
        let side = (1..).take_while(|side: &usize| side.pow(N as u32) <= GRID_POINTS).last().unwrap_or(1);
        let ranges = float.inputs.map(trained_range);
        let slices = (0..side).into_par_iter().map(|first| {
            let rest = side.pow(N as u32 - 1);
            (0..rest)
                .map(|i| at(&grid_point(first * rest + i, side, &ranges)))
                .fold(Differences::default(), Differences::and)
        });
        NetworkCheck {
            error_bound: fixed.error_bound,
            samples: total(samples.iter().map(at).collect()),
            grid: total(slices.collect()),
        }
    }
}

impl Differences {
    fn at<const N: usize>(float: &FoldedNetwork<f32, N>, fixed: &Quantised<N>, inputs: &[f32; N]) -> Self {
        let expected = f64::from(float.evaluate(*inputs));
        let output = fixed.network.evaluate(inputs.map(I16F16::saturating_from_num));
        let difference = (output.value.to_num::<f64>() - expected).abs();
        Differences {
            n: 1,
            worst: difference,
            worst_at: inputs.to_vec(),
            mean: difference,
            clamped: usize::from(output.clamped),
        }
    }

    fn and(self, other: Self) -> Self {
        let n = self.n + other.n;
        let (worst, worst_at) = match self.worst >= other.worst && self.n > 0 {
            true => (self.worst, self.worst_at),
            false => (other.worst, other.worst_at),
        };
        let sum = self.mean * self.n as f64 + other.mean * other.n as f64;
        Differences { n, worst, worst_at, mean: sum / n.max(1) as f64, clamped: self.clamped + other.clamped }
    }
}

/// Returns the range of inputs that scaling does not clamp, within Q16.16.
fn trained_range(scaling: Scaling<f32>) -> [f64; 2] {
    let Scaling { gain, offset, low, high } = scaling;
    if gain == 0.0 {
        return [0.0; 2];
    }
    let limit = f64::from(I16F16::MAX.to_num::<f32>());
    [low, high].map(|end| ((f64::from(end) - f64::from(offset)) / f64::from(gain)).clamp(-limit, limit))
}

/// Returns a point of a grid of `side` points along each input, numbered with the last input changing fastest.
fn grid_point<const N: usize>(number: usize, side: usize, ranges: &[[f64; 2]; N]) -> [f32; N] {
    std::array::from_fn(|input| {
        let place = number / side.pow((N - 1 - input) as u32) % side;
        let [from, to] = ranges[input];
        (from + (to - from) * place as f64 / (side - 1) as f64) as f32
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grid_covers_the_whole_range() {
        let ranges = [[-70.0, 80.0], [0.0, 90.0]];
        assert_eq!(grid_point(0, 4, &ranges), [-70.0, 0.0]);
        assert_eq!(grid_point(7, 4, &ranges), [-20.0, 90.0]);
        assert_eq!(grid_point(15, 4, &ranges), [80.0, 90.0]);
    }

    #[test]
    fn worst_difference_keeps_its_input() {
        let at = |x: f32, difference| Differences {
            n: 1,
            worst: difference,
            worst_at: vec![x],
            mean: difference,
            clamped: 1,
        };
        let all =
            [at(1.0, 0.25), at(2.0, 1.0), at(3.0, 0.25)].into_iter().fold(Differences::default(), Differences::and);
        assert_eq!(all, Differences { n: 3, worst: 1.0, worst_at: vec![2.0], mean: 0.5, clamped: 3 });
    }
}
