//! The runs of logs as they are drawn, with the rows that a defect concerns.

use std::collections::BTreeMap;

use glam::DVec2;

use mindgap_diagnosis::survey::Survey;
use mindgap_logs::{Logs, Run};

/// What marked rows are called in legends.
pub const MARKED: &str = "row with a defect";
/// A defect of a larger share of all rows is not marked: the marks would cover everything else.
const MOSTLY: f64 = 0.5;
/// Positions that differ by less are the same, cm.
const SAME_CM: f64 = 1e-6;

/// A run as it is drawn.
pub struct Drawn<'a> {
    /// The corrected run, or the logged one if it is excluded.
    pub run: &'a Run,
    /// Whether the whole run is excluded.
    pub is_excluded: bool,
    /// The defects with the rows that they concern, as ranges of indices.
    pub marked: Vec<(&'static str, [usize; 2])>,
    logged: &'a Run,
}

impl<'a> Drawn<'a> {
    /// Returns all runs in the order in which they were logged.
    pub fn all(survey: &Survey, logged: &'a Logs, corrected: &'a Logs) -> Vec<Self> {
        let used: BTreeMap<&str, &Run> = corrected.runs.iter().map(|run| (run.name.as_str(), run)).collect();
        let mut marked: BTreeMap<&str, Vec<(&'static str, [usize; 2])>> = BTreeMap::new();
        for found in survey.findings.iter().filter(|found| is_marked(found.rows(), logged)) {
            for of in &found.rows_by_run {
                marked.entry(&of.run).or_default().extend(of.ranges().map(|range| (found.id, range)));
            }
        }
        let drawn = |logged: &'a Run| {
            let used = used.get(logged.name.as_str()).copied();
            let marked = marked.get(logged.name.as_str()).cloned().unwrap_or_default();
            Drawn { run: used.unwrap_or(logged), is_excluded: used.is_none(), marked, logged }
        };
        logged.runs.iter().map(drawn).collect()
    }

    /// Returns its name.
    pub fn name(&self) -> String {
        format!("{}{}", self.run.name, if self.is_excluded { " (excluded)" } else { "" })
    }

    /// Returns whether a row is marked.
    pub fn is_marked(&self, row: usize) -> bool {
        self.marked.iter().any(|(_, [first, last])| (*first..=*last).contains(&row))
    }

    /// Returns the places of marked rows, cm, with what is wrong there. A pose that is excluded was where it was logged, if other
    /// positions are as they were logged.
    pub fn marks(&self) -> impl Iterator<Item = (DVec2, String)> + '_ {
        let at = |run: &Run, row: usize| Some(run.rows.get(row)?.pose?.position_cm);
        let same = |row: usize| Some(at(self.run, row)?.distance(at(self.logged, row)?) < SAME_CM);
        let is_as_logged = (0..self.run.rows.len()).find_map(same).unwrap_or(false);
        let rows = self.marked.iter().flat_map(|(id, [first, last])| (*first..=*last).map(move |row| (*id, row)));
        rows.filter_map(move |(id, row)| {
            let logged = || at(self.logged, row).filter(|_| is_as_logged);
            Some((at(self.run, row).or_else(logged)?, format!("{}, row {}: {id}", self.run.name, row + 1)))
        })
    }
}

/// Returns at most this many runs: up to half of them or more with marked rows, the others evenly spread.
pub fn chosen<'d, 'a>(runs: &'d [Drawn<'a>], most: usize) -> Vec<&'d Drawn<'a>> {
    let (marked, others): (Vec<usize>, Vec<usize>) = (0..runs.len()).partition(|run| !runs[*run].marked.is_empty());
    let of_marked = marked.len().min((most - most / 2).max(most.saturating_sub(others.len())));
    let of_others = others.len().min(most - of_marked);
    let mut chosen = [spread(&marked, of_marked), spread(&others, of_others)].concat();
    chosen.sort_unstable();
    chosen.into_iter().map(|run| &runs[run]).collect()
}

/// Returns whether a defect of this number of rows is marked in charts.
pub fn is_marked(rows: usize, logged: &Logs) -> bool {
    (rows as f64) <= MOSTLY * logged.rows() as f64
}

/// Returns some elements of a list, evenly spread.
pub fn spread<T: Clone>(all: &[T], count: usize) -> Vec<T> {
    (0..count).map(|i| all[i * all.len() / count].clone()).collect()
}
