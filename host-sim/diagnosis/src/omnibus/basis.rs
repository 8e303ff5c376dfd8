//! The second-order response surface: a constant, every covariate, its square, and the product of every pair.
//!
//! It is the lowest order at which one covariate can alter what another does (Box and Wilson 1951, On the experimental
//! attainment of optimum conditions). No covariate and no pair is preferred, and no unit matters: covariates and terms
//! are standardised.
//!
//! A polynomial in the place cannot follow what is so at one spot and nowhere else: that is left to `nearby`.

use super::nearby::Spot;

/// Beyond this many standard deviations a covariate counts as this far off: other logs may lie where a polynomial was
/// never fitted.
const FARTHEST: f64 = 3.0;

/// The circumstances of a step or of a reading.
#[derive(Clone, Debug, Default)]
pub struct Circumstances {
    /// Covariates, in the same order everywhere.
    pub covariates: Vec<f64>,
    /// Where in the room what is so there shows in it.
    pub spot: Option<Spot>,
}

/// The terms of a response surface, standardised on the rows that it was made from.
#[derive(Clone, Debug)]
pub struct Basis {
    covariates: Vec<Standard>,
    terms: Vec<Standard>,
}

/// What standardises a number, with the prior standard deviation that it gets.
#[derive(Clone, Copy, Debug)]
struct Standard {
    mean: f64,
    scale: f64,
}

impl Basis {
    /// Standardised on `rows`.
    pub fn of(rows: &[&Circumstances]) -> Self {
        let covariates: Vec<&[f64]> = rows.iter().map(|row| row.covariates.as_slice()).collect();
        let covariates = standards(&covariates, |_| 1.0);
        let standardised: Vec<Vec<f64>> = rows.iter().map(|row| surface(&covariates, &row.covariates)).collect();
        let count = covariates.len();
        // Each order is as likely as any other to carry a gap: the prior variance of an order is shared by its terms.
        let share = |place: usize| if place < 2 * count { count } else { count * (count - 1) / 2 };
        let terms = standards(&standardised, |place| 1.0 / (share(place) as f64).sqrt());
        Basis { covariates, terms }
    }

    /// The terms in these circumstances.
    pub fn at(&self, circumstances: &Circumstances) -> Vec<f64> {
        let surface = surface(&self.covariates, &circumstances.covariates);
        let terms = surface.iter().zip(&self.terms).map(|(term, standard)| standard.of(*term));
        std::iter::once(1.0).chain(terms).collect()
    }
}

impl Standard {
    fn of(&self, value: f64) -> f64 {
        (value - self.mean) * self.scale
    }
}

/// Standardised covariates, their squares, and the products of all pairs.
fn surface(standards: &[Standard], covariates: &[f64]) -> Vec<f64> {
    let z: Vec<f64> =
        standards.iter().zip(covariates).map(|(s, value)| s.of(*value).clamp(-FARTHEST, FARTHEST)).collect();
    let squares = z.iter().map(|z| z * z);
    let products = (0..z.len()).flat_map(|i| (0..i).map(move |j| (i, j))).map(|(i, j)| z[i] * z[j]);
    z.iter().copied().chain(squares).chain(products).collect()
}

/// What gives each column the mean zero and the standard deviation `deviation`; what is constant becomes zero.
fn standards<R: AsRef<[f64]>>(rows: &[R], deviation: impl Fn(usize) -> f64) -> Vec<Standard> {
    let count = rows.len() as f64;
    let column = |place: usize| {
        let mean = rows.iter().map(|row| row.as_ref()[place]).sum::<f64>() / count;
        let variance = rows.iter().map(|row| row.as_ref()[place] - mean).map(|off| off * off).sum::<f64>() / count;
        // A spread within rounding is none.
        let varies = variance > 1e-12 * (1.0 + mean * mean);
        Standard { mean, scale: if varies { deviation(place) / variance.sqrt() } else { 0.0 } }
    };
    (0..rows.first().map_or(0, |row| row.as_ref().len())).map(column).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows() -> Vec<Circumstances> {
        (0..200).map(|i| of([7, 11, 13].map(|m| f64::from(i * m % 31)).to_vec())).collect()
    }

    fn of(covariates: Vec<f64>) -> Circumstances {
        Circumstances { covariates, spot: None }
    }

    fn basis(rows: &[Circumstances]) -> Basis {
        Basis::of(&rows.iter().collect::<Vec<_>>())
    }

    /// The prior covariance of two predictions, which is all that a ridge sees of its basis.
    fn covariance(basis: &Basis, a: &Circumstances, b: &Circumstances) -> f64 {
        basis.at(a).iter().zip(basis.at(b)).map(|(a, b)| a * b).sum()
    }

    #[test]
    fn a_constant_three_covariates_their_squares_and_three_products() {
        assert_eq!(basis(&rows()).at(&of(vec![1.0, 2.0, 3.0])).len(), 1 + 3 + 3 + 3);
    }

    #[test]
    fn every_order_has_the_same_variance() {
        let rows = rows();
        let basis = basis(&rows);
        let terms: Vec<Vec<f64>> = rows.iter().map(|row| basis.at(row)).collect();
        let variance = |places: std::ops::Range<usize>| -> f64 {
            terms.iter().map(|t| t[places.clone()].iter().map(|v| v * v).sum::<f64>()).sum::<f64>() / rows.len() as f64
        };
        for order in [0..1, 1..4, 4..7, 7..10] {
            assert!((variance(order.clone()) - 1.0).abs() < 1e-9, "{order:?}");
        }
    }

    #[test]
    fn neither_the_order_nor_the_unit_of_covariates_matters() {
        let rows = rows();
        let other = |row: &Circumstances| {
            let [a, b, c] = row.covariates[..] else { unreachable!("three covariates") };
            of(vec![-0.01 * c + 5.0, 100.0 * a, b - 3.0])
        };
        let (basis, others) = (basis(&rows), basis(&rows.iter().map(other).collect::<Vec<_>>()));
        for (a, b) in rows.iter().zip(&rows[7..]) {
            let difference = covariance(&basis, a, b) - covariance(&others, &other(a), &other(b));
            assert!(difference.abs() < 1e-9, "{difference}");
        }
    }

    #[test]
    fn what_never_changes_says_nothing() {
        let rows: Vec<Circumstances> = (0..20).map(|i| of(vec![f64::from(i), 4.0])).collect();
        let terms = basis(&rows).at(&of(vec![3.0, 9.0]));
        assert_eq!([terms[2], terms[4], terms[5]], [0.0; 3]);
    }
}
