//! Intraclass correlation (Fisher 1925): how much of a chance belongs to a group, such as all readings at a place.

use std::collections::BTreeMap;

/// What was off at a row, and what is known of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deviation<G> {
    /// The group.
    pub group: G,
    /// The run: two rows of one run may agree for other reasons than their group, such as one after the other.
    pub run: usize,
    /// What was off, of mean zero.
    pub off: f64,
    /// Its standard deviation.
    pub scatter: f64,
}

/// The share of the variance that rows of one group have in common, from pairs of them in different runs; zero where
/// there are no such pairs. What is off by chance alone has a share within a few hundredths of zero, which is none.
pub fn share<G: Ord + Copy>(rows: &[Deviation<G>]) -> f64 {
    let mut of_runs: BTreeMap<(G, usize), [f64; 2]> = BTreeMap::new();
    for row in rows {
        let sums = of_runs.entry((row.group, row.run)).or_default();
        *sums = [sums[0] + row.off, sums[1] + row.scatter];
    }
    let mut of_groups: BTreeMap<G, [f64; 2]> = BTreeMap::new();
    let mut within = [0.0; 2];
    for ((group, _), sums) in &of_runs {
        let all = of_groups.entry(*group).or_default();
        (0..2).for_each(|i| {
            all[i] += sums[i];
            within[i] += sums[i] * sums[i];
        });
    }
    // The square of a group's sum holds all its pairs, those within a run included.
    let [off, scatter] = [0, 1].map(|i| of_groups.values().map(|sums| sums[i] * sums[i]).sum::<f64>() - within[i]);
    if scatter > 0.0 { (off / scatter).clamp(0.0, 1.0) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(off: impl Fn(usize, usize) -> f64) -> Vec<Deviation<usize>> {
        let all = (0..40).flat_map(|run| (0..25).map(move |group| (run, group)));
        all.map(|(run, group)| Deviation { group, run, off: off(run, group), scatter: 1.0 }).collect()
    }

    /// Plus and minus one, as if at random.
    fn sign(number: usize) -> f64 {
        if ((number * 2_654_435_761) >> 7).is_multiple_of(2) { 1.0 } else { -1.0 }
    }

    #[test]
    fn what_a_group_decides_is_its_share() {
        assert!((share(&rows(|_, group| sign(group))) - 1.0).abs() < 1e-9);
        assert!(share(&rows(|run, group| sign(1000 * run + group))) < 0.05);
        let half = |run: usize, group: usize| 0.5f64.sqrt() * (sign(group) + sign(1000 * run + group));
        assert!((share(&rows(half)) - 0.5).abs() < 0.1, "{}", share(&rows(half)));
    }

    #[test]
    fn what_a_run_has_in_common_is_no_groups() {
        let mut rows = rows(|run, group| sign(1000 * run + group));
        let again: Vec<Deviation<usize>> = rows.clone();
        rows.extend(again);
        assert!(share(&rows) < 0.05, "every row twice in its run");
        assert_eq!(share(&rows[..1]), 0.0);
    }
}
