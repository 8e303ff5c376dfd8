//! Runs that are there twice: counted twice, they would look like evidence.

use std::collections::BTreeMap;
use std::hash::{DefaultHasher, Hash, Hasher};

use super::finding::{Finding, Handling, Place};
use crate::{Logs, Run};

/// Leaves out runs that repeat an earlier one number by number. A robot that stands still may repeat itself honestly.
pub fn check(logs: &mut Logs) -> Vec<Finding> {
    let mut copies: Vec<[usize; 2]> = Vec::new();
    let mut known: BTreeMap<u64, Vec<usize>> = BTreeMap::new();
    for (later, run) in logs.runs.iter().enumerate() {
        let alike = known.entry(hash(run)).or_default();
        match alike.iter().find(|earlier| logs.runs[**earlier].rows == run.rows) {
            Some(earlier) => copies.extend(is_driven(run).then_some([*earlier, later])),
            None => alike.push(later),
        }
    }
    if copies.is_empty() {
        return Vec::new();
    }
    let place = |[_, later]: &[usize; 2]| {
        let run = &logs.runs[*later];
        Place { run: run.name.clone(), rows: (0..run.rows.len()).collect() }
    };
    let pairs: Vec<String> =
        copies.iter().map(|[a, b]| format!("{} is {}", logs.runs[*b].name, logs.runs[*a].name)).collect();
    let found = Finding {
        id: "run_copied",
        places: copies.iter().map(place).collect(),
        handling: Handling::LeftOut,
        withholds: &[],
        sentence: format!("Runs are there twice ({}): keep one of each.", pairs.join(", ")),
    };
    let mut is_copy = vec![false; logs.runs.len()];
    copies.iter().for_each(|[_, later]| is_copy[*later] = true);
    let mut is_copy = is_copy.into_iter();
    logs.runs.retain(|_| is_copy.next() == Some(false));
    vec![found]
}

/// Equal runs have equal hashes, so that not every run is held against every other.
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

fn is_driven(run: &Run) -> bool {
    let mut poses = run.rows.iter().filter_map(|row| row.pose);
    let first = poses.next();
    run.rows.iter().any(|row| row.command() != [0.0; 2]) && poses.any(|pose| Some(pose) != first)
}
