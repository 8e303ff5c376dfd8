//! Maximises a sum of log-likelihoods within bounds: the method of Berndt, Hall, Hall and Hausman (1974), which takes
//! the curvature from the scores themselves.

use nalgebra::{DMatrix, DVector};

/// A number to be fitted, within what is possible.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Least value.
    pub low: f64,
    /// Largest value.
    pub high: f64,
    /// A change that would be large: derivatives are taken over a share of it.
    pub scale: f64,
}

impl Bounds {
    /// Bounds whose distance is a large change.
    pub const fn new(low: f64, high: f64) -> Self {
        Bounds { low, high, scale: high - low }
    }
}

/// A point, and what the terms are there.
#[derive(Clone, Debug)]
pub struct Point {
    /// Where it lies.
    pub at: Vec<f64>,
    /// The log-likelihood of each term there.
    pub terms: Vec<f64>,
}

/// A maximum, and what is known of its surroundings.
#[derive(Clone, Debug)]
pub struct Maximum {
    /// Where it lies.
    pub at: Vec<f64>,
    /// The log-likelihood of all terms there.
    pub value: f64,
    /// The score of each term there, by parameter, per unit of the bounds' scale.
    pub scores: Vec<Vec<f64>>,
}

/// Derivatives are taken over this share of the bounds' scale: small against what is plausible, large against rounding.
const DIFFERENCE: f64 = 0.004;
/// Keeps the curvature invertible: a weak prior of one scale's standard deviation about the present point, in squared
/// scores.
const RIDGE: f64 = 1.0;
/// A step that does not climb is shortened, and one that does is lengthened, up to this many times: to a five-hundredth
/// or to the two-hundred-fold, beyond which the quadratic model says nothing.
const LENGTHS: usize = 6;
const SHORTER: f64 = 0.35;
const LONGER: f64 = 2.5;

/// Climbs from `start` until a round gains less than `enough`, for `rounds` at most. `terms` gives the log-likelihood
/// of each term at a point.
pub fn climb(
    bounds: &[Bounds],
    start: &[f64],
    rounds: usize,
    enough: f64,
    terms: impl Fn(&[f64]) -> Vec<f64>,
) -> Point {
    climb_on(bounds, Point::new(start, &terms), rounds, enough, terms)
}

/// Climbs on from where another climb ended.
pub fn climb_on(
    bounds: &[Bounds],
    from: Point,
    rounds: usize,
    enough: f64,
    terms: impl Fn(&[f64]) -> Vec<f64>,
) -> Point {
    let mut here = from;
    for _ in 0..rounds {
        let before = here.value();
        let scores = score(bounds, &here, &terms);
        let direction = step(&gradient(&scores, |_| true), &curvature(&scores, |_| true), &here.at, bounds);
        let best = line_search(before, |length| along(bounds, &here.at, &direction, length, &terms));
        let gain = best.as_ref().map_or(0.0, |best| best.value() - before);
        here = best.unwrap_or(here);
        if gain < enough {
            break;
        }
    }
    here
}

/// A step of one parameter alone, of the two that promise most, if one gains `enough`. Where all terms pull alike, as those of
/// a share and of the place at which they lie, their scores do not tell how far to go in other directions, and a climb ends
/// on the way.
pub fn step_of_one(
    bounds: &[Bounds],
    from: &Maximum,
    enough: f64,
    terms: impl Fn(&[f64]) -> Vec<f64>,
) -> Option<Point> {
    let Maximum { at, value: before, scores } = from;
    let (gradient, curvature) = (gradient(scores, |_| true), curvature(scores, |_| true));
    let promised = |i: &usize| gradient[*i] * gradient[*i] / curvature[(*i, *i)];
    let mut order: Vec<usize> = (0..at.len()).collect();
    order.sort_by(|a, b| promised(b).total_cmp(&promised(a)));
    order.into_iter().take(2).filter(|i| promised(i) > enough).find_map(|i| {
        let direction: Vec<f64> =
            (0..at.len()).map(|j| if i == j { gradient[i] / curvature[(i, i)] } else { 0.0 }).collect();
        let best = line_search(*before, |length| along(bounds, at, &direction, length, &terms));
        best.filter(|best| best.value() - before >= enough)
    })
}

impl Point {
    /// A point by its parameters.
    pub fn new(at: &[f64], terms: impl Fn(&[f64]) -> Vec<f64>) -> Self {
        Point { at: at.to_vec(), terms: terms(at) }
    }

    /// The value of the sum.
    pub fn value(&self) -> f64 {
        self.terms.iter().sum()
    }

    /// The same as a maximum.
    pub fn scored(self, bounds: &[Bounds], terms: impl Fn(&[f64]) -> Vec<f64>) -> Maximum {
        Maximum { value: self.value(), scores: score(bounds, &self, &terms), at: self.at }
    }
}

impl Maximum {
    /// Logarithm of the integral over all points of the exponential of the sum, relative to its maximum, by Laplace's method:
    /// the sum falls off as its scores say, and as a prior of these precisions (one a parameter, in squared inverse units).
    /// A share of the terms, `is_term`, makes up the scores: a prior that is among the terms is given by its precision.
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

    /// Where the maximum would lie without the terms for which `left_out` holds, to first order.
    pub fn without(&self, bounds: &[Bounds], left_out: impl Fn(usize) -> bool) -> Vec<f64> {
        let all = gradient(&self.scores, |_| true);
        let kept = gradient(&self.scores, |i| !left_out(i));
        // The whole gradient vanishes at the maximum, but for how far the climb went, except along what a bound holds: that
        // moves where the kept terms no longer pull it against the bound.
        let is_held = |i: usize| is_held(self.at[i], all[i], &bounds[i]);
        let pull: Vec<f64> = (0..kept.len()).map(|i| if is_held(i) { kept[i] } else { kept[i] - all[i] }).collect();
        let curvature = curvature(&self.scores, |i| !left_out(i));
        moved(bounds, &self.at, &step(&pull, &curvature, &self.at, bounds))
    }
}

/// Whether a parameter is pulled against the bound where it is.
fn is_held(at: f64, pull: f64, bounds: &Bounds) -> bool {
    (at <= bounds.low && pull < 0.0) || (at >= bounds.high && pull > 0.0)
}

fn along(bounds: &[Bounds], at: &[f64], direction: &[f64], length: f64, terms: &impl Fn(&[f64]) -> Vec<f64>) -> Point {
    Point::new(&moved(bounds, at, &direction.iter().map(|d| d * length).collect::<Vec<f64>>()), terms)
}

/// The best of a few lengths, if any climbs.
fn line_search(before: f64, along: impl Fn(f64) -> Point) -> Option<Point> {
    let mut length = 1.0;
    let mut best = along(length);
    if best.value() > before {
        for _ in 0..LENGTHS {
            length *= LONGER;
            let further = along(length);
            if further.value() <= best.value() {
                break;
            }
            best = further;
        }
        return Some(best);
    }
    for _ in 0..LENGTHS {
        length *= SHORTER;
        best = along(length);
        if best.value() > before {
            return Some(best);
        }
    }
    None
}

/// The sum of the scores of the terms that are kept.
fn gradient(scores: &[Vec<f64>], kept: impl Fn(usize) -> bool) -> Vec<f64> {
    let mut sum = vec![0.0; scores.first().map_or(0, Vec::len)];
    for (_, score) in scores.iter().enumerate().filter(|(i, _)| kept(*i)) {
        sum.iter_mut().zip(score).for_each(|(sum, s)| *sum += s);
    }
    sum
}

/// The step to where the slope vanishes, to first order.
fn step(gradient: &[f64], curvature: &DMatrix<f64>, at: &[f64], bounds: &[Bounds]) -> Vec<f64> {
    let p = at.len();
    // A parameter that a bound holds stays out of the step.
    let free: Vec<usize> = (0..p).filter(|i| !is_held(at[*i], gradient[*i], &bounds[*i])).collect();
    let matrix = DMatrix::from_fn(free.len(), free.len(), |r, c| curvature[(free[r], free[c])]);
    let pull = DVector::from_iterator(free.len(), free.iter().map(|i| gradient[*i]));
    let mut step = vec![0.0; p];
    if let Some(solved) = matrix.cholesky().map(|c| c.solve(&pull)) {
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
        let mut beside = at.clone();
        beside[i] += h * b.scale;
        let there = terms(&beside);
        for (s, (a, b)) in scores.iter_mut().zip(there.iter().zip(here)) {
            s[i] = (a - b) / h;
        }
    }
    scores
}

fn moved(bounds: &[Bounds], at: &[f64], step: &[f64]) -> Vec<f64> {
    let one = |((a, s), b): ((&f64, &f64), &Bounds)| (a + s * b.scale).clamp(b.low, b.high);
    at.iter().zip(step).zip(bounds).map(one).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const WIDE: Bounds = Bounds::new(-10.0, 10.0);

    /// Log-likelihood of values under a normal law of unknown mean and of deviation one.
    fn normal(values: &[f64]) -> impl Fn(&[f64]) -> Vec<f64> {
        move |at| values.iter().map(|v| -0.5 * (v - at[0]) * (v - at[0])).collect()
    }

    #[test]
    fn the_mean_is_the_most_likely_middle() {
        let values: Vec<f64> = (0..50).map(|i| 2.0 + 0.05 * (f64::from(i) - 24.5)).collect();
        let found = climb(&[WIDE], &[-5.0], 50, 1e-9, normal(&values));
        assert!((found.at[0] - 2.0).abs() < 0.05, "{:?}", found.at);
    }

    #[test]
    fn a_bound_holds() {
        let bounds = [Bounds::new(-10.0, 1.0)];
        let found = climb(&bounds, &[0.0], 50, 1e-9, normal(&[2.0, 3.0, 4.0]));
        assert_eq!(found.at, [1.0]);
    }

    /// Points of a plane whose coordinates deviate by one about (2, −3), and hang together not at all.
    fn points() -> Vec<[f64; 2]> {
        [[3.0, -2.0], [3.0, -4.0], [1.0, -2.0], [1.0, -4.0]].repeat(10)
    }

    #[test]
    fn two_numbers_are_fitted_together_from_any_start() {
        let points = points();
        // Sum and difference of the two are what the terms depend on: a ridge across both.
        let terms = |at: &[f64]| -> Vec<f64> {
            let off = |p: &[f64; 2]| [at[0] + at[1] - p[0], at[0] - at[1] - p[1]];
            points.iter().map(off).map(|[a, b]| -0.5 * (a * a + b * b)).collect()
        };
        for start in [[0.0, 0.0], [-10.0, 10.0], [9.0, -9.0]] {
            let found = climb(&[WIDE; 2], &start, 50, 1e-9, terms);
            // One-sided differences are off by half of what they reach over.
            let off = [found.at[0] + 0.5, found.at[1] - 2.5].map(f64::abs);
            assert!(off.iter().all(|off| *off < 0.05), "{:?}", found.at);
        }
    }

    #[test]
    fn scores_and_value_are_those_of_the_maximum() {
        let terms = normal(&[1.0, 3.0]);
        let found = climb(&[WIDE], &[2.0], 1, f64::INFINITY, &terms).scored(&[WIDE], terms);
        assert!((found.value + 1.0).abs() < 0.01, "{}", found.value);
        // The slopes are −1 and 1, per the bounds' scale of 20.
        for (score, slope) in found.scores.iter().zip([-20.0, 20.0]) {
            assert!((score[0] - slope).abs() < 2.0, "{:?}", found.scores);
        }
    }

    #[test]
    fn it_ends_where_a_round_gains_less_than_asked_for() {
        let values: Vec<f64> = (0..50).map(|i| 2.0 + 0.05 * (f64::from(i) - 24.5)).collect();
        let calls = |rounds, enough| {
            let calls = std::cell::Cell::new(0);
            let counted = |at: &[f64]| {
                calls.set(calls.get() + 1);
                normal(&values)(at)
            };
            climb(&[WIDE], &[-5.0], rounds, enough, counted);
            calls.get()
        };
        assert!(calls(50, 1e6) < calls(50, 1e-9));
        assert_eq!(calls(1, 1e-9), calls(50, 1e6), "one round");
        assert_eq!(calls(0, 1e-9), 1, "here");
    }

    #[test]
    fn a_number_at_its_bound_does_not_hold_up_the_others() {
        let points = points();
        let terms = |at: &[f64]| -> Vec<f64> {
            let off = |p: &[f64; 2]| [at[0] - p[0], at[1] - p[1]];
            points.iter().map(off).map(|[a, b]| -0.5 * (a * a + b * b)).collect()
        };
        let found = climb(&[Bounds::new(-10.0, 0.0), WIDE], &[0.0, 8.0], 50, 1e-9, terms);
        assert_eq!(found.at[0], 0.0);
        assert!((found.at[1] + 3.0).abs() < 0.05, "{:?}", found.at);
    }

    /// A share of the terms is near one value, each just as near: a share and a value to find, and no scatter.
    #[test]
    fn what_pulls_in_one_direction_is_followed_to_the_end() {
        let terms = |at: &[f64]| -> Vec<f64> {
            let near = at[0] * libm::exp(-0.5 * (at[1] - 60.0) * (at[1] - 60.0));
            let term =
                |i: usize| libm::log(if i.is_multiple_of(5) { near + (1.0 - at[0]) * 1e-5 } else { 1.0 - at[0] });
            (0..500).map(term).collect()
        };
        let bounds = [Bounds::new(0.0, 0.6), Bounds { low: 5.0, high: 80.0, scale: 1.5 }];
        let mut found = climb(&bounds, &[0.05, 59.0], 50, 0.1, terms).scored(&bounds, terms);
        while let Some(further) = step_of_one(&bounds, &found, 0.1, terms) {
            found = climb_on(&bounds, further, 50, 0.1, terms).scored(&bounds, terms);
        }
        assert!((found.at[0] - 0.2).abs() < 0.02 && (found.at[1] - 60.0).abs() < 0.1, "{:?}", found.at);
    }

    #[test]
    fn leaving_nothing_out_leaves_the_maximum_where_it_is() {
        let terms = normal(&[1.0, 3.0]);
        let found = climb(&[WIDE], &[0.0], 50, 1e-9, &terms).scored(&[WIDE], terms);
        assert_eq!(found.without(&[WIDE], |_| false), found.at);
    }

    #[test]
    fn leaving_terms_out_moves_the_maximum_away_from_them() {
        // Of variance one about their mean of 2, as the law has it, so that a step to first order is exact.
        let values: Vec<f64> = (0..40).map(|i| if i < 20 { 1.0 } else { 3.0 }).collect();
        let terms = normal(&values);
        let found = climb(&[WIDE], &[0.0], 50, 1e-9, &terms).scored(&[WIDE], terms);
        let without = found.without(&[WIDE], |i| i < 10)[0];
        // What is kept: ten ones and twenty threes. One-sided differences are off by half of what they reach over.
        let most = 0.5 * DIFFERENCE * (WIDE.high - WIDE.low);
        assert!((without - 70.0 / 30.0).abs() < most, "{} {without}", found.at[0]);
    }

    /// All terms pull the first number against its bound, those of one half less, and hang it together with the second.
    #[test]
    fn a_number_that_a_bound_holds_stays_there_whatever_is_left_out() {
        let terms = |at: &[f64]| -> Vec<f64> {
            let middle = |i: usize| if i.is_multiple_of(2) { -4.0 } else { -6.0 };
            let off = |i| [at[0] + 0.5 * at[1] - middle(i), at[1]];
            (0..40).map(off).map(|[a, b]| -0.5 * (a * a + b * b)).collect()
        };
        let bounds = [Bounds::new(0.0, 10.0), WIDE];
        let found = climb(&bounds, &[0.0, -2.0], 50, 1e-9, terms).scored(&bounds, terms);
        assert_eq!(found.at[0], 0.0);
        let [first, second] = found.without(&bounds, |i| i % 4 == 1)[..] else { unreachable!("two numbers") };
        assert_eq!(first, 0.0);
        // Ten scores of -10 are left out, and thirty of ±10 kept: a thirtieth of the scale of 20, and what one-sided
        // differences add.
        assert!((second - found.at[1]).abs() < 1.0, "{second} {}", found.at[1]);
    }
}
