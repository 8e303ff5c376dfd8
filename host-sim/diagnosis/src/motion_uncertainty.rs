//! Uncertainty of a learned motion model, in directions in which identification rows tell more than the training logs.

use nalgebra::{Cholesky, DMatrix, DVector, SymmetricEigen};

use super::sample::Identification;
use mindgap_foundations::motion::Axis;
use mindgap_foundations::statistics::summary::{QUARTILE, median};
use mindgap_learning::evaluation::observations::Observation;
use mindgap_models::effects::drive_filter::FilteredDrive;
use mindgap_models::simulator::baseline::MotionModel;
use mindgap_models::simulator::nominal::MotionBias;
use mindgap_models::simulator::nominal::motion_bias::{FEATURES, features};

/// What the training logs leave uncertain of forward, lateral and turn, in directions in which identification rows tell more.
pub struct MotionUncertainty([Option<OpenDirections>; 3]);

/// The uncertain directions of one motion channel.
struct OpenDirections {
    /// For each row, how its step depends on the directions.
    directions: DMatrix<f64>,
    /// Weight of each row.
    weights: Vec<f64>,
    /// Prior standard deviation in each direction, cm or rad.
    unit: f64,
    /// Standard deviation of residuals in these logs.
    noise: f64,
    /// For each fold the posterior covariance by the other folds, in squared units.
    without: Vec<DMatrix<f64>>,
}

/// A direction is open if these rows carry at least this multiple of the training logs' information.
const LEAST_INFORMATION: f64 = 1.0;
/// Residuals are clipped at this many standard deviations: a jump of the tracker says nothing about steps.
pub const FARTHEST: f64 = 4.0;
/// Maximum number of iterations of an eigendecomposition; a hundred columns take about two hundred.
const MOST_ITERATIONS: usize = 10_000;

impl MotionUncertainty {
    /// Finds the open directions of a learned simulator on these rows. Returns `None` if there are none.
    pub fn of(rows: &Identification) -> Option<Self> {
        let MotionModel::Learned { reference, filter, .. } = rows.baseline.motion.as_ref()? else { return None };
        let residuals = rows.residuals(&rows.baseline.chain());
        MotionUncertainty::of_residuals(reference, &FilteredDrive::from(*filter), &rows.rows, &residuals)
    }

    fn of_residuals(
        reference: &MotionBias,
        drive: &FilteredDrive,
        rows: &[Observation],
        residuals: &[Option<[f64; 3]>],
    ) -> Option<Self> {
        let precision = reference.precision.as_ref()?;
        let features = DMatrix::from_row_iterator(
            rows.len(),
            FEATURES,
            rows.iter().flat_map(|row| row_features(reference, drive, row)),
        );
        let open = [0, 1, 2].map(|axis| {
            let unit = Some(reference.scatter.into_array()[axis]).filter(|unit| *unit > 0.0)?;
            let middle = median(residuals.iter().flatten().map(|r| r[axis].abs())) / QUARTILE;
            let noise = if middle > unit { middle } else { unit };
            let weights: Vec<f64> =
                rows.iter().zip(residuals).map(|(row, r)| r.map_or(0.0, |_| row.motion_weight[axis])).collect();
            let ratio = unit / noise;
            let information = weighted_products(&features, &weights) * (ratio * ratio);
            let directions = &features * open_directions(precision.of(Axis::ALL[axis])?, information)?;
            let without = covariances(&directions, rows, &weights, ratio);
            Some(OpenDirections { directions, weights, unit, noise, without })
        });
        open.iter().any(Option::is_some).then_some(MotionUncertainty(open))
    }

    /// Predicts the simulator's error in each row from the residuals of other folds. Returns `None` if no direction is open.
    pub fn predict(&self, axis: usize, rows: &[Observation], residuals: &[Option<f64>]) -> Option<Vec<f64>> {
        let OpenDirections { directions, weights, unit, noise, without } = self.0[axis].as_ref()?;
        let mut pulls = vec![DVector::zeros(directions.ncols()); without.len()];
        for (i, (row, residual)) in rows.iter().zip(residuals).enumerate() {
            let off = residual.map_or(0.0, |r| (r / noise).clamp(-FARTHEST, FARTHEST));
            pulls[row.fold] += directions.row(i).transpose() * (weights[i] * off);
        }
        let all: DVector<f64> = pulls.iter().sum();
        let of_fold =
            |(covariance, own): (&DMatrix<f64>, DVector<f64>)| covariance * (&all - own) * (unit * unit / noise);
        let errors: Vec<DVector<f64>> = without.iter().zip(pulls).map(of_fold).collect();
        let error = |(i, row): (usize, &Observation)| directions.row(i).transpose().dot(&errors[row.fold]);
        Some(rows.iter().enumerate().map(error).collect())
    }
}

/// Returns the features of a row's step. Those of n steps that are compared as one are added up and divided by √n, as their
/// residuals are.
fn row_features(reference: &MotionBias, drive: &FilteredDrive, row: &Observation) -> [f64; FEATURES] {
    let mut sum = [0.0; FEATURES];
    for step in std::iter::once(&row.context).chain(&row.following_steps) {
        let speeds = drive.speeds_of(&step.commands, &step.pieces, &step.robot);
        let of_step: [f64; FEATURES] = features(speeds.inputs(), reference.scale.share());
        sum.iter_mut().zip(of_step).for_each(|(sum, feature)| *sum += feature);
    }
    let share = 1.0 / (row.steps() as f64).sqrt();
    sum.map(|feature| share * feature)
}

fn weighted_products(columns: &DMatrix<f64>, weights: &[f64]) -> DMatrix<f64> {
    let mut weighted = columns.clone();
    weighted.row_iter_mut().zip(weights).for_each(|(mut row, weight)| row *= *weight);
    weighted.tr_mul(columns)
}

/// Returns the matrix that converts features to open directions: those in which the training logs leave one standard deviation of
/// the noise uncertain. `precision` is that of training, `information` that of the rows. Returns `None` if no direction is open.
fn open_directions(precision: DMatrix<f64>, information: DMatrix<f64>) -> Option<DMatrix<f64>> {
    let factor = Cholesky::new(precision)?;
    let lower = factor.l();
    let half = lower.solve_lower_triangular(&information)?;
    let whitened = lower.solve_lower_triangular(&half.transpose())?;
    let eigen = SymmetricEigen::try_new(whitened, f64::EPSILON, MOST_ITERATIONS)?;
    let kept: Vec<usize> = (0..FEATURES).filter(|i| eigen.eigenvalues[*i] >= LEAST_INFORMATION).collect();
    let basis = lower.tr_solve_lower_triangular(&eigen.eigenvectors.select_columns(&kept))?;
    (!kept.is_empty()).then_some(basis)
}

/// Returns for each fold the posterior covariance by the other folds.
fn covariances(directions: &DMatrix<f64>, rows: &[Observation], weights: &[f64], ratio: f64) -> Vec<DMatrix<f64>> {
    let folds = rows.iter().map(|row| row.fold + 1).max().unwrap_or(0);
    let identity = DMatrix::identity(directions.ncols(), directions.ncols());
    let covariance = |fold: usize| {
        let others = rows.iter().zip(weights).map(|(row, w)| if row.fold == fold { 0.0 } else { *w });
        let information = weighted_products(directions, &others.collect::<Vec<f64>>()) * (ratio * ratio);
        // The sum of squares and the identity is always invertible.
        (information + &identity).cholesky().map_or_else(|| identity.clone(), |factor| factor.inverse())
    };
    (0..folds).map(covariance).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::{Made, NOISE, SPIN, STRAIGHT, alternating, observations, precision};
    use mindgap_foundations::motion::Motion;
    use mindgap_models::effects::drive_filter::DriveFilter;
    use mindgap_models::simulator::ensemble::CommandScale;

    const BLOCKS: usize = 8;

    /// A correction that was learned from this many straight steps and spins.
    fn learned(straight: usize, spins: usize) -> MotionBias {
        let weights = Motion::from_fn(|_| vec![0.0; FEATURES]);
        let precision = Some(precision(straight, spins));
        MotionBias { scale: CommandScale::PERCENT, weights, scatter: NOISE.into(), precision }
    }

    /// Predicts the turns of eight runs, half of each straight on and half in spins that turn too far by the noise. One residual
    /// can be replaced by an absurd one.
    fn predicted(reference: &MotionBias, absurd: Option<f64>) -> Option<Vec<f64>> {
        let rows = observations(BLOCKS, 24, |_, at| Made {
            commands: [if at < 12 { STRAIGHT } else { SPIN }; 2],
            ..Made::default()
        });
        let off = |at: usize| if at < 12 { 0.0 } else { NOISE[2] } + 0.9 * NOISE[2] * alternating(at);
        let mut residuals: Vec<Option<[f64; 3]>> = rows.rows.iter().map(|row| Some([0.0, 0.0, off(row.at)])).collect();
        if let Some(absurd) = absurd {
            residuals[23] = Some([0.0, 0.0, absurd]);
        }
        let turns: Vec<Option<f64>> = residuals.iter().map(|r| r.map(|r| r[2])).collect();
        MotionUncertainty::of_residuals(reference, &DriveFilter::default().into(), &rows.rows, &residuals)?
            .predict(2, &rows.rows, &turns)
    }

    /// Twelve spins of seven runs predict the eighth run, up to the prior.
    #[test]
    fn rarely_trained_commands_are_corrected_by_other_runs() {
        let turns = predicted(&learned(2000, 0), None).expect("open directions");
        assert!(turns[..12].iter().all(|turn_rad| turn_rad.abs() < 0.01 * NOISE[2]), "{:?}", &turns[..12]);
        assert!(turns[12..24].iter().all(|turn_rad| (turn_rad / NOISE[2] - 0.95).abs() < 0.06), "{:?}", &turns[12..24]);
    }

    #[test]
    fn well_trained_commands_are_not_corrected() {
        assert!(predicted(&learned(2000, 500), None).is_none());
        assert!(predicted(&MotionBias { precision: None, ..learned(2000, 0) }, None).is_none());
    }

    /// However absurd, a row pulls no more than four standard deviations do.
    #[test]
    fn tracker_jump_hardly_changes_the_correction() {
        let (plain, absurd) = (predicted(&learned(2000, 0), None), predicted(&learned(2000, 0), Some(1e9)));
        let (plain, absurd) = (plain.expect("open"), absurd.expect("open"));
        let most = plain.iter().zip(&absurd).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(most < 4.0 / 60.0 * NOISE[2], "{most}");
    }

    #[test]
    fn features_of_steps_that_are_compared_as_one_add_up() {
        let mut rows = observations(1, 1, |_, _| Made { commands: [SPIN; 2], ..Made::default() }).rows;
        let one = row_features(&learned(1, 0), &DriveFilter::default().into(), &rows[0]);
        rows[0].following_steps = vec![rows[0].context; 3];
        let four = row_features(&learned(1, 0), &DriveFilter::default().into(), &rows[0]);
        assert!(one.iter().zip(four).all(|(one, four)| (2.0 * one - four).abs() < 1e-12));
    }
}
