//! The covariance between the motions under two commands: a sum of parts, each a function of the commands on nodes,
//! linear between them, about a line of which nothing is known beforehand.
//!
//! Friction bends the response to a wheel's command, and to the difference of both, near zero and hardly elsewhere; so
//! those parts have one dimension each and nodes that are close together there. What depends on both commands is smooth.

use nalgebra::{Cholesky, DMatrix};

use super::command_scale::Percent;

/// Parts of the process: a constant, the left command, the right one, their difference, both together, and what changed
/// about the robot since its training logs, a factor on each wheel.
pub const PARTS: usize = 6;
/// The last of them, which training logs say nothing of.
pub const CHANGE: usize = PARTS - 1;
/// Comes after them: a motion in proportion to each wheel's command, which has no prior size to learn.
pub const LINE: usize = PARTS;
/// Weights of a command on nodes: one, three times two, four, two, and two.
const WEIGHTS: usize = 15;
/// The first of those of the change.
const OF_CHANGE: usize = 13;
/// The nodes that a command lies among with their weights.
pub type Weights = [(usize, f64); WEIGHTS];

/// Nodes on either side of zero along one command, along the difference of two, and along each side of the square.
const REACH: [usize; 3] = [13, 16, 6];
/// Distance of nodes along a bent axis.
const BENT_STEP: f64 = 0.25;
/// Shares of full command about which the axes of single commands bend: what a wheel needs to break away.
const BEND: f64 = 0.08;
/// How far a bias reaches: along bent axes, and in shares of full command on the square.
const BENT_LENGTH: f64 = 1.0;
const SQUARE_LENGTH: f64 = 0.5;
/// Keeps covariances of close nodes invertible, as a share of the variance.
const JITTER: f64 = 1e-8;

/// Number of nodes of each part.
const NODES: [usize; PARTS + 1] =
    [1, 2 * REACH[0] + 1, 2 * REACH[0] + 1, 2 * REACH[1] + 1, (2 * REACH[2] + 1) * (2 * REACH[2] + 1), 2, 2];
/// Number of all nodes.
pub const SIZE: usize = NODES[0] + NODES[1] + NODES[2] + NODES[3] + NODES[4] + NODES[5] + NODES[6];

/// The part that a node belongs to.
pub fn part(node: usize) -> usize {
    let mut end = 0;
    NODES
        .iter()
        .take_while(|count| {
            end += **count;
            end <= node
        })
        .count()
}

/// The nodes that a command lies among with their weights: its motion is the weighted sum of theirs.
pub fn weights(Percent(command): Percent) -> Weights {
    let [left, right] = command.map(|c| 0.01 * c);
    let (a, b) = (between(bent(left), REACH[0]), between(bent(right), REACH[0]));
    let difference = between(bent(right - left), REACH[1]);
    let square = [left, right].map(|c| between(c * REACH[2] as f64, REACH[2]));
    let mut weights = [(0, 1.0); WEIGHTS];
    let mut first = NODES[0];
    for (part, [low, high]) in [a, b, difference].into_iter().enumerate() {
        weights[1 + 2 * part] = (first + low.0, low.1);
        weights[2 + 2 * part] = (first + high.0, high.1);
        first += NODES[1 + part];
    }
    let side = 2 * REACH[2] + 1;
    for (corner, place) in weights[7..11].iter_mut().enumerate() {
        let ((i, along), (j, across)) = (square[0][corner / 2], square[1][corner % 2]);
        *place = (first + i * side + j, along * across);
    }
    let change = first + NODES[4];
    let line = change + NODES[CHANGE];
    weights[11] = (line, left);
    weights[12] = (line + 1, right);
    weights[OF_CHANGE] = (change, left);
    weights[OF_CHANGE + 1] = (change + 1, right);
    weights
}

/// The same for a robot as it was in its training logs, before it may have changed.
pub fn weights_in_training(command: Percent) -> Weights {
    let mut weights = weights(command);
    weights[OF_CHANGE..].iter_mut().for_each(|(_, weight)| *weight = 0.0);
    weights
}

/// The lower Cholesky factor of the covariance of all nodes, each part with a standard deviation of one.
pub fn unit_factor() -> DMatrix<f64> {
    let mut factor = DMatrix::zeros(SIZE, SIZE);
    let mut first = 0;
    for (part, count) in NODES.into_iter().enumerate() {
        let covariance =
            DMatrix::from_fn(count, count, |i, j| covariance(part, i, j) + if i == j { JITTER } else { 0.0 });
        let block = Cholesky::new(covariance).map_or_else(|| DMatrix::identity(count, count), |c| c.unpack());
        factor.view_mut((first, first), (count, count)).copy_from(&block);
        first += count;
    }
    factor
}

/// The covariance of two nodes of a part with a standard deviation of one.
fn covariance(part: usize, i: usize, j: usize) -> f64 {
    let apart = |i: usize, j: usize| i.abs_diff(j) as f64;
    match part {
        0 => 1.0,
        CHANGE | LINE => f64::from(u8::from(i == j)),
        4 => {
            let side = 2 * REACH[2] + 1;
            let (x, y) = (apart(i / side, j / side), apart(i % side, j % side));
            matern((x * x + y * y).sqrt() / (REACH[2] as f64 * SQUARE_LENGTH))
        }
        _ => matern(apart(i, j) * BENT_STEP / BENT_LENGTH),
    }
}

/// Matérn's covariance with smoothness 3/2 at a distance in lengths.
fn matern(distance: f64) -> f64 {
    let scaled = 3f64.sqrt() * distance;
    (1.0 + scaled) * libm::exp(-scaled)
}

/// Where a command, as a share of full, lies along a bent axis, in steps of its nodes: linear near zero, logarithmic far
/// from it.
fn bent(share: f64) -> f64 {
    libm::asinh(share / BEND) / BENT_STEP
}

/// The two nodes about a place, with their weights; places beyond the last node count as that.
fn between(place: f64, reach: usize) -> [(usize, f64); 2] {
    let place = (place + reach as f64).clamp(0.0, 2.0 * reach as f64);
    let low = (place as usize).min(2 * reach - 1);
    let part = place - low as f64;
    [(low, 1.0 - part), (low + 1, part)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn every_part_weighs_one(left in -100f64..100.0, right in -100f64..100.0) {
            let mut sums = [0.0; PARTS + 1];
            for (node, weight) in weights(Percent([left, right])) {
                prop_assert!(node < SIZE && weight.abs() <= 1.0);
                sums[part(node)] += weight;
            }
            prop_assert!(sums[..CHANGE].iter().all(|sum| (sum - 1.0).abs() < 1e-12), "{sums:?}");
            for wheels in [CHANGE, LINE] {
                prop_assert!((100.0 * sums[wheels] - left - right).abs() < 1e-9, "{sums:?}");
            }
        }
    }

    #[test]
    fn axes_reach_as_far_as_commands() {
        assert!(bent(1.0) <= REACH[0] as f64 && bent(2.0) <= REACH[1] as f64);
    }

    #[test]
    fn the_factor_gives_the_covariance_back() {
        let factor = unit_factor();
        let covariance = &factor * factor.transpose();
        assert!((0..SIZE).all(|i| (covariance[(i, i)] - 1.0).abs() < 1e-6));
        // Neighbours along the left command.
        assert!((covariance[(1, 2)] - matern(0.25)).abs() < 1e-6);
        assert_eq!(covariance[(1, 1 + NODES[1])], 0.0, "parts are independent");
    }
}
