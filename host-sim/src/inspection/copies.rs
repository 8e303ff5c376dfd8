//! Runs that are there twice: counted twice, they would look like evidence.

use super::finding::{Finding, Handling, Place};
use crate::logs::{Logs, Run};

/// Leaves out runs that repeat an earlier one number by number. A robot that stands still may repeat itself honestly.
pub fn check(logs: &mut Logs) -> Vec<Finding> {
    let mut copies: Vec<[usize; 2]> = Vec::new();
    for (later, run) in logs.runs.iter().enumerate() {
        let earlier = logs.runs[..later].iter().position(|other| other.rows == run.rows);
        copies.extend(earlier.filter(|_| is_driven(run)).map(|earlier| [earlier, later]));
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
    let mut index = 0..;
    logs.runs.retain(|_| {
        let this = index.next();
        !copies.iter().any(|[_, later]| Some(*later) == this)
    });
    vec![found]
}

fn is_driven(run: &Run) -> bool {
    let mut poses = run.rows.iter().filter_map(|row| row.pose);
    let first = poses.next();
    run.rows.iter().any(|row| row.command() != [0.0; 2]) && poses.any(|pose| Some(pose) != first)
}
