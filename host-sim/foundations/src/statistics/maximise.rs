//! Maximises a sum of log-likelihoods within bounds by the method of Berndt, Hall, Hall and Hausman (1974), which
//! approximates the curvature by the outer product of the scores.

use nalgebra::{DMatrix, DVector};

/// Bounds and characteristic scale of a fitted parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Smallest value.
    pub low: f64,
    /// Largest value.
    pub high: f64,
    /// Characteristic scale; finite-difference steps are a fraction of it.
    pub scale: f64,
}

impl Bounds {
    /// Returns bounds with their distance as characteristic scale.
    pub const fn new(low: f64, high: f64) -> Self {
        Bounds { low, high, scale: high - low }
    }
}

/// A point in parameter space and the log-likelihood terms there.
#[derive(Clone, Debug)]
pub struct Point {
    /// Parameter values.
    pub at: Vec<f64>,
    /// Log-likelihood of each term.
    pub terms: Vec<f64>,
}

/// A maximum and the scores there.
#[derive(Clone, Debug)]
pub struct Maximum {
    /// Parameter values.
    pub at: Vec<f64>,
    /// Total log-likelihood.
    pub value: f64,
    /// Score of each term by parameter, per characteristic scale.
    pub scores: Vec<Vec<f64>>,
}

/// Finite-difference step as a fraction of the characteristic scale: small against plausible values, large against rounding.
const DIFFERENCE: f64 = 0.004;
/// Keeps the curvature invertible: a weak prior about the current point with a standard deviation of one characteristic
/// scale, in squared scores.
const RIDGE: f64 = 1.0;
/// A step that does not climb is shortened, and one that does is lengthened, up to this many times: to about a five-hundredth
/// or two hundred times its length, where the quadratic model no longer holds.
const MAX_LENGTH_CHANGES: usize = 6;
const SHORTEN: f64 = 0.35;
const LENGTHEN: f64 = 2.5;

/// Climbs from `start` until an iteration gains less than `tolerance`, for at most `max_iterations`. `terms` returns the
/// log-likelihood of each term at a point.
pub fn climb(
    bounds: &[Bounds],
    start: &[f64],
    max_iterations: usize,
    tolerance: f64,
    terms: impl Fn(&[f64]) -> Vec<f64>,
) -> Point {
    climb_from(bounds, Point::new(start, &terms), max_iterations, tolerance, terms)
}

/// Climbs on from the end of another climb; see [`climb`].
pub fn climb_from(
    bounds: &[Bounds],
    from: Point,
    max_iterations: usize,
    tolerance: f64,
    terms: impl Fn(&[f64]) -> Vec<f64>,
) -> Point {
    let mut here = from;
    for _ in 0..max_iterations {
        let before = here.value();
        let scores = score(bounds, &here, &terms);
        let direction = step(&gradient(&scores, |_| true), &curvature(&scores, |_| true), &here.at, bounds);
        let best = line_search(before, |length| along(bounds, &here.at, &direction, length, &terms));
        let gain = best.as_ref().map_or(0.0, |best| best.value() - before);
        here = best.unwrap_or(here);
        if gain < tolerance {
            break;
        }
    }
    here
}

/// Tries a step of a single parameter, for the two with the largest expected gain, and returns the first that gains
/// `tolerance`. Where the scores of all terms are collinear, as for an outlier fraction and the location of the outliers,
/// they do not determine how far to go in other directions and [`climb`] stops early.
pub fn single_parameter_step(
    bounds: &[Bounds],
    from: &Maximum,
    tolerance: f64,
    terms: impl Fn(&[f64]) -> Vec<f64>,
) -> Option<Point> {
    let Maximum { at, value: before, scores } = from;
    let (gradient, curvature) = (gradient(scores, |_| true), curvature(scores, |_| true));
    let expected_gain = |i: &usize| gradient[*i] * gradient[*i] / curvature[(*i, *i)];
    let mut order: Vec<usize> = (0..at.len()).collect();
    order.sort_by(|a, b| expected_gain(b).total_cmp(&expected_gain(a)));
    order.into_iter().take(2).filter(|i| expected_gain(i) > tolerance).find_map(|i| {
        let direction: Vec<f64> =
            (0..at.len()).map(|j| if i == j { gradient[i] / curvature[(i, i)] } else { 0.0 }).collect();
        let best = line_search(*before, |length| along(bounds, at, &direction, length, &terms));
        best.filter(|best| best.value() - before >= tolerance)
    })
}

impl Point {
    /// Evaluates the terms at a point.
    pub fn new(at: &[f64], terms: impl Fn(&[f64]) -> Vec<f64>) -> Self {
        Point { at: at.to_vec(), terms: terms(at) }
    }

    /// Returns the total log-likelihood.
    pub fn value(&self) -> f64 {
        self.terms.iter().sum()
    }

    /// Evaluates the scores at this point.
    pub fn into_maximum(self, bounds: &[Bounds], terms: impl Fn(&[f64]) -> Vec<f64>) -> Maximum {
        Maximum { value: self.value(), scores: score(bounds, &self, &terms), at: self.at }
    }
}

impl Maximum {
    /// Returns the logarithm of the integral of the likelihood relative to its maximum, by Laplace's method, with a Gaussian
    /// prior of these `precisions` (one per parameter, in inverse squared units). Only terms for which `is_term` holds contribute
    /// their scores: a prior among the terms is given by its precision instead.
    pub fn log_volume(&self, bounds: &[Bounds], precisions: &[f64], is_term: impl Fn(usize) -> bool) -> f64 {
        let mut curvature = curvature(&self.scores, is_term);
        for (i, (b, precision)) in bounds.iter().zip(precisions).enumerate() {
            curvature[(i, i)] += precision * b.scale * b.scale;
        }
        let scales: f64 = bounds.iter().map(|b| libm::log(b.scale)).sum();
        let log_determinant =
            curvature.cholesky().map_or(0.0, |c| c.l_dirty().diagonal().iter().map(|d| 2.0 * libm::log(*d)).sum());
        0.5 * (bounds.len() as f64 * libm::log(std::f64::consts::TAU) - log_determinant) + scales
    }

    /// Returns where the maximum would lie without the `excluded` terms, to first order.
    pub fn without(&self, bounds: &[Bounds], excluded: impl Fn(usize) -> bool) -> Vec<f64> {
        let all = gradient(&self.scores, |_| true);
        let kept = gradient(&self.scores, |i| !excluded(i));
        // The total gradient vanishes at the maximum, up to the climb's tolerance, except for parameters held at a bound:
        // those move only if the remaining terms no longer push them against it.
        let is_held = |i: usize| is_held(self.at[i], all[i], &bounds[i]);
        let force: Vec<f64> = (0..kept.len()).map(|i| if is_held(i) { kept[i] } else { kept[i] - all[i] }).collect();
        let curvature = curvature(&self.scores, |i| !excluded(i));
        moved(bounds, &self.at, &step(&force, &curvature, &self.at, bounds))
    }
}

/// Returns whether a parameter at a bound is pushed against it.
fn is_held(at: f64, force: f64, bounds: &Bounds) -> bool {
    (at <= bounds.low && force < 0.0) || (at >= bounds.high && force > 0.0)
}

fn along(bounds: &[Bounds], at: &[f64], direction: &[f64], length: f64, terms: &impl Fn(&[f64]) -> Vec<f64>) -> Point {
    Point::new(&moved(bounds, at, &direction.iter().map(|d| d * length).collect::<Vec<f64>>()), terms)
}

/// Returns the best of a few step lengths, if any climbs.
fn line_search(before: f64, along: impl Fn(f64) -> Point) -> Option<Point> {
    let mut length = 1.0;
    let mut best = along(length);
    if best.value() > before {
        for _ in 0..MAX_LENGTH_CHANGES {
            length *= LENGTHEN;
            let further = along(length);
            if further.value() <= best.value() {
                break;
            }
            best = further;
        }
        return Some(best);
    }
    for _ in 0..MAX_LENGTH_CHANGES {
        length *= SHORTEN;
        best = along(length);
        if best.value() > before {
            return Some(best);
        }
    }
    None
}

/// Sums the scores of the kept terms.
fn gradient(scores: &[Vec<f64>], kept: impl Fn(usize) -> bool) -> Vec<f64> {
    let mut sum = vec![0.0; scores.first().map_or(0, Vec::len)];
    for (_, score) in scores.iter().enumerate().filter(|(i, _)| kept(*i)) {
        sum.iter_mut().zip(score).for_each(|(sum, s)| *sum += s);
    }
    sum
}

/// Returns the Newton step, in characteristic scales.
fn step(gradient: &[f64], curvature: &DMatrix<f64>, at: &[f64], bounds: &[Bounds]) -> Vec<f64> {
    let p = at.len();
    // Parameters held at a bound do not move.
    let free: Vec<usize> = (0..p).filter(|i| !is_held(at[*i], gradient[*i], &bounds[*i])).collect();
    let matrix = DMatrix::from_fn(free.len(), free.len(), |r, c| curvature[(free[r], free[c])]);
    let force = DVector::from_iterator(free.len(), free.iter().map(|i| gradient[*i]));
    let mut step = vec![0.0; p];
    if let Some(solved) = matrix.cholesky().map(|c| c.solve(&force)) {
        free.iter().zip(solved.iter()).for_each(|(i, s)| step[*i] = *s);
    }
    step
}

fn curvature(scores: &[Vec<f64>], kept: impl Fn(usize) -> bool) -> DMatrix<f64> {
    let p = scores.first().map_or(0, Vec::len);
    let mut matrix = DMatrix::from_diagonal_element(p, p, RIDGE);
    for (_, s) in scores.iter().enumerate().filter(|(i, _)| kept(*i)) {
        for r in 0..p {
            for c in 0..p {
                matrix[(r, c)] += s[r] * s[c];
            }
        }
    }
    matrix
}

fn score(bounds: &[Bounds], here: &Point, terms: &impl Fn(&[f64]) -> Vec<f64>) -> Vec<Vec<f64>> {
    let Point { at, terms: here } = here;
    let mut scores = vec![vec![0.0; at.len()]; here.len()];
    for (i, b) in bounds.iter().enumerate() {
        let h = if at[i] + DIFFERENCE * b.scale <= b.high { DIFFERENCE } else { -DIFFERENCE };
        let mut shifted = at.clone();
        shifted[i] += h * b.scale;
        let there = terms(&shifted);
        for (s, (a, b)) in scores.iter_mut().zip(there.iter().zip(here)) {
            s[i] = (a - b) / h;
        }
    }
    scores
}

fn moved(bounds: &[Bounds], at: &[f64], step: &[f64]) -> Vec<f64> {
    let shifted = |((a, s), b): ((&f64, &f64), &Bounds)| (a + s * b.scale).clamp(b.low, b.high);
    at.iter().zip(step).zip(bounds).map(shifted).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const WIDE: Bounds = Bounds::new(-10.0, 10.0);

    /// Log-likelihood of values under a normal distribution of unknown mean and unit standard deviation.
    fn normal(values: &[f64]) -> impl Fn(&[f64]) -> Vec<f64> {
        move |at| values.iter().map(|v| -0.5 * (v - at[0]) * (v - at[0])).collect()
    }

    #[test]
    fn mean_of_normal_values_is_found() {
        let values: Vec<f64> = (0..50).map(|i| 2.0 + 0.05 * (f64::from(i) - 24.5)).collect();
        let found = climb(&[WIDE], &[-5.0], 50, 1e-9, normal(&values));
        assert!((found.at[0] - 2.0).abs() < 0.05, "{:?}", found.at);
    }

    #[test]
    fn bounds_are_respected() {
        let bounds = [Bounds::new(-10.0, 1.0)];
        let found = climb(&bounds, &[0.0], 50, 1e-9, normal(&[2.0, 3.0, 4.0]));
        assert_eq!(found.at, [1.0]);
    }

    /// Points about (2, −3) with unit standard deviation and uncorrelated coordinates.
    fn points() -> Vec<[f64; 2]> {
        [[3.0, -2.0], [3.0, -4.0], [1.0, -2.0], [1.0, -4.0]].repeat(10)
    }

    #[test]
    fn correlated_parameters_are_fitted_from_any_start() {
        let points = points();
        // The terms depend on sum and difference of the two parameters.
        let terms = |at: &[f64]| -> Vec<f64> {
            let off = |p: &[f64; 2]| [at[0] + at[1] - p[0], at[0] - at[1] - p[1]];
            points.iter().map(off).map(|[a, b]| -0.5 * (a * a + b * b)).collect()
        };
        for start in [[0.0, 0.0], [-10.0, 10.0], [9.0, -9.0]] {
            let found = climb(&[WIDE; 2], &start, 50, 1e-9, terms);
            // One-sided differences are biased by half their step.
            let off = [found.at[0] + 0.5, found.at[1] - 2.5].map(f64::abs);
            assert!(off.iter().all(|off| *off < 0.05), "{:?}", found.at);
        }
    }

    #[test]
    fn maximum_has_value_and_scores() {
        let terms = normal(&[1.0, 3.0]);
        let found = climb(&[WIDE], &[2.0], 1, f64::INFINITY, &terms).into_maximum(&[WIDE], terms);
        assert!((found.value + 1.0).abs() < 0.01, "{}", found.value);
        // The slopes are −1 and 1, per the bounds' scale of 20.
        for (score, slope) in found.scores.iter().zip([-20.0, 20.0]) {
            assert!((score[0] - slope).abs() < 2.0, "{:?}", found.scores);
        }
    }

    #[test]
    fn climb_stops_when_an_iteration_gains_less_than_the_tolerance() {
        let values: Vec<f64> = (0..50).map(|i| 2.0 + 0.05 * (f64::from(i) - 24.5)).collect();
        let calls = |max_iterations, tolerance| {
            let calls = std::cell::Cell::new(0);
            let counted = |at: &[f64]| {
                calls.set(calls.get() + 1);
                normal(&values)(at)
            };
            climb(&[WIDE], &[-5.0], max_iterations, tolerance, counted);
            calls.get()
        };
        assert!(calls(50, 1e6) < calls(50, 1e-9));
        assert_eq!(calls(1, 1e-9), calls(50, 1e6), "one iteration");
        assert_eq!(calls(0, 1e-9), 1, "start only");
    }

    #[test]
    fn parameter_at_its_bound_does_not_block_the_others() {
        let points = points();
        let terms = |at: &[f64]| -> Vec<f64> {
            let off = |p: &[f64; 2]| [at[0] - p[0], at[1] - p[1]];
            points.iter().map(off).map(|[a, b]| -0.5 * (a * a + b * b)).collect()
        };
        let found = climb(&[Bounds::new(-10.0, 0.0), WIDE], &[0.0, 8.0], 50, 1e-9, terms);
        assert_eq!(found.at[0], 0.0);
        assert!((found.at[1] + 3.0).abs() < 0.05, "{:?}", found.at);
    }

    /// One term in five lies at an unknown location without scatter: fraction and location are to be found.
    #[test]
    fn collinear_scores_are_followed_to_the_maximum() {
        let terms = |at: &[f64]| -> Vec<f64> {
            let near = at[0] * libm::exp(-0.5 * (at[1] - 60.0) * (at[1] - 60.0));
            let term =
                |i: usize| libm::log(if i.is_multiple_of(5) { near + (1.0 - at[0]) * 1e-5 } else { 1.0 - at[0] });
            (0..500).map(term).collect()
        };
        let bounds = [Bounds::new(0.0, 0.6), Bounds { low: 5.0, high: 80.0, scale: 1.5 }];
        let mut found = climb(&bounds, &[0.05, 59.0], 50, 0.1, terms).into_maximum(&bounds, terms);
        while let Some(further) = single_parameter_step(&bounds, &found, 0.1, terms) {
            found = climb_from(&bounds, further, 50, 0.1, terms).into_maximum(&bounds, terms);
        }
        assert!((found.at[0] - 0.2).abs() < 0.02 && (found.at[1] - 60.0).abs() < 0.1, "{:?}", found.at);
    }

    #[test]
    fn excluding_nothing_keeps_the_maximum() {
        let terms = normal(&[1.0, 3.0]);
        let found = climb(&[WIDE], &[0.0], 50, 1e-9, &terms).into_maximum(&[WIDE], terms);
        assert_eq!(found.without(&[WIDE], |_| false), found.at);
    }

    #[test]
    fn excluding_terms_moves_the_maximum_away_from_them() {
        // Unit variance about their mean of 2, as assumed, so that the first-order step is exact.
        let values: Vec<f64> = (0..40).map(|i| if i < 20 { 1.0 } else { 3.0 }).collect();
        let terms = normal(&values);
        let found = climb(&[WIDE], &[0.0], 50, 1e-9, &terms).into_maximum(&[WIDE], terms);
        let without = found.without(&[WIDE], |i| i < 10)[0];
        // Ten ones and twenty threes remain. One-sided differences are biased by half their step.
        let most = 0.5 * DIFFERENCE * (WIDE.high - WIDE.low);
        assert!((without - 70.0 / 30.0).abs() < most, "{} {without}", found.at[0]);
    }

    /// All terms push the first parameter against its bound, half of them less, and couple it to the second.
    #[test]
    fn parameter_held_at_a_bound_stays_there_whatever_is_excluded() {
        let terms = |at: &[f64]| -> Vec<f64> {
            let middle = |i: usize| if i.is_multiple_of(2) { -4.0 } else { -6.0 };
            let off = |i| [at[0] + 0.5 * at[1] - middle(i), at[1]];
            (0..40).map(off).map(|[a, b]| -0.5 * (a * a + b * b)).collect()
        };
        let bounds = [Bounds::new(0.0, 10.0), WIDE];
        let found = climb(&bounds, &[0.0, -2.0], 50, 1e-9, terms).into_maximum(&bounds, terms);
        assert_eq!(found.at[0], 0.0);
        let [first, second] = found.without(&bounds, |i| i % 4 == 1)[..] else { unreachable!("two numbers") };
        assert_eq!(first, 0.0);
        // Ten scores of -10 are excluded and thirty of ±10 remain: a thirtieth of the scale of 20, plus the bias of
        // one-sided differences.
        assert!((second - found.at[1]).abs() < 1.0, "{second} {}", found.at[1]);
    }
}
