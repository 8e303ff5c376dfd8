//! Groups of robots with similar gaps: k-means on their budgets, with the number of groups chosen by the gap statistic.
//!
//! Budgets are compared by the square roots of their shares (Hellinger distance): two budgets without a common part are
//! always √2 apart.

use rand::RngExt;
use rand_distr::{Distribution, StandardNormal};

use super::tally::Tally;
use mindgap_foundations::random::{Generator, derive, generator};
use mindgap_foundations::statistics::summary::mean;

/// Maximum number of groups.
const MOST: usize = 8;
/// Root-mean-square distance below which budgets count as equal, given the accuracy of the shares.
const ALIKE: f64 = 0.05;
/// Size of the random sample of robots on which the number of groups is chosen.
const SAMPLE: usize = 500;
/// Number of standard errors within which a number of groups counts as equal to the best.
const ERRORS: f64 = 2.0;
/// Number of reference fleets without groups.
const REFERENCES: u64 = 20;
/// Number of restarts of k-means.
const STARTS: u64 = 4;
/// Maximum number of iterations of k-means.
const ROUNDS: usize = 100;

/// A group of robots.
#[derive(Clone, Debug, PartialEq)]
pub struct Group {
    /// Indices of its robots in the tally.
    pub members: Vec<usize>,
    /// Mean share of each part of the budget.
    pub budget: Vec<f64>,
}

type Point = Vec<f64>;

/// Returns the groups, largest first.
pub fn groups(tally: &Tally, seed: u64) -> Vec<Group> {
    let occurring: Vec<usize> =
        (0..tally.parts.len()).filter(|part| tally.budgets.iter().any(|budget| budget[*part] > 0.0)).collect();
    let point = |budget: &Vec<f32>| occurring.iter().map(|part| f64::from(budget[*part]).sqrt()).collect();
    let points: Vec<Point> = tally.budgets.iter().map(point).collect();
    let mut drawn: Vec<usize> = (0..points.len()).collect();
    drawn.sort_by_key(|place| derive(seed, &[2, *place as u64]));
    let sample: Vec<Point> = drawn.iter().take(SAMPLE).map(|place| points[*place].clone()).collect();
    let count = number_of_groups(&sample, seed);
    let (_, of) = divided(&points, count, seed);
    let mut groups: Vec<Group> = (0..count)
        .map(|group| (0..points.len()).filter(|i| of[*i] == group).collect::<Vec<usize>>())
        .filter(|members| !members.is_empty())
        .map(|members| Group { budget: mean_budget(tally, &members), members })
        .collect();
    groups.sort_by_key(|group| (std::cmp::Reverse(group.members.len()), group.members[0]));
    groups
}

fn mean_budget(tally: &Tally, members: &[usize]) -> Vec<f64> {
    let share = |part: usize| mean(members.iter().map(|member| f64::from(tally.budgets[*member][part])));
    (0..tally.parts.len()).map(share).collect()
}

/// Returns the smallest number of groups whose gap statistic is within two standard errors of the best (Tibshirani,
/// Walther and Hastie 2001, Estimating the number of clusters in a data set via the gap statistic), and at most the number
/// at which robots are equal within their groups.
fn number_of_groups(points: &[Point], seed: u64) -> usize {
    let alike = points.len() as f64 * ALIKE * ALIKE;
    let most = MOST.min(points.len() / 2).max(1);
    let loose = (1..most).find(|count| divided(points, *count, seed).0 <= alike).unwrap_or(most);
    let mut rng = generator(seed, &[0]);
    let references: Vec<Vec<Point>> = (0..REFERENCES).map(|_| without_groups(points, &mut rng)).collect();
    let gap = |count: usize| {
        let tightness = |points: &[Point]| libm::log(divided(points, count, seed).0 + alike);
        let expected: Vec<f64> = references.iter().map(|reference| tightness(reference)).collect();
        let middle = mean(expected.iter().copied());
        let variance = mean(expected.iter().map(|e| (e - middle) * (e - middle)));
        (middle - tightness(points), (variance * (1.0 + 1.0 / REFERENCES as f64)).sqrt())
    };
    let gaps: Vec<(f64, f64)> = (1..=loose).map(gap).collect();
    let widest = gaps.iter().copied().max_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or_default();
    gaps.iter().position(|gap| gap.0 >= widest.0 - ERRORS * widest.1).map_or(1, |place| place + 1)
}

/// Returns a reference sample without groups: as many points from a normal distribution with the same mean and covariance.
fn without_groups(points: &[Point], rng: &mut Generator) -> Vec<Point> {
    let count = points.len() as f64;
    let middle: Point = (0..points[0].len()).map(|axis| mean(points.iter().map(|point| point[axis]))).collect();
    let draw = |rng: &mut Generator| {
        let mut drawn = middle.clone();
        for point in points {
            let weight: f64 = StandardNormal.sample(rng);
            for (axis, value) in drawn.iter_mut().enumerate() {
                *value += weight / count.sqrt() * (point[axis] - middle[axis]);
            }
        }
        drawn
    };
    points.iter().map(|_| draw(rng)).collect()
}

/// Returns the best clustering found: the sum of squared distances to the centres, and the group of each point.
fn divided(points: &[Point], groups: usize, seed: u64) -> (f64, Vec<usize>) {
    let starts = if groups == 1 { 1 } else { STARTS };
    let found = (0..starts).map(|start| from_start(points, groups, &mut generator(seed, &[1, groups as u64, start])));
    found.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or_default()
}

/// Runs Lloyd's algorithm from k-means++ centres (Arthur and Vassilvitskii 2007).
fn from_start(points: &[Point], groups: usize, rng: &mut Generator) -> (f64, Vec<usize>) {
    let mut middles = vec![points[rng.random_range(0..points.len())].clone()];
    while middles.len() < groups {
        let weights: Vec<f64> = points.iter().map(|point| nearest(point, &middles).1).collect();
        let mut left = rng.random::<f64>() * weights.iter().sum::<f64>();
        let drawn = weights.iter().position(|weight| {
            left -= weight;
            left < 0.0
        });
        middles.push(points[drawn.unwrap_or(0)].clone());
    }
    let assigned = |middles: &[Point]| points.iter().map(|p| nearest(p, middles)).unzip::<usize, f64, Vec<_>, Vec<_>>();
    let (mut of, mut distances) = assigned(&middles);
    for _ in 0..ROUNDS {
        for (group, middle) in middles.iter_mut().enumerate() {
            let members = || points.iter().zip(&of).filter(|(_, of)| **of == group).map(|(point, _)| point);
            for (axis, value) in middle.iter_mut().enumerate().filter(|_| members().next().is_some()) {
                *value = mean(members().map(|point| point[axis]));
            }
        }
        let (now, closer) = assigned(&middles);
        let is_settled = now == of;
        (of, distances) = (now, closer);
        if is_settled {
            break;
        }
    }
    (distances.iter().sum(), of)
}

/// Returns the nearest centre and its squared distance.
fn nearest(point: &[f64], middles: &[Point]) -> (usize, f64) {
    let distances = middles.iter().map(|middle| point.iter().zip(middle).map(|(a, b)| (a - b) * (a - b)).sum());
    distances.enumerate().min_by(|a: &(usize, f64), b| a.1.total_cmp(&b.1)).unwrap_or((0, 0.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fleet::robot::Robot;
    use mindgap_diagnosis::verdict::Verdict;
    use mindgap_models::effects::CATALOGUE;

    /// Returns robots whose budgets scatter around these, in turn.
    fn fleet(robots: usize, kinds: &[&[(&str, f64)]]) -> Tally {
        let (mut tally, mut rng) = (Tally::new(CATALOGUE), generator(3, &[]));
        for i in 0..robots {
            let shares: Vec<(&str, f64)> = kinds[i % kinds.len()]
                .iter()
                .map(|(id, share)| (*id, share * (1.0 + 0.2 * (rng.random::<f64>() - 0.5))))
                .collect();
            let whole: f64 = shares.iter().map(|(_, share)| share).sum();
            let budget = shares.iter().map(|(id, share)| ((*id).into(), share / whole, [0.0, 1.0])).collect();
            tally.add(i.to_string(), &with(budget));
        }
        tally
    }

    fn with(budget: Vec<(String, f64, [f64; 2])>) -> Robot {
        let (verdict, gap_nats, closed, effects, untestable) = (Verdict::Known, None, None, vec![], vec![]);
        Robot {
            measures: mindgap_built_in_robot::default_robot(),
            verdict,
            runs: 1,
            rows: 1,
            gap_nats,
            closed,
            budget,
            effects,
            untestable,
        }
    }

    fn sizes(tally: &Tally) -> Vec<usize> {
        groups(tally, 1).iter().map(|group| group.members.len()).collect()
    }

    const SLIP: &[(&str, f64)] = &[("slip", 0.7), ("scatter", 0.2), ("unexplained", 0.1)];
    const LATE: &[(&str, f64)] = &[("latency", 0.8), ("scatter", 0.1), ("unexplained", 0.1)];

    #[test]
    fn robots_of_one_kind_are_one_group() {
        for robots in [1, 2, 6, 60] {
            assert_eq!(sizes(&fleet(robots, &[SLIP])), [robots]);
        }
    }

    #[test]
    fn widely_scattered_robots_of_one_distribution_are_one_group() {
        for robots in [10, 40, 200] {
            let mut rng = generator(robots, &[]);
            let mut tally = Tally::new(CATALOGUE);
            for _ in 0..robots {
                let normal: f64 = StandardNormal.sample(&mut rng);
                let share = (0.5 + 0.12 * normal).clamp(0.0, 1.0);
                let budget = vec![("slip".into(), share, [0.0, 1.0]), ("scatter".into(), 1.0 - share, [0.0, 1.0])];
                tally.add("robot".into(), &with(budget));
            }
            assert_eq!(sizes(&tally), [robots as usize]);
        }
    }

    #[test]
    fn robots_of_several_kinds_form_as_many_groups() {
        assert_eq!(sizes(&fleet(6, &[SLIP, LATE, SLIP])), [4, 2]);
        assert_eq!(sizes(&fleet(12, &[SLIP, SLIP, LATE, SLIP, &[], SLIP])), [8, 2, 2]);
        // A fleet larger than the sample has the same groups.
        assert_eq!(sizes(&fleet(3 * SAMPLE, &[SLIP, LATE, &[]])), [SAMPLE; 3]);
    }
}
