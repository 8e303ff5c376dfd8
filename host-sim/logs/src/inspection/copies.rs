//! Checks for duplicated runs, which would count twice as evidence.

use std::collections::BTreeMap;
use std::hash::{DefaultHasher, Hash, Hasher};

use super::finding::{Finding, Handling, RunRows};
use crate::{Logs, Run};

/// Excludes runs that are identical to an earlier one. Runs of a robot at rest may be identical legitimately.
pub fn check(logs: &mut Logs) -> Vec<Finding> {
    let mut copies: Vec<[usize; 2]> = Vec::new();
    let mut known: BTreeMap<u64, Vec<usize>> = BTreeMap::new();
    for (later, run) in logs.runs.iter().enumerate() {
        let candidates = known.entry(hash(run)).or_default();
        match candidates.iter().find(|earlier| logs.runs[**earlier].rows == run.rows) {
            Some(earlier) => copies.extend(has_moved(run).then_some([*earlier, later])),
            None => candidates.push(later),
        }
    }
    if copies.is_empty() {
        return Vec::new();
    }
    let rows_of = |[_, later]: &[usize; 2]| {
        let run = &logs.runs[*later];
        RunRows { run: run.name.clone(), rows: (0..run.rows.len()).collect() }
    };
    let pairs: Vec<String> =
        copies.iter().map(|[a, b]| format!("{} is {}", logs.runs[*b].name, logs.runs[*a].name)).collect();
    let found = Finding {
        id: "run_copied",
        rows_by_run: copies.iter().map(rows_of).collect(),
        handling: Handling::Excluded,
        withholds: &[],
        sentence: format!("Runs are duplicated ({}): keep one of each.", pairs.join(", ")),
    };
    let mut is_copy = vec![false; logs.runs.len()];
    copies.iter().for_each(|[_, later]| is_copy[*later] = true);
    let mut is_copy = is_copy.into_iter();
    logs.runs.retain(|_| is_copy.next() == Some(false));
    vec![found]
}

/// Hashes a run, so that not every run need be compared with every other.
fn hash(run: &Run) -> u64 {
    let mut hasher = DefaultHasher::new();
    run.rows.len().hash(&mut hasher);
    for row in &run.rows {
        // Zero and minus zero are equal.
        let at_cm = row.pose.map_or([0.0; 2], |pose| pose.position_cm.to_array());
        [row.t_ms, row.left, row.right, at_cm[0], at_cm[1]].map(|x| (x + 0.0).to_bits()).hash(&mut hasher);
    }
    hasher.finish()
}

fn has_moved(run: &Run) -> bool {
    let mut poses = run.rows.iter().filter_map(|row| row.pose);
    let first = poses.next();
    run.rows.iter().any(|row| row.command() != [0.0; 2]) && poses.any(|pose| Some(pose) != first)
}
