//! Ridge regression (Hoerl and Kennard 1970) in closed form, with the penalty chosen by nested cross-validation.
//!
//! All validation errors follow from the normal equations of the folds, so rows are visited once. The penalty for predicting
//! a fold is chosen without that fold, so the gain there is a true out-of-sample gain.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

/// Maximum number of updates of the working response.
pub const MAX_ITERATIONS: usize = 10;
/// Iteration stops once no prediction changes by more than this, in noise standard deviations.
pub const CONVERGED: f64 = 1e-3;

/// A fitted ridge regression.
#[derive(Clone, Debug, PartialEq)]
pub struct Ridge {
    /// Prediction of each row from the other folds.
    pub held_out: Vec<f64>,
    /// Weight of each column, fitted to all rows; zeros if predicting zero is best.
    pub weights: Vec<f64>,
    /// Chosen ratio of noise variance to prior variance; `None` if predicting zero is best.
    pub strength: Option<f64>,
}

/// Normal equations of some rows: XᵀX and Xᵀy.
#[derive(Clone)]
struct Normal {
    gram: DMatrix<f64>,
    moment: DVector<f64>,
}

type Factor = Cholesky<f64, Dyn>;

/// Fits `response(row, prediction)`, the working response of a row at its current prediction: for a Gaussian likelihood the
/// observation itself, otherwise the prediction plus score over largest curvature, so that every iteration climbs (Böhning
/// and Lindsay 1988). Responses are scaled so that their noise has a standard deviation of at most one. `folds` gives the
/// fold of each row and `candidates` the ratios of noise variance to prior variance to try, besides predicting zero.
pub fn fit(rows: &[Vec<f64>], folds: &[usize], candidates: &[f64], response: impl Fn(usize, f64) -> f64) -> Ridge {
    let count = folds.iter().max().map_or(0, |most| most + 1);
    let normals: Vec<Normal> =
        (0..count).map(|fold| normal(rows, |i| folds[i] == fold, |i| response(i, 0.0))).collect();
    let columns = rows.first().map_or(0, Vec::len);
    let fit_weights = |strength: Option<f64>, excluded: Option<usize>| {
        let factor = strength.and_then(|s| factor(&normals, &[excluded.unwrap_or(count)], s));
        factor.map_or_else(
            || vec![0.0; columns],
            |(factor, start)| iterate(rows, |i| Some(folds[i]) != excluded, &response, &factor, start),
        )
    };
    let (nested, strength) = strengths(&normals, candidates);
    let without: Vec<Vec<f64>> = nested.iter().enumerate().map(|(fold, s)| fit_weights(*s, Some(fold))).collect();
    let held_out = rows.iter().zip(folds).map(|(row, fold)| predicted(row, &without[*fold])).collect();
    Ridge { held_out, weights: fit_weights(strength, None), strength }
}

/// Returns the prediction of a row.
pub fn predicted(row: &[f64], weights: &[f64]) -> f64 {
    row.iter().zip(weights).map(|(value, weight)| value * weight).sum()
}

/// Returns the best strength for each fold, chosen on the others, and the best over all folds.
fn strengths(normals: &[Normal], candidates: &[f64]) -> (Vec<Option<f64>>, Option<f64>) {
    let count = normals.len();
    let mut nested = vec![vec![0.0; candidates.len()]; count];
    let mut overall = vec![0.0; candidates.len()];
    for (c, strength) in candidates.iter().enumerate() {
        for one in 0..count {
            if let Some((_, weights)) = factor(normals, &[one], *strength) {
                overall[c] += normals[one].error(&weights);
            }
            for other in 0..one {
                if let Some((_, weights)) = factor(normals, &[one, other], *strength) {
                    nested[one][c] += normals[other].error(&weights);
                    nested[other][c] += normals[one].error(&weights);
                }
            }
        }
    }
    let best = |errors: &Vec<f64>| best(candidates, errors);
    (nested.iter().map(best).collect(), best(&overall))
}

/// Returns the strength with the smallest error, or `None` if predicting zero has less.
fn best(candidates: &[f64], errors: &[f64]) -> Option<f64> {
    let least = errors.iter().zip(candidates).min_by(|a, b| a.0.total_cmp(b.0));
    least.filter(|(error, _)| **error < 0.0).map(|(_, strength)| *strength)
}

/// Factorises the penalised normal equations of all folds but the `excluded` ones and solves them.
fn factor(normals: &[Normal], excluded: &[usize], strength: f64) -> Option<(Factor, DVector<f64>)> {
    let mut kept = normals.iter().enumerate().filter(|(fold, _)| !excluded.contains(fold)).map(|(_, normal)| normal);
    let Normal { mut gram, mut moment } = kept.next()?.clone();
    for normal in kept {
        gram += &normal.gram;
        moment += &normal.moment;
    }
    (0..gram.nrows()).for_each(|i| gram[(i, i)] += strength);
    let factor = gram.cholesky()?;
    factor.solve_mut(&mut moment);
    Some((factor, moment))
}

/// Iterates the working response to convergence and returns the weights.
fn iterate(
    rows: &[Vec<f64>],
    kept: impl Fn(usize) -> bool,
    response: &impl Fn(usize, f64) -> f64,
    factor: &Factor,
    start: DVector<f64>,
) -> Vec<f64> {
    let mut weights = start;
    let mut predictions = vec![0.0; rows.len()];
    for _ in 0..MAX_ITERATIONS {
        let mut moment = DVector::zeros(weights.len());
        let mut change = 0.0;
        for (i, row) in rows.iter().enumerate().filter(|(i, _)| kept(*i)) {
            let prediction = predicted(row, weights.as_slice());
            change = f64::max(change, (prediction - predictions[i]).abs());
            predictions[i] = prediction;
            let response = response(i, prediction);
            moment.iter_mut().zip(row).for_each(|(moment, value)| *moment += value * response);
        }
        if change < CONVERGED {
            break;
        }
        factor.solve_mut(&mut moment);
        weights = moment;
    }
    weights.as_slice().to_vec()
}

fn normal(rows: &[Vec<f64>], kept: impl Fn(usize) -> bool, response: impl Fn(usize) -> f64) -> Normal {
    let columns = rows.first().map_or(0, Vec::len);
    let mut gram = DMatrix::zeros(columns, columns);
    let mut moment = DVector::zeros(columns);
    for (i, row) in rows.iter().enumerate().filter(|(i, _)| kept(*i)) {
        let response = response(i);
        for (c, value) in row.iter().enumerate() {
            moment[c] += value * response;
            // The factorisation reads only the lower triangle, stored column by column.
            let column = &mut gram.as_mut_slice()[c * columns + c..(c + 1) * columns];
            column.iter_mut().zip(&row[c..]).for_each(|(sum, other)| *sum += value * other);
        }
    }
    gram.fill_upper_triangle_with_lower_triangle();
    Normal { gram, moment }
}

impl Normal {
    /// Returns the squared error of these weights minus that of predicting zero.
    fn error(&self, weights: &DVector<f64>) -> f64 {
        (&self.gram * weights).dot(weights) - 2.0 * self.moment.dot(weights)
    }
}

#[cfg(test)]
mod tests {
    use rand::RngExt;

    use super::*;
    use crate::random::generator;

    const STRENGTHS: [f64; 7] = [1000.0, 215.0, 46.0, 10.0, 2.15, 0.46, 0.1];
    const FOLDS: usize = 8;
    const ROWS: usize = 400;
    const COLUMNS: usize = 20;

    fn normal_number(rng: &mut impl RngExt) -> f64 {
        (0..12).map(|_| rng.random::<f64>()).sum::<f64>() - 6.0
    }

    /// Rows, their folds, and noise of standard deviation one.
    fn synthetic(seed: u64) -> (Vec<Vec<f64>>, Vec<usize>, Vec<f64>) {
        let mut rng = generator(seed, &[]);
        let rows = (0..ROWS).map(|_| (0..COLUMNS).map(|_| normal_number(&mut rng)).collect()).collect();
        let folds = (0..ROWS).map(|i| i * FOLDS / ROWS).collect();
        let noise = (0..ROWS).map(|_| normal_number(&mut rng)).collect();
        (rows, folds, noise)
    }

    fn normals(rows: &[Vec<f64>], folds: &[usize], data: &[f64]) -> Vec<Normal> {
        (0..FOLDS).map(|fold| normal(rows, |i| folds[i] == fold, |i| data[i])).collect()
    }

    /// Reduction of the squared error.
    fn gain(data: &[f64], predictions: &[f64]) -> f64 {
        data.iter().zip(predictions).map(|(d, p)| d * d - (d - p) * (d - p)).sum()
    }

    /// (XᵀX + λ)⁻¹ Xᵀy with X = [[1, 0], [1, 1], [0, 2]], y = [1, 2, 3] and λ = 1: [[3, 1], [1, 6]]⁻¹ [3, 8].
    #[test]
    fn solution_matches_the_closed_form() {
        let rows = [vec![1.0, 0.0], vec![1.0, 1.0], vec![0.0, 2.0]];
        let normals = [normal(&rows, |_| true, |i| [1.0, 2.0, 3.0][i])];
        let (_, weights) = factor(&normals, &[1], 1.0).expect("positive definite");
        assert!((weights[0] - 10.0 / 17.0).abs() < 1e-12 && (weights[1] - 21.0 / 17.0).abs() < 1e-12, "{weights}");
    }

    #[test]
    fn excluding_a_fold_equals_fitting_the_others() {
        let (rows, folds, data) = synthetic(1);
        let all = normals(&rows, &folds, &data);
        let [_, others @ ..] = all.as_slice() else { unreachable!() };
        let [(_, a), (_, b)] =
            [(&all[..], 0), (others, FOLDS)].map(|(n, out)| factor(n, &[out], 10.0).expect("solved"));
        assert!((a - b).amax() < 1e-12);
    }

    #[test]
    fn noise_gets_the_largest_penalty_and_a_strong_signal_the_smallest() {
        let (mut strongest, mut weakest) = (0, 0);
        for seed in 0..20 {
            let (rows, folds, noise) = synthetic(seed);
            let signal: Vec<f64> = rows.iter().zip(&noise).map(|(row, n)| 30.0 * row.iter().sum::<f64>() + n).collect();
            let strength = |data: &[f64]| strengths(&normals(&rows, &folds, data), &STRENGTHS).1;
            strongest += usize::from(strength(&noise).is_none_or(|s| s == STRENGTHS[0]));
            weakest += usize::from(strength(&signal).is_some_and(|s| s < 1.0));
        }
        assert!(strongest >= 16 && weakest == 20, "{strongest} {weakest}");
    }

    #[test]
    fn noise_is_not_predicted() {
        let gains = (0..100).map(|seed| {
            let (rows, folds, noise) = synthetic(seed);
            gain(&noise, &fit(&rows, &folds, &STRENGTHS, |i, _| noise[i]).held_out)
        });
        let mean = gains.sum::<f64>() / 100.0;
        assert!(mean <= 0.0, "{mean}");
    }

    #[test]
    fn signal_is_predicted_out_of_sample() {
        let (rows, folds, noise) = synthetic(7);
        let data: Vec<f64> = rows.iter().zip(&noise).map(|(row, n)| row[3] + n).collect();
        let gain = gain(&data, &fit(&rows, &folds, &STRENGTHS, |i, _| data[i]).held_out);
        let signal: f64 = rows.iter().map(|row| row[3] * row[3]).sum();
        assert!(gain > 0.8 * signal && gain < 1.2 * signal, "{gain} of {signal}");
    }

    /// Binary outcomes with log-odds 1.5 x, as for the echo rate.
    #[test]
    fn working_responses_converge_to_the_maximum_likelihood_log_odds() {
        let mut rng = generator(3, &[]);
        let rows: Vec<Vec<f64>> = (0..4000).map(|_| vec![normal_number(&mut rng)]).collect();
        let probability = |x: f64| 1.0 / (1.0 + libm::exp(-x));
        let yes: Vec<f64> =
            rows.iter().map(|r| f64::from(u8::from(rng.random::<f64>() < probability(1.5 * r[0])))).collect();
        let folds: Vec<usize> = (0..rows.len()).map(|i| i % FOLDS).collect();
        let response = |i: usize, eta: f64| eta + 2.0 * (yes[i] - probability(2.0 * eta));
        let found = 2.0 * fit(&rows, &folds, &STRENGTHS, response).weights[0];
        assert!((found - 1.5).abs() < 0.1, "{found}");
    }
}
