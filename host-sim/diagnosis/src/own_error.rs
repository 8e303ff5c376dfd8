//! What a simulator does not know of its own motion.
//!
//! Training logs leave the weights of a simulator's correction open, most under commands that they seldom drive. It is no gap
//! if a robot does there what they allow: what these rows tell of it is taken away before anything is sought in what effects
//! leave. That is a regression on the features of the correction whose prior is what the training logs leave open, their
//! posterior (Bishop 2006, Pattern Recognition and Machine Learning, section 3.3). It has directions of which the training logs
//! tell less than these rows do, and no others: what was learned better than these logs could tell it is a yardstick.

use nalgebra::{Cholesky, DMatrix, DVector, SymmetricEigen};

use mindgap_foundations::statistics::summary::{QUARTILE, median};
use mindgap_learning::evaluation::observations::{Observation, Observations};
use mindgap_learning::evaluation::predictions::residual;
use mindgap_models::effects::StepContext;
use mindgap_models::effects::chain::EffectChain;
use mindgap_models::simulator::baseline::{Baseline, MotionModel};
use mindgap_models::simulator::nominal::MotionBias;
use mindgap_models::simulator::nominal::motion_bias::{FEATURES, features};

/// What is open of forward, lateral and turn; none where the training logs tell all of it.
pub struct OwnErrors([Option<OwnError>; 3]);

/// What is open of one of them.
struct OwnError {
    /// Of each row, the directions of which its step tells,
    directions: DMatrix<f64>,
    /// and how much it counts.
    weights: Vec<f64>,
    /// Standard deviation of what is open in each direction, cm or rad.
    unit: f64,
    /// Standard deviation of steps in these logs.
    scatter: f64,
    /// For each fold the posterior covariance by the others, in units of what is open.
    without: Vec<DMatrix<f64>>,
}

/// A direction is open where these rows tell at least as much of it as all training logs did.
const LEAST_TOLD: f64 = 1.0;
/// A residual that is farther off pulls no more than this, in standard deviations: a jump of the tracker says nothing of steps.
pub const FARTHEST: f64 = 4.0;
/// Of an eigendecomposition; a hundred columns take some two hundred.
const MOST_ITERATIONS: usize = 10_000;

impl OwnErrors {
    /// Of the motion of a simulator on these rows; none where nothing is open.
    pub fn of(baseline: &Baseline, rows: &Observations) -> Option<Self> {
        let drive @ MotionModel::Learned { reference, .. } = baseline.motion.as_ref()? else { return None };
        let effects = EffectChain::of(&baseline.applied);
        let residuals: Vec<Option<[f64; 3]>> = rows.rows.iter().map(|row| residual(&effects, drive, row)).collect();
        OwnErrors::left_by(reference, &rows.rows, &residuals)
    }

    /// Of rows that leave these residuals: forward (cm), lateral (cm) and turn (rad).
    fn left_by(reference: &MotionBias, rows: &[Observation], residuals: &[Option<[f64; 3]>]) -> Option<Self> {
        let precision = reference.precision.as_ref()?;
        let features =
            DMatrix::from_row_iterator(rows.len(), FEATURES, rows.iter().flat_map(|row| of_row(reference, row)));
        let open = [0, 1, 2].map(|axis| {
            let unit = Some(reference.scatter[axis]).filter(|unit| *unit > 0.0)?;
            let middle = median(residuals.iter().flatten().map(|r| r[axis].abs())) / QUARTILE;
            let scatter = if middle > unit { middle } else { unit };
            let weights: Vec<f64> =
                rows.iter().zip(residuals).map(|(row, r)| r.map_or(0.0, |_| row.motion_weight[axis])).collect();
            let share = unit / scatter;
            let told = weighted_products(&features, &weights) * (share * share);
            let directions = &features * open_directions(precision.of(axis)?, told)?;
            let without = covariances(&directions, rows, &weights, share);
            Some(OwnError { directions, weights, unit, scatter, without })
        });
        open.iter().any(Option::is_some).then_some(OwnErrors(open))
    }

    /// What of the residuals of an axis is the simulator's own error, as the rows of other folds tell each row; none where
    /// nothing is open.
    pub fn foretold(&self, axis: usize, rows: &[Observation], residuals: &[Option<f64>]) -> Option<Vec<f64>> {
        let OwnError { directions, weights, unit, scatter, without } = self.0[axis].as_ref()?;
        let mut pulls = vec![DVector::zeros(directions.ncols()); without.len()];
        for (i, (row, residual)) in rows.iter().zip(residuals).enumerate() {
            let off = residual.map_or(0.0, |r| (r / scatter).clamp(-FARTHEST, FARTHEST));
            pulls[row.fold] += directions.row(i).transpose() * (weights[i] * off);
        }
        let all: DVector<f64> = pulls.iter().sum();
        let told =
            without.iter().zip(pulls).map(|(covariance, own)| covariance * (&all - own) * (unit * unit / scatter));
        let told: Vec<DVector<f64>> = told.collect();
        Some(rows.iter().enumerate().map(|(i, row)| directions.row(i).transpose().dot(&told[row.fold])).collect())
    }
}

/// The features of a row's step; those of steps that are judged as one add up, and are given a step as their scatter is.
fn of_row(reference: &MotionBias, row: &Observation) -> [f64; FEATURES] {
    let mut sum = [0.0; FEATURES];
    for step in std::iter::once(&row.context).chain(&row.then) {
        let StepContext { commands: [[left, right], [left_before, right_before], ..], .. } = step;
        let of_step: [f64; FEATURES] = features([*left, *right, *left_before, *right_before], reference.scale.share());
        sum.iter_mut().zip(of_step).for_each(|(sum, feature)| *sum += feature);
    }
    let share = 1.0 / ((1 + row.then.len()) as f64).sqrt();
    sum.map(|feature| share * feature)
}

fn weighted_products(columns: &DMatrix<f64>, weights: &[f64]) -> DMatrix<f64> {
    let mut weighted = columns.clone();
    weighted.row_iter_mut().zip(weights).for_each(|(mut row, weight)| row *= *weight);
    weighted.tr_mul(columns)
}

/// What makes open directions of features, in which the training logs leave a standard deviation of the noise open, those that
/// rows tell at least as much of; none where there is none. `precision` is that of training, `told` that of the rows.
fn open_directions(precision: DMatrix<f64>, told: DMatrix<f64>) -> Option<DMatrix<f64>> {
    let factor = Cholesky::new(precision)?;
    let lower = factor.l();
    let half = lower.solve_lower_triangular(&told)?;
    let whitened = lower.solve_lower_triangular(&half.transpose())?;
    let eigen = SymmetricEigen::try_new(whitened, f64::EPSILON, MOST_ITERATIONS)?;
    let kept: Vec<usize> = (0..FEATURES).filter(|i| eigen.eigenvalues[*i] >= LEAST_TOLD).collect();
    let basis = lower.tr_solve_lower_triangular(&eigen.eigenvectors.select_columns(&kept))?;
    (!kept.is_empty()).then_some(basis)
}

/// For each fold the posterior covariance by the other ones.
fn covariances(directions: &DMatrix<f64>, rows: &[Observation], weights: &[f64], share: f64) -> Vec<DMatrix<f64>> {
    let folds = rows.iter().map(|row| row.fold + 1).max().unwrap_or(0);
    let identity = DMatrix::identity(directions.ncols(), directions.ncols());
    let covariance = |fold: usize| {
        let others = rows.iter().zip(weights).map(|(row, w)| if row.fold == fold { 0.0 } else { *w });
        let told = weighted_products(directions, &others.collect::<Vec<f64>>()) * (share * share);
        // A sum of squares and the identity has an inverse.
        (told + &identity).cholesky().map_or_else(|| identity.clone(), |factor| factor.inverse())
    };
    (0..folds).map(covariance).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::{Made, SCATTER, SPIN, STRAIGHT, alternating, observations, precision};
    use mindgap_models::simulator::ensemble::CommandScale;

    const BLOCKS: usize = 8;

    /// What so many steps straight on and in spins leave.
    fn learned(straight: usize, spins: usize) -> MotionBias {
        let weights = [0, 1, 2].map(|_| vec![0.0; FEATURES]);
        let precision = Some(precision(straight, spins));
        MotionBias { scale: CommandScale::PERCENT, weights, scatter: SCATTER, precision }
    }

    /// Eight runs, half of each straight on and half in spins that turn too far by the scatter; the rows, and what is told of
    /// the turn of each.
    fn told(reference: &MotionBias, absurd: Option<f64>) -> Option<Vec<f64>> {
        let rows = observations(BLOCKS, 24, |_, at| Made {
            commands: [if at < 12 { STRAIGHT } else { SPIN }; 2],
            ..Made::default()
        });
        let off = |at: usize| if at < 12 { 0.0 } else { SCATTER[2] } + 0.9 * SCATTER[2] * alternating(at);
        let mut residuals: Vec<Option<[f64; 3]>> = rows.rows.iter().map(|row| Some([0.0, 0.0, off(row.at)])).collect();
        if let Some(absurd) = absurd {
            residuals[23] = Some([0.0, 0.0, absurd]);
        }
        let turns: Vec<Option<f64>> = residuals.iter().map(|r| r.map(|r| r[2])).collect();
        OwnErrors::left_by(reference, &rows.rows, &residuals)?.foretold(2, &rows.rows, &turns)
    }

    /// Seven runs of twelve spins tell of an eighth one what the prior leaves of their mean.
    #[test]
    fn what_training_hardly_drove_is_told_by_other_runs() {
        let told = told(&learned(2000, 0), None).expect("something open");
        assert!(told[..12].iter().all(|turn_rad| turn_rad.abs() < 0.01 * SCATTER[2]), "{:?}", &told[..12]);
        assert!(told[12..24].iter().all(|turn_rad| (turn_rad / SCATTER[2] - 0.95).abs() < 0.06), "{:?}", &told[12..24]);
    }

    #[test]
    fn what_training_drove_more_often_is_not_open() {
        assert!(told(&learned(2000, 500), None).is_none());
        assert!(told(&MotionBias { precision: None, ..learned(2000, 0) }, None).is_none());
    }

    /// However absurd, one row pulls as four standard deviations do.
    #[test]
    fn a_jump_says_nothing_of_steps() {
        let (plain, absurd) = (told(&learned(2000, 0), None), told(&learned(2000, 0), Some(1e9)));
        let (plain, absurd) = (plain.expect("open"), absurd.expect("open"));
        let most = plain.iter().zip(&absurd).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(most < 4.0 / 60.0 * SCATTER[2], "{most}");
    }

    /// What is open of steps that are judged as one is open of each of them.
    #[test]
    fn steps_that_are_judged_as_one_add_up() {
        let mut rows = observations(1, 1, |_, _| Made { commands: [SPIN; 2], ..Made::default() }).rows;
        let one = of_row(&learned(1, 0), &rows[0]);
        rows[0].then = vec![rows[0].context; 3];
        let four = of_row(&learned(1, 0), &rows[0]);
        assert!(one.iter().zip(four).all(|(one, four)| (2.0 * one - four).abs() < 1e-12));
    }
}
