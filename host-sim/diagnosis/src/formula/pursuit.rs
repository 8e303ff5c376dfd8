//! Orthogonal matching pursuit (Pati, Rezaiifar and Krishnaprasad 1993): the term is added that predicts best, and all are
//! refitted. Here prediction is cross-validated, and each term has a penalty.

use nalgebra::{DMatrix, DVector};

use super::library::Term;
use crate::calibration::Calibration;

/// Maximum number of terms of a formula that people can remember.
const MOST_TERMS: usize = 3;
/// Added to the diagonal of the normal equations, so that terms can be solved for that are equal but for rounding.
const SINGULAR: f64 = 1e-9;

/// The residuals that are to be explained.
pub struct Response<'a> {
    /// Logged minus predicted at each row.
    pub values: &'a [f64],
    /// The fold of each row.
    pub folds: &'a [usize],
    /// The simulator's noise.
    pub least_noise: f64,
}

/// A weighted sum of terms.
pub struct Sum {
    /// The indices of its terms among all.
    pub terms: Vec<usize>,
    /// The coefficient of each.
    pub coefficients: Vec<f64>,
    /// Its penalty in nats, see [`penalty`].
    pub penalty: f64,
}

/// Penalty of a fitted coefficient, Akaike's (1974).
const PARAMETER_NATS: f64 = 1.0;

/// Returns the penalty of a term in nats: that of a parameter, and for each factor the logarithm of the number of choices.
fn penalty(term: &Term, factors: usize) -> f64 {
    PARAMETER_NATS + term.factors as f64 * libm::log(factors as f64)
}

/// Returns the sum of terms with the largest gain beyond its penalty, or `None` if no term gains anything.
pub fn pursue(terms: &[Term], response: &Response, calibration: &Calibration) -> Option<Sum> {
    let factors = terms.iter().filter(|term| term.factors == 1).count();
    let mut chosen = Fit { terms: Vec::new(), nats: nats(response.squares(|_, r| r * r), response), penalty: 0.0 };
    let null = chosen.nats;
    while chosen.terms.len() < MOST_TERMS {
        let candidates = (0..terms.len()).filter(|term| !chosen.terms.contains(term));
        let fits = candidates.filter_map(|term| {
            let chosen_terms = [chosen.terms.as_slice(), &[term]].concat();
            let nats = cross_validated(terms, &chosen_terms, response)?;
            Some(Fit { terms: chosen_terms, nats, penalty: chosen.penalty + penalty(&terms[term], factors) })
        });
        // Of terms with equal values the first and simplest is kept.
        let best = fits.reduce(|best, fit| if fit.worth() > best.worth() { fit } else { best })?;
        // A further term has to gain a fraction of the gain so far: less could be model-form error.
        let least = f64::max(calibration.judgement.strong_nats, calibration.further_share * (chosen.worth() - null));
        if best.worth() - chosen.worth() < least {
            break;
        }
        chosen = best;
    }
    if chosen.terms.is_empty() {
        return None;
    }
    let coefficients = Normal::sum(normals(terms, &chosen.terms, response).iter()).solved()?;
    Some(Sum { terms: chosen.terms, coefficients, penalty: chosen.penalty })
}

struct Fit {
    terms: Vec<usize>,
    /// Cross-validated log-likelihood.
    nats: f64,
    penalty: f64,
}

impl Fit {
    fn worth(&self) -> f64 {
        self.nats - self.penalty
    }
}

impl Response<'_> {
    fn squares(&self, square: impl Fn(usize, f64) -> f64) -> f64 {
        self.values.iter().enumerate().map(|(row, r)| square(row, *r)).sum()
    }
}

/// Returns the log-likelihood of a sum of squared errors under a normal distribution with their standard deviation, but at least
/// the simulator's noise.
fn nats(squares: f64, response: &Response) -> f64 {
    let count = response.values.len() as f64;
    let variance = f64::max(response.least_noise * response.least_noise, squares / count);
    -0.5 * (count * libm::log(variance) + squares / variance)
}

fn cross_validated(terms: &[Term], chosen: &[usize], response: &Response) -> Option<f64> {
    let normals = normals(terms, chosen, response);
    let all = Normal::sum(normals.iter());
    let fits = normals.iter().map(|fold| all.without(fold).solved()).collect::<Option<Vec<Vec<f64>>>>()?;
    let squares = response.squares(|row, r| {
        let fit = &fits[response.folds[row]];
        let predicted: f64 = chosen.iter().zip(fit).map(|(term, c)| c * terms[*term].values[row]).sum();
        (r - predicted) * (r - predicted)
    });
    Some(nats(squares, response))
}

/// The normal equations of some rows.
#[derive(Clone)]
struct Normal {
    gram: DMatrix<f64>,
    pull: DVector<f64>,
}

/// Returns the normal equations of each fold.
fn normals(terms: &[Term], chosen: &[usize], response: &Response) -> Vec<Normal> {
    let count = chosen.len();
    let folds = response.folds.iter().max().map_or(0, |most| most + 1);
    let mut normals = vec![Normal { gram: DMatrix::zeros(count, count), pull: DVector::zeros(count) }; folds];
    for (row, fold) in response.folds.iter().enumerate() {
        let Normal { gram, pull } = &mut normals[*fold];
        for (i, one) in chosen.iter().enumerate() {
            let value = terms[*one].values[row];
            pull[i] += value * response.values[row];
            for (j, other) in chosen.iter().enumerate() {
                gram[(i, j)] += value * terms[*other].values[row];
            }
        }
    }
    normals
}

impl Normal {
    fn sum<'a>(normals: impl Iterator<Item = &'a Normal>) -> Normal {
        let add = |sum: Normal, one: Normal| Normal { gram: sum.gram + one.gram, pull: sum.pull + one.pull };
        let none = || Normal { gram: DMatrix::zeros(0, 0), pull: DVector::zeros(0) };
        normals.cloned().reduce(add).unwrap_or_else(none)
    }

    fn without(&self, part: &Normal) -> Normal {
        Normal { gram: &self.gram - &part.gram, pull: &self.pull - &part.pull }
    }

    /// Returns the least-squares coefficients, or `None` if they are not determined.
    fn solved(&self) -> Option<Vec<f64>> {
        let Normal { gram, pull } = self;
        let count = pull.len();
        if (0..count).any(|i| gram[(i, i)] <= 0.0) {
            return None;
        }
        // Terms have different units: the equations are scaled to a diagonal of ones.
        let scale: Vec<f64> = (0..count).map(|i| 1.0 / f64::sqrt(gram[(i, i)])).collect();
        let scaled = DMatrix::from_fn(count, count, |i, j| scale[i] * gram[(i, j)] * scale[j]);
        let scaled = scaled + DMatrix::from_diagonal_element(count, count, SINGULAR);
        let solution = scaled.cholesky()?.solve(&DVector::from_fn(count, |i, _| scale[i] * pull[i]));
        Some((0..count).map(|i| scale[i] * solution[i]).collect())
    }
}

#[cfg(test)]
mod tests {
    use rand::RngExt;
    use rand_distr::StandardNormal;

    use super::*;
    use crate::test_support::CALIBRATION;
    use mindgap_foundations::random::generator;

    const ROWS: usize = 400;
    const FOLDS: usize = 8;

    /// Draws twenty independent terms, and noise of standard deviation one.
    fn made_up(seed: u64) -> (Vec<Term>, Vec<f64>, Vec<usize>) {
        let mut rng = generator(seed, &[]);
        let mut draws = |n: usize| -> Vec<f64> { (0..n).map(|_| rng.sample(StandardNormal)).collect() };
        let term = |index: usize, values| Term { text: format!("t{index}"), units: vec![], factors: 1, values };
        let terms = (0..20).map(|index| term(index, draws(ROWS))).collect();
        let noise = draws(ROWS);
        let folds = (0..ROWS).map(|row| row % FOLDS).collect();
        (terms, noise, folds)
    }

    fn pursued(terms: &[Term], values: &[f64], folds: &[usize]) -> Option<Sum> {
        let response = Response { values, folds, least_noise: 0.1 };
        pursue(terms, &response, &CALIBRATION)
    }

    #[test]
    fn true_terms_are_found_with_their_coefficients() {
        let (terms, noise, folds) = made_up(1);
        let values: Vec<f64> =
            (0..ROWS).map(|row| 2.0 * terms[7].values[row] - terms[3].values[row] + 0.5 * noise[row]).collect();
        let found = pursued(&terms, &values, &folds).expect("a sum");
        assert_eq!(found.terms, [7, 3]);
        // Coefficients have a standard error of 0.5 / √400.
        assert!((found.coefficients[0] - 2.0).abs() < 0.1 && (found.coefficients[1] + 1.0).abs() < 0.1);
        // Two parameters, and two choices out of twenty.
        assert!((found.penalty - 2.0 * (1.0 + libm::log(20.0))).abs() < 1e-9);
    }

    /// The penalty of the choice equals what the best of twenty terms gains by chance.
    #[test]
    fn noise_has_no_formula() {
        let found = (0..100).filter(|seed| {
            let (terms, noise, folds) = made_up(100 + seed);
            pursued(&terms, &noise, &folds).is_some()
        });
        assert!(found.count() <= 1);
    }

    #[test]
    fn simpler_of_two_equal_terms_is_chosen() {
        let (mut terms, noise, folds) = made_up(2);
        terms[9].values = terms[4].values.clone();
        terms[4].factors = 2;
        let values: Vec<f64> = (0..ROWS).map(|row| terms[9].values[row] + noise[row]).collect();
        assert_eq!(pursued(&terms, &values, &folds).expect("a sum").terms, [9]);
    }

    #[test]
    fn zero_term_is_never_chosen() {
        let (mut terms, mut noise, folds) = made_up(3);
        terms.iter_mut().for_each(|term| term.values.fill(0.0));
        let mut rng = generator(4, &[]);
        noise.iter_mut().for_each(|value| *value = 5.0 + rng.random::<f64>());
        assert!(pursued(&terms, &noise, &folds).is_none());
    }
}
