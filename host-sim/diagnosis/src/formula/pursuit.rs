//! Orthogonal matching pursuit (Pati, Rezaiifar and Krishnaprasad 1993): term after term is added that predicts best, and
//! all are fitted anew; here judged on runs that they were not fitted on, and against what a term costs.

use nalgebra::{DMatrix, DVector};

use super::library::Term;
use crate::calibration::Calibration;

/// A sum of more terms is no formula that anybody would remember.
const MOST_TERMS: usize = 3;
/// Against the diagonal of the normal equations: keeps terms apart that are the same but for rounding.
const SINGULAR: f64 = 1e-9;

/// What is to be explained.
pub struct Response<'a> {
    /// Logged minus predicted at each row.
    pub values: &'a [f64],
    /// The fold of each row.
    pub folds: &'a [usize],
    /// The simulator's own scatter.
    pub least_scatter: f64,
}

/// Terms and their coefficients.
pub struct Sum {
    /// Their places among all terms.
    pub places: Vec<usize>,
    /// One for each.
    pub coefficients: Vec<f64>,
    /// What it costs, nats: see [`price`].
    pub price: f64,
}

/// What a fitted coefficient costs: Akaike's (1974).
const PARAMETER_NATS: f64 = 1.0;

/// What a term costs, nats: a parameter, and the logarithm of how many there are to choose each of its factors from.
fn price(term: &Term, factors: usize) -> f64 {
    PARAMETER_NATS + term.factors as f64 * libm::log(factors as f64)
}

/// The sum of terms that gains most beyond its price; none where no term gains any.
pub fn pursue(terms: &[Term], response: &Response, calibration: &Calibration) -> Option<Sum> {
    let factors = terms.iter().filter(|term| term.factors == 1).count();
    let mut chosen = Fit { places: Vec::new(), nats: nats(response.squares(|_, r| r * r), response), price: 0.0 };
    let nothing = chosen.nats;
    while chosen.places.len() < MOST_TERMS {
        let candidates = (0..terms.len()).filter(|place| !chosen.places.contains(place));
        let fits = candidates.filter_map(|place| {
            let places = [chosen.places.as_slice(), &[place]].concat();
            let nats = held_out(terms, &places, response)?;
            Some(Fit { places, nats, price: chosen.price + price(&terms[place], factors) })
        });
        // Of terms that are the same here the first and simplest stays.
        let best = fits.reduce(|best, fit| if fit.worth() > best.worth() { fit } else { best })?;
        // A further term has to gain a share of what is gained already: less is within reach of a form that is not quite
        // right.
        let least = f64::max(calibration.judgement.strong_nats, calibration.further_share * (chosen.worth() - nothing));
        if best.worth() - chosen.worth() < least {
            break;
        }
        chosen = best;
    }
    if chosen.places.is_empty() {
        return None;
    }
    let coefficients = Normal::sum(normals(terms, &chosen.places, response).iter()).solved()?;
    Some(Sum { places: chosen.places, coefficients, price: chosen.price })
}

struct Fit {
    places: Vec<usize>,
    /// Log-likelihood of rows by fits to other folds.
    nats: f64,
    price: f64,
}

impl Fit {
    fn worth(&self) -> f64 {
        self.nats - self.price
    }
}

impl Response<'_> {
    fn squares(&self, square: impl Fn(usize, f64) -> f64) -> f64 {
        self.values.iter().enumerate().map(|(row, r)| square(row, *r)).sum()
    }
}

/// The log-likelihood of so much squared error under a normal law whose deviation is that of the errors, and never less
/// than the simulator's.
fn nats(squares: f64, response: &Response) -> f64 {
    let count = response.values.len() as f64;
    let variance = f64::max(response.least_scatter * response.least_scatter, squares / count);
    -0.5 * (count * libm::log(variance) + squares / variance)
}

fn held_out(terms: &[Term], places: &[usize], response: &Response) -> Option<f64> {
    let normals = normals(terms, places, response);
    let all = Normal::sum(normals.iter());
    let fits = normals.iter().map(|fold| all.without(fold).solved()).collect::<Option<Vec<Vec<f64>>>>()?;
    let squares = response.squares(|row, r| {
        let fit = &fits[response.folds[row]];
        let predicted: f64 = places.iter().zip(fit).map(|(place, c)| c * terms[*place].values[row]).sum();
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

/// The normal equations of each fold.
fn normals(terms: &[Term], places: &[usize], response: &Response) -> Vec<Normal> {
    let count = places.len();
    let folds = response.folds.iter().max().map_or(0, |most| most + 1);
    let mut normals = vec![Normal { gram: DMatrix::zeros(count, count), pull: DVector::zeros(count) }; folds];
    for (row, fold) in response.folds.iter().enumerate() {
        let Normal { gram, pull } = &mut normals[*fold];
        for (i, one) in places.iter().enumerate() {
            let value = terms[*one].values[row];
            pull[i] += value * response.values[row];
            for (j, other) in places.iter().enumerate() {
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

    /// The coefficients of least squares; none where they are not determined.
    fn solved(&self) -> Option<Vec<f64>> {
        let Normal { gram, pull } = self;
        let count = pull.len();
        if (0..count).any(|i| gram[(i, i)] <= 0.0) {
            return None;
        }
        // Terms have units of their own: the equations are scaled to a diagonal of ones.
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
    use mindgap_foundations::chance::generator;

    const ROWS: usize = 400;
    const FOLDS: usize = 8;

    /// Twenty terms that are drawn independently, and noise of deviation one.
    fn made_up(seed: u64) -> (Vec<Term>, Vec<f64>, Vec<usize>) {
        let mut rng = generator(seed, &[]);
        let mut draws = |n: usize| -> Vec<f64> { (0..n).map(|_| rng.sample(StandardNormal)).collect() };
        let term = |place: usize, values| Term { text: format!("t{place}"), units: vec![], factors: 1, values };
        let terms = (0..20).map(|place| term(place, draws(ROWS))).collect();
        let noise = draws(ROWS);
        let folds = (0..ROWS).map(|row| row % FOLDS).collect();
        (terms, noise, folds)
    }

    fn pursued(terms: &[Term], values: &[f64], folds: &[usize]) -> Option<Sum> {
        let response = Response { values, folds, least_scatter: 0.1 };
        pursue(terms, &response, &CALIBRATION)
    }

    #[test]
    fn the_terms_that_are_there_are_found_with_their_coefficients() {
        let (terms, noise, folds) = made_up(1);
        let values: Vec<f64> =
            (0..ROWS).map(|row| 2.0 * terms[7].values[row] - terms[3].values[row] + 0.5 * noise[row]).collect();
        let found = pursued(&terms, &values, &folds).expect("a sum");
        assert_eq!(found.places, [7, 3]);
        // Coefficients have a standard error of 0.5 / √400.
        assert!((found.coefficients[0] - 2.0).abs() < 0.1 && (found.coefficients[1] + 1.0).abs() < 0.1);
        // Two parameters, and two choices out of twenty.
        assert!((found.price - 2.0 * (1.0 + libm::log(20.0))).abs() < 1e-9);
    }

    /// The best of twenty terms gains what chance gives the best of twenty, which is what its choice costs.
    #[test]
    fn noise_follows_nothing() {
        let found = (0..100).filter(|seed| {
            let (terms, noise, folds) = made_up(100 + seed);
            pursued(&terms, &noise, &folds).is_some()
        });
        assert!(found.count() <= 1);
    }

    #[test]
    fn of_two_terms_that_are_the_same_the_simpler_is_taken() {
        let (mut terms, noise, folds) = made_up(2);
        terms[9].values = terms[4].values.clone();
        terms[4].factors = 2;
        let values: Vec<f64> = (0..ROWS).map(|row| terms[9].values[row] + noise[row]).collect();
        assert_eq!(pursued(&terms, &values, &folds).expect("a sum").places, [9]);
    }

    #[test]
    fn a_term_that_is_nothing_anywhere_is_never_taken() {
        let (mut terms, mut noise, folds) = made_up(3);
        terms.iter_mut().for_each(|term| term.values.fill(0.0));
        let mut rng = generator(4, &[]);
        noise.iter_mut().for_each(|value| *value = 5.0 + rng.random::<f64>());
        assert!(pursued(&terms, &noise, &folds).is_none());
    }
}
