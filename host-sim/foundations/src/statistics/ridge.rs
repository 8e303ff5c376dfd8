//! Ridge regression (Hoerl and Kennard 1970) in closed form, its strength chosen by nested cross-validation.
//!
//! All errors of the validation follow from the normal equations of the folds: rows are visited once. The strength with
//! which a fold is predicted is chosen without that fold, so that the gain there is that of rows never looked at.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

/// Most steps from one working response to the next.
pub const MOST_STEPS: usize = 10;
/// The change of a prediction, in noise deviations, that ends them.
pub const SETTLED: f64 = 1e-3;

/// What a regression predicts.
#[derive(Clone, Debug, PartialEq)]
pub struct Ridge {
    /// The prediction of each row from the other folds.
    pub held_out: Vec<f64>,
    /// The weight of each column from all rows; zeros where no fit at all is best.
    pub weights: Vec<f64>,
    /// The ratio of noise variance to prior variance that was chosen; none where no fit at all is best.
    pub strength: Option<f64>,
}

/// The normal equations of some rows.
#[derive(Clone)]
struct Normal {
    gram: DMatrix<f64>,
    pull: DVector<f64>,
}

type Factor = Cholesky<f64, Dyn>;

/// Fits `response(row, prediction)`, the working response of a row where its prediction stands: for a Gaussian
/// likelihood the datum itself, otherwise prediction plus score over the largest curvature, so that every step climbs
/// (Böhning and Lindsay 1988). Responses are in units in which their noise has at most the deviation one. `folds` gives
/// the fold of each row, `tried` the ratios of noise variance to prior variance that are tried; no fit at all is tried besides.
pub fn fit(rows: &[Vec<f64>], folds: &[usize], tried: &[f64], response: impl Fn(usize, f64) -> f64) -> Ridge {
    let count = folds.iter().max().map_or(0, |most| most + 1);
    let normals: Vec<Normal> =
        (0..count).map(|fold| normal(rows, |i| folds[i] == fold, |i| response(i, 0.0))).collect();
    let columns = rows.first().map_or(0, Vec::len);
    let settle = |strength: Option<f64>, left_out: Option<usize>| {
        let factor = strength.and_then(|s| factor(&normals, &[left_out.unwrap_or(count)], s));
        factor.map_or_else(
            || vec![0.0; columns],
            |(factor, start)| settled(rows, |i| Some(folds[i]) != left_out, &response, &factor, start),
        )
    };
    let (nested, strength) = strengths(&normals, tried);
    let without: Vec<Vec<f64>> = nested.iter().enumerate().map(|(fold, s)| settle(*s, Some(fold))).collect();
    let held_out = rows.iter().zip(folds).map(|(row, fold)| predicted(row, &without[*fold])).collect();
    Ridge { held_out, weights: settle(strength, None), strength }
}

/// The prediction of a row.
pub fn predicted(row: &[f64], weights: &[f64]) -> f64 {
    row.iter().zip(weights).map(|(value, weight)| value * weight).sum()
}

/// The best strength for each fold as the others tell it, and the best of all folds.
fn strengths(normals: &[Normal], tried: &[f64]) -> (Vec<Option<f64>>, Option<f64>) {
    let count = normals.len();
    let mut nested = vec![vec![0.0; tried.len()]; count];
    let mut overall = vec![0.0; tried.len()];
    for (place, strength) in tried.iter().enumerate() {
        for one in 0..count {
            if let Some((_, weights)) = factor(normals, &[one], *strength) {
                overall[place] += normals[one].error(&weights);
            }
            for other in 0..one {
                if let Some((_, weights)) = factor(normals, &[one, other], *strength) {
                    nested[one][place] += normals[other].error(&weights);
                    nested[other][place] += normals[one].error(&weights);
                }
            }
        }
    }
    let best = |errors: &Vec<f64>| best(tried, errors);
    (nested.iter().map(best).collect(), best(&overall))
}

/// The strength of least error; none where no fit at all has less.
fn best(tried: &[f64], errors: &[f64]) -> Option<f64> {
    let least = errors.iter().zip(tried).min_by(|a, b| a.0.total_cmp(b.0));
    least.filter(|(error, _)| **error < 0.0).map(|(_, strength)| *strength)
}

/// The penalised normal equations of all folds but some, and their solution.
fn factor(normals: &[Normal], left_out: &[usize], strength: f64) -> Option<(Factor, DVector<f64>)> {
    let mut kept = normals.iter().enumerate().filter(|(fold, _)| !left_out.contains(fold)).map(|(_, normal)| normal);
    let Normal { mut gram, mut pull } = kept.next()?.clone();
    for normal in kept {
        gram += &normal.gram;
        pull += &normal.pull;
    }
    (0..gram.nrows()).for_each(|i| gram[(i, i)] += strength);
    let factor = gram.cholesky()?;
    factor.solve_mut(&mut pull);
    Some((factor, pull))
}

fn settled(
    rows: &[Vec<f64>],
    kept: impl Fn(usize) -> bool,
    response: &impl Fn(usize, f64) -> f64,
    factor: &Factor,
    start: DVector<f64>,
) -> Vec<f64> {
    let mut weights = start;
    let mut predictions = vec![0.0; rows.len()];
    for _ in 0..MOST_STEPS {
        let mut pull = DVector::zeros(weights.len());
        let mut change = 0.0;
        for (i, row) in rows.iter().enumerate().filter(|(i, _)| kept(*i)) {
            let prediction = predicted(row, weights.as_slice());
            change = f64::max(change, (prediction - predictions[i]).abs());
            predictions[i] = prediction;
            let response = response(i, prediction);
            pull.iter_mut().zip(row).for_each(|(pull, value)| *pull += value * response);
        }
        if change < SETTLED {
            break;
        }
        factor.solve_mut(&mut pull);
        weights = pull;
    }
    weights.as_slice().to_vec()
}

fn normal(rows: &[Vec<f64>], kept: impl Fn(usize) -> bool, response: impl Fn(usize) -> f64) -> Normal {
    let columns = rows.first().map_or(0, Vec::len);
    let mut gram = DMatrix::zeros(columns, columns);
    let mut pull = DVector::zeros(columns);
    for (i, row) in rows.iter().enumerate().filter(|(i, _)| kept(*i)) {
        let response = response(i);
        for (c, value) in row.iter().enumerate() {
            pull[c] += value * response;
            // A factorisation reads the lower triangle alone; columns lie side by side.
            let column = &mut gram.as_mut_slice()[c * columns + c..(c + 1) * columns];
            column.iter_mut().zip(&row[c..]).for_each(|(sum, other)| *sum += value * other);
        }
    }
    gram.fill_upper_triangle_with_lower_triangle();
    Normal { gram, pull }
}

impl Normal {
    /// The squared error of these weights less that of none.
    fn error(&self, weights: &DVector<f64>) -> f64 {
        (&self.gram * weights).dot(weights) - 2.0 * self.pull.dot(weights)
    }
}

#[cfg(test)]
mod tests {
    use rand::RngExt;

    use super::*;
    use crate::chance::generator;

    const STRENGTHS: [f64; 7] = [1000.0, 215.0, 46.0, 10.0, 2.15, 0.46, 0.1];
    const FOLDS: usize = 8;
    const ROWS: usize = 400;
    const COLUMNS: usize = 20;

    fn normal_number(rng: &mut impl RngExt) -> f64 {
        (0..12).map(|_| rng.random::<f64>()).sum::<f64>() - 6.0
    }

    /// Rows, their folds, and noise of deviation one.
    fn made_up(seed: u64) -> (Vec<Vec<f64>>, Vec<usize>, Vec<f64>) {
        let mut rng = generator(seed, &[]);
        let rows = (0..ROWS).map(|_| (0..COLUMNS).map(|_| normal_number(&mut rng)).collect()).collect();
        let folds = (0..ROWS).map(|i| i * FOLDS / ROWS).collect();
        let noise = (0..ROWS).map(|_| normal_number(&mut rng)).collect();
        (rows, folds, noise)
    }

    fn normals(rows: &[Vec<f64>], folds: &[usize], data: &[f64]) -> Vec<Normal> {
        (0..FOLDS).map(|fold| normal(rows, |i| folds[i] == fold, |i| data[i])).collect()
    }

    /// By how much squared errors shrink.
    fn gain(data: &[f64], predictions: &[f64]) -> f64 {
        data.iter().zip(predictions).map(|(d, p)| d * d - (d - p) * (d - p)).sum()
    }

    /// (XᵀX + λ)⁻¹ Xᵀy with X = [[1, 0], [1, 1], [0, 2]], y = [1, 2, 3] and λ = 1: [[3, 1], [1, 6]]⁻¹ [3, 8].
    #[test]
    fn the_solution_is_the_textbooks() {
        let rows = [vec![1.0, 0.0], vec![1.0, 1.0], vec![0.0, 2.0]];
        let normals = [normal(&rows, |_| true, |i| [1.0, 2.0, 3.0][i])];
        let (_, weights) = factor(&normals, &[1], 1.0).expect("positive definite");
        assert!((weights[0] - 10.0 / 17.0).abs() < 1e-12 && (weights[1] - 21.0 / 17.0).abs() < 1e-12, "{weights}");
    }

    #[test]
    fn leaving_a_fold_out_is_to_fit_the_others() {
        let (rows, folds, data) = made_up(1);
        let all = normals(&rows, &folds, &data);
        let [_, others @ ..] = all.as_slice() else { unreachable!() };
        let [(_, a), (_, b)] =
            [(&all[..], 0), (others, FOLDS)].map(|(n, out)| factor(n, &[out], 10.0).expect("solved"));
        assert!((a - b).amax() < 1e-12);
    }

    #[test]
    fn noise_is_penalised_most_and_a_strong_signal_least() {
        let (mut strongest, mut weakest) = (0, 0);
        for seed in 0..20 {
            let (rows, folds, noise) = made_up(seed);
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
            let (rows, folds, noise) = made_up(seed);
            gain(&noise, &fit(&rows, &folds, &STRENGTHS, |i, _| noise[i]).held_out)
        });
        let mean = gains.sum::<f64>() / 100.0;
        assert!(mean <= 0.0, "{mean}");
    }

    #[test]
    fn a_signal_is_predicted_on_runs_never_seen() {
        let (rows, folds, noise) = made_up(7);
        let data: Vec<f64> = rows.iter().zip(&noise).map(|(row, n)| row[3] + n).collect();
        let gain = gain(&data, &fit(&rows, &folds, &STRENGTHS, |i, _| data[i]).held_out);
        let there: f64 = rows.iter().map(|row| row[3] * row[3]).sum();
        assert!(gain > 0.8 * there && gain < 1.2 * there, "{gain} of {there}");
    }

    /// Yes or no with log-odds 1.5 x, as the rate of echoes is fitted.
    #[test]
    fn working_responses_lead_to_the_likeliest_log_odds() {
        let mut rng = generator(3, &[]);
        let rows: Vec<Vec<f64>> = (0..4000).map(|_| vec![normal_number(&mut rng)]).collect();
        let chance = |x: f64| 1.0 / (1.0 + libm::exp(-x));
        let yes: Vec<f64> =
            rows.iter().map(|r| f64::from(u8::from(rng.random::<f64>() < chance(1.5 * r[0])))).collect();
        let folds: Vec<usize> = (0..rows.len()).map(|i| i % FOLDS).collect();
        let response = |i: usize, eta: f64| eta + 2.0 * (yes[i] - chance(2.0 * eta));
        let found = 2.0 * fit(&rows, &folds, &STRENGTHS, response).weights[0];
        assert!((found - 1.5).abs() < 0.1, "{found}");
    }
}
