//! Intraclass correlation (Fisher 1925): how much of the random variation is shared within a group, such as all readings at
//! one place.

use std::collections::BTreeMap;

/// The residual of a row, with its group and its standard deviation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deviation<G> {
    /// The group.
    pub group: G,
    /// The run: rows of one run may agree for reasons other than their group, such as following each other.
    pub run: usize,
    /// The residual, with mean zero.
    pub residual: f64,
    /// Standard deviation of the residual.
    pub standard_deviation: f64,
}

/// Returns the fraction of the variance that rows of one group share, from pairs of rows in different runs; zero if there
/// are no such pairs. For independent residuals it lies within a few hundredths of zero.
pub fn correlation<G: Ord + Copy>(rows: &[Deviation<G>]) -> f64 {
    let mut by_run: BTreeMap<(G, usize), [f64; 2]> = BTreeMap::new();
    for row in rows {
        let sums = by_run.entry((row.group, row.run)).or_default();
        *sums = [sums[0] + row.residual, sums[1] + row.standard_deviation];
    }
    let mut by_group: BTreeMap<G, [f64; 2]> = BTreeMap::new();
    let mut within = [0.0; 2];
    for ((group, _), sums) in &by_run {
        let total = by_group.entry(*group).or_default();
        (0..2).for_each(|i| {
            total[i] += sums[i];
            within[i] += sums[i] * sums[i];
        });
    }
    // The square of a group's sum contains all its pairs, including those within a run.
    let [covariance, variance] =
        [0, 1].map(|i| by_group.values().map(|sums| sums[i] * sums[i]).sum::<f64>() - within[i]);
    if variance > 0.0 { (covariance / variance).clamp(0.0, 1.0) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(residual: impl Fn(usize, usize) -> f64) -> Vec<Deviation<usize>> {
        let all = (0..40).flat_map(|run| (0..25).map(move |group| (run, group)));
        all.map(|(run, group)| Deviation { group, run, residual: residual(run, group), standard_deviation: 1.0 })
            .collect()
    }

    /// Plus or minus one, pseudo-random.
    fn sign(number: usize) -> f64 {
        if ((number * 2_654_435_761) >> 7).is_multiple_of(2) { 1.0 } else { -1.0 }
    }

    #[test]
    fn variation_shared_by_a_group_is_its_correlation() {
        assert!((correlation(&rows(|_, group| sign(group))) - 1.0).abs() < 1e-9);
        assert!(correlation(&rows(|run, group| sign(1000 * run + group))) < 0.05);
        let half = |run: usize, group: usize| 0.5f64.sqrt() * (sign(group) + sign(1000 * run + group));
        assert!((correlation(&rows(half)) - 0.5).abs() < 0.1, "{}", correlation(&rows(half)));
    }

    #[test]
    fn agreement_within_a_run_does_not_count() {
        let mut rows = rows(|run, group| sign(1000 * run + group));
        let copies: Vec<Deviation<usize>> = rows.clone();
        rows.extend(copies);
        assert!(correlation(&rows) < 0.05, "every row twice in its run");
        assert_eq!(correlation(&rows[..1]), 0.0);
    }
}
