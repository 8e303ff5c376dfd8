//! The bias of the motion networks: a correction of their outputs, and the scatter of logs about the sum.

use mindgap_core::scalar::Scalar;
use nalgebra::DMatrix;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::simulator::ensemble::CommandScale;
use mindgap_foundations::motion::{Axis, Motion};

/// Corrections and scatter of the motion.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MotionBias {
    /// The scale of the robot's commands.
    #[serde(default)]
    pub scale: CommandScale,
    /// One weight per feature of the command, for each axis.
    pub weights: Motion<Vec<f64>>,
    /// Standard deviations about the corrected outputs.
    pub scatter: Motion<f64>,
    /// How well the training logs determine the weights.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub precision: Option<Precision>,
}

/// The precision of weights by Bayesian linear regression, in units of the scatter: the products of features summed over all
/// training steps, and what the prior adds on the diagonal.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Precision {
    /// The lower triangle of the products, row by row.
    pub products: Vec<f32>,
    /// Precision of the prior, for each axis.
    pub prior: Motion<f64>,
}

impl Precision {
    /// Returns the precision of the weights of one axis; none where a file has another number of products.
    pub fn of(&self, axis: Axis) -> Option<DMatrix<f64>> {
        let mut precision = DMatrix::from_diagonal_element(FEATURES, FEATURES, self.prior[axis]);
        (self.products.len() == lower_triangle().count()).then_some(())?;
        for ((a, b), product) in lower_triangle().zip(&self.products) {
            precision[(a, b)] += f64::from(*product);
            precision[(b, a)] = precision[(a, b)];
        }
        Some(precision)
    }

    /// Returns the number of training steps: the first feature is one.
    pub fn steps(&self) -> Option<f64> {
        self.products.first().copied().map(f64::from)
    }
}

/// Magnitudes of commands, and of the difference of right and left one, at which a correction may bend: friction dominates
/// small ones.
const KNOTS: [f32; 5] = [0.03, 0.06, 0.12, 0.25, 0.5];
/// Numbers that [`features`] makes of four commands.
pub const FEATURES: usize = 1 + 4 + 10 + 20 + 6 * (1 + 2 * KNOTS.len());

impl MotionBias {
    /// Returns the correction of the networks' outputs for left, right, previous left and previous right command.
    pub fn correction(&self, speeds: &[f64; 4]) -> Motion<f64> {
        let Motion { forward, lateral, turn } = &self.weights;
        let weights = forward.iter().zip(lateral).zip(turn);
        // The three sums do not wait for each other.
        let add = |sum: Motion<f64>, (((forward, lateral), turn), feature): (((&f64, &f64), &f64), &f64)| Motion {
            forward: sum.forward + forward * feature,
            lateral: sum.lateral + lateral * feature,
            turn: sum.turn + turn * feature,
        };
        weights.zip(&features(*speeds, self.scale.share())).fold(Motion::ZERO, add)
    }
}

/// All products of up to three commands, and bends where the magnitude of a command, or of the difference of right and
/// left one, passes a knot. Commands times `share` are shares of full speed.
#[inline(always)]
pub fn features<S: Scalar<Weight: From<f32>>>(speeds: [S; 4], share: f32) -> [S; FEATURES] {
    let one = speeds[0].one();
    let mut u = speeds;
    for command in &mut u {
        *command = *command * one.constant(share.into());
    }
    let mut features = Features { values: [one; FEATURES], count: 1 };
    for a in 0..4 {
        features.push(u[a]);
        for b in a..4 {
            let square = u[a] * u[b];
            features.push(square);
            for command in &u[b..] {
                features.push(square * *command);
            }
        }
    }
    for command in u {
        features.bend(command);
    }
    features.bend(u[1] - u[0]);
    features.bend(u[3] - u[2]);
    features.values
}

/// The lower triangle, row by row, of the products of features, summed over rows of them.
pub fn products(rows: &[Vec<f64>]) -> Vec<f32> {
    let product = |a: usize, b: usize| rows.iter().map(|row| row[a] * row[b]).sum::<f64>() as f32;
    lower_triangle().map(|(a, b)| product(a, b)).collect()
}

/// Pairs of features in the order of [`Precision::products`].
fn lower_triangle() -> impl Iterator<Item = (usize, usize)> {
    (0..FEATURES).flat_map(|a| (0..=a).map(move |b| (a, b)))
}

/// The features so far.
struct Features<S> {
    values: [S; FEATURES],
    count: usize,
}

impl<S: Scalar<Weight: From<f32>>> Features<S> {
    #[inline(always)]
    fn push(&mut self, feature: S) {
        self.values[self.count] = feature;
        self.count += 1;
    }

    /// The magnitude of `x`, and for every knot what is beyond it on either side, as sum and as difference.
    #[inline(always)]
    fn bend(&mut self, x: S) {
        let (zero, most) = (x.zero(), x.constant(4.0.into()));
        self.push(x.clamp(zero, most) + (zero - x).clamp(zero, most));
        for knot in KNOTS {
            let knot = x.constant(knot.into());
            let (above, below) = ((x - knot).clamp(zero, most), (zero - x - knot).clamp(zero, most));
            self.push(above + below);
            self.push(above - below);
        }
    }
}
