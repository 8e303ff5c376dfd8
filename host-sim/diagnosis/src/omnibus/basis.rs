//! The second-order response surface: a constant, every covariate, its square, and the product of every pair.
//!
//! It is the lowest order with interactions between covariates (Box and Wilson 1951, On the experimental attainment of optimum
//! conditions). No covariate and no pair is preferred, and units do not matter: covariates and terms are standardised.
//!
//! A polynomial in the position cannot represent a single spot that differs; that is left to `kernel`.

use super::kernel::Spot;

/// Covariates are clipped at this many standard deviations, since other logs may lie outside the range of the fit.
const FARTHEST: f64 = 3.0;

/// The covariates of a step or of a reading.
#[derive(Clone, Debug, Default)]
pub struct Covariates {
    /// Their values, always in the same order.
    pub values: Vec<f64>,
    /// The place that can affect it, if there is a single one.
    pub spot: Option<Spot>,
}

/// The terms of a response surface, standardised on the rows from which it was made.
#[derive(Clone, Debug)]
pub struct Basis {
    covariates: Vec<Standard>,
    terms: Vec<Standard>,
}

/// A shift and scale that standardise a number, including its prior standard deviation.
#[derive(Clone, Copy, Debug)]
struct Standard {
    mean: f64,
    scale: f64,
}

impl Basis {
    /// Standardises covariates and terms on `rows`.
    pub fn of(rows: &[&Covariates]) -> Self {
        let covariates: Vec<&[f64]> = rows.iter().map(|row| row.values.as_slice()).collect();
        let covariates = standards(&covariates, |_| 1.0);
        let standardised: Vec<Vec<f64>> = rows.iter().map(|row| surface(&covariates, &row.values)).collect();
        let count = covariates.len();
        // Each order is equally likely to carry a gap, so its terms share the prior variance of one.
        let terms_of_order = |index: usize| if index < 2 * count { count } else { count * (count - 1) / 2 };
        let terms = standards(&standardised, |index| 1.0 / (terms_of_order(index) as f64).sqrt());
        Basis { covariates, terms }
    }

    /// Returns the terms for these covariates.
    pub fn at(&self, covariates: &Covariates) -> Vec<f64> {
        let surface = surface(&self.covariates, &covariates.values);
        let terms = surface.iter().zip(&self.terms).map(|(term, standard)| standard.of(*term));
        std::iter::once(1.0).chain(terms).collect()
    }
}

impl Standard {
    fn of(&self, value: f64) -> f64 {
        (value - self.mean) * self.scale
    }
}

/// Returns standardised covariates, their squares, and the products of all pairs.
fn surface(standards: &[Standard], covariates: &[f64]) -> Vec<f64> {
    let z: Vec<f64> =
        standards.iter().zip(covariates).map(|(s, value)| s.of(*value).clamp(-FARTHEST, FARTHEST)).collect();
    let squares = z.iter().map(|z| z * z);
    let products = (0..z.len()).flat_map(|i| (0..i).map(move |j| (i, j))).map(|(i, j)| z[i] * z[j]);
    z.iter().copied().chain(squares).chain(products).collect()
}

/// Returns what gives each column the mean zero and the standard deviation `deviation`. Constant columns become zero.
fn standards<R: AsRef<[f64]>>(rows: &[R], deviation: impl Fn(usize) -> f64) -> Vec<Standard> {
    let count = rows.len() as f64;
    let column = |index: usize| {
        let mean = rows.iter().map(|row| row.as_ref()[index]).sum::<f64>() / count;
        let variance = rows.iter().map(|row| row.as_ref()[index] - mean).map(|off| off * off).sum::<f64>() / count;
        // A variance within rounding is zero.
        let varies = variance > 1e-12 * (1.0 + mean * mean);
        Standard { mean, scale: if varies { deviation(index) / variance.sqrt() } else { 0.0 } }
    };
    (0..rows.first().map_or(0, |row| row.as_ref().len())).map(column).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows() -> Vec<Covariates> {
        (0..200).map(|i| of([7, 11, 13].map(|m| f64::from(i * m % 31)).to_vec())).collect()
    }

    fn of(values: Vec<f64>) -> Covariates {
        Covariates { values, spot: None }
    }

    fn basis(rows: &[Covariates]) -> Basis {
        Basis::of(&rows.iter().collect::<Vec<_>>())
    }

    /// Returns the prior covariance of two predictions, on which alone a ridge regression depends.
    fn covariance(basis: &Basis, a: &Covariates, b: &Covariates) -> f64 {
        basis.at(a).iter().zip(basis.at(b)).map(|(a, b)| a * b).sum()
    }

    #[test]
    fn three_covariates_have_ten_terms() {
        assert_eq!(basis(&rows()).at(&of(vec![1.0, 2.0, 3.0])).len(), 1 + 3 + 3 + 3);
    }

    #[test]
    fn every_order_has_the_same_variance() {
        let rows = rows();
        let basis = basis(&rows);
        let terms: Vec<Vec<f64>> = rows.iter().map(|row| basis.at(row)).collect();
        let variance = |terms_of: std::ops::Range<usize>| -> f64 {
            terms.iter().map(|t| t[terms_of.clone()].iter().map(|v| v * v).sum::<f64>()).sum::<f64>()
                / rows.len() as f64
        };
        for order in [0..1, 1..4, 4..7, 7..10] {
            assert!((variance(order.clone()) - 1.0).abs() < 1e-9, "{order:?}");
        }
    }

    #[test]
    fn order_and_unit_of_covariates_do_not_matter() {
        let rows = rows();
        let other = |row: &Covariates| {
            let [a, b, c] = row.values[..] else { unreachable!("three covariates") };
            of(vec![-0.01 * c + 5.0, 100.0 * a, b - 3.0])
        };
        let (basis, others) = (basis(&rows), basis(&rows.iter().map(other).collect::<Vec<_>>()));
        for (a, b) in rows.iter().zip(&rows[7..]) {
            let difference = covariance(&basis, a, b) - covariance(&others, &other(a), &other(b));
            assert!(difference.abs() < 1e-9, "{difference}");
        }
    }

    #[test]
    fn constant_covariates_have_no_terms() {
        let rows: Vec<Covariates> = (0..20).map(|i| of(vec![f64::from(i), 4.0])).collect();
        let terms = basis(&rows).at(&of(vec![3.0, 9.0]));
        assert_eq!([terms[2], terms[4], terms[5]], [0.0; 3]);
    }
}
