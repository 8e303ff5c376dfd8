//! The correction of the networks' predictions as functions of single commands and of their differences: the part of the full
//! one that a board can compute, by least squares over the training steps.

use mindgap_core::monitor::{CHANNELS, FUNCTIONS, MOST_SHIFT, POINTS, RESIDUAL_BITS};
use nalgebra::{Cholesky, DMatrix, DVector};

use super::{AXES, Functions};
use crate::simulator::nominal::MotionBias;
use crate::simulator::nominal::motion_bias::{FEATURES, Precision, features};
use mindgap_foundations::motion::Axis;

/// Added to the products of features, so that they have an inverse; small against those of thousands of steps.
const RIDGE: f64 = 1e-3;
/// Functions of one channel.
type Table = [[f64; POINTS]; FUNCTIONS];

/// Returns the products of features, summed over the training steps; none where a file has another number of them.
pub fn gram(precision: &Precision) -> Option<DMatrix<f64>> {
    let without_prior = Precision { prior: mindgap_foundations::motion::Motion::ZERO, ..precision.clone() };
    without_prior.of(Axis::Turn)
}

/// Returns the functions and the power of two of their values in each channel; none where they do not fit.
pub fn functions(bias: &MotionBias, gram: &DMatrix<f64>) -> Option<(Functions, [u8; CHANNELS])> {
    let tables = AXES.map(|axis| Some(tabulated(&projected(&weights(bias, axis), gram)?)));
    let [forward, turn] = tables;
    let tables = [forward?, turn?];
    let [forward, turn] = tables.each_ref().map(shift);
    let shifts = [forward?, turn?];
    let value = |function: usize, point: usize, channel: usize| {
        libm::round(libm::ldexp(tables[channel][function][point], RESIDUAL_BITS as i32 - i32::from(shifts[channel])))
            as i16
    };
    let functions = std::array::from_fn(|function| {
        std::array::from_fn(|point| std::array::from_fn(|channel| value(function, point, channel)))
    });
    Some((functions, shifts))
}

/// Returns the smallest power of two for which values fit.
fn shift(values: &Table) -> Option<u8> {
    let most = values.as_flattened().iter().fold(0.0, |most: f64, v| most.max(v.abs()));
    (0..=MOST_SHIFT).find(|shift| libm::ldexp(most, RESIDUAL_BITS as i32 - i32::from(*shift)) < f64::from(i16::MAX))
}

/// Returns the mean square of what the functions leave of the correction, in the square of the unit of a channel.
pub fn misfit(bias: &MotionBias, gram: &DMatrix<f64>, axis: Axis) -> f64 {
    let full = weights(bias, axis);
    let left = projected(&full, gram).map_or_else(|| full.clone(), |kept| &full - kept);
    left.dot(&(gram * &left)) / gram[(0, 0)].max(1.0)
}

/// Returns the weights of an axis, for a turn in degrees.
fn weights(bias: &MotionBias, axis: Axis) -> DVector<f64> {
    let unit = if axis == Axis::Turn { 1f64.to_degrees() } else { 1.0 };
    DVector::from_fn(FEATURES, |i, _| bias.weights[axis].get(i).map_or(0.0, |w| unit * w))
}

/// Returns the features that are functions of one command or one difference: the constant, the commands, and all bends.
fn kept() -> Vec<usize> {
    // A feature is kept if it adds up over the places that it depends on.
    let at = |speeds: [f64; 4]| features(speeds, 1.0);
    let [x, y] = [0.37, -0.81];
    let alone: Vec<[f64; FEATURES]> =
        (0..4).map(|i| at(std::array::from_fn(|j| if i == j { x } else { 0.0 }))).collect();
    let pairs = |i: usize, j: usize| {
        at(std::array::from_fn(|k| {
            if k == i {
                x
            } else if k == j {
                y
            } else {
                0.0
            }
        }))
    };
    let others: Vec<[f64; FEATURES]> =
        (0..4).map(|j| at(std::array::from_fn(|k| if k == j { y } else { 0.0 }))).collect();
    let rest = at([0.0; 4]);
    let is_additive = |f: usize| {
        (0..4).all(|i| {
            (0..4).filter(|j| *j != i).all(|j| (pairs(i, j)[f] - alone[i][f] - others[j][f] + rest[f]).abs() < 1e-12)
        })
    };
    let of_difference = |f: usize| f >= FEATURES - 2 * 11;
    (0..FEATURES).filter(|f| is_additive(*f) || of_difference(*f)).collect()
}

/// Returns the weights of the kept features that come closest to all of them.
fn projected(weights: &DVector<f64>, gram: &DMatrix<f64>) -> Option<DVector<f64>> {
    let kept = kept();
    let among =
        DMatrix::from_fn(kept.len(), kept.len(), |i, j| gram[(kept[i], kept[j])] + if i == j { RIDGE } else { 0.0 });
    let pull = gram * weights;
    let pull = DVector::from_fn(kept.len(), |i, _| pull[kept[i]]);
    let solution = Cholesky::new(among)?.solve(&pull);
    let mut projected = DVector::zeros(FEATURES);
    kept.iter().zip(solution.iter()).for_each(|(feature, weight)| projected[*feature] = *weight);
    Some(projected)
}

/// Tabulates the functions: of each command alone, then of the differences.
fn tabulated(weights: &DVector<f64>) -> Table {
    let sum = |speeds: [f64; 4], among: std::ops::Range<usize>| -> f64 {
        let values = features(speeds, 1.0);
        among.map(|f| weights[f] * values[f]).sum()
    };
    let differences = FEATURES - 2 * 11..FEATURES;
    let commands = 0..FEATURES - 2 * 11;
    let rest = sum([0.0; 4], commands.clone());
    let value = |function: usize, share: f64| match function {
        0 => sum([share, 0.0, 0.0, 0.0], commands.clone()),
        i @ 1..4 => {
            let mut speeds = [0.0; 4];
            speeds[i] = share;
            sum(speeds, commands.clone()) - rest
        }
        4 => sum([0.0, 2.0 * share, 0.0, 0.0], FEATURES - 22..FEATURES - 11),
        _ => sum([0.0, 0.0, 0.0, 2.0 * share], differences.start + 11..FEATURES),
    };
    let share = |point: usize| (point as f64 - (POINTS / 2) as f64) / (POINTS / 2) as f64;
    std::array::from_fn(|function| std::array::from_fn(|point| value(function, share(point))))
}
