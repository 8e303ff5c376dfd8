//! Runs of both sides that drove the same commands, aligned at their starts.

use schemars::JsonSchema;
use serde::Serialize;

use mindgap_foundations::geometry::Pose;
use mindgap_logs::{Logs, Run};

/// A run of the robot and one of the simulator with the same commands.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Pair {
    /// The robot's run.
    pub real: String,
    /// The simulator's run.
    pub simulated: String,
    /// Number of rows that both have.
    pub rows: usize,
    /// Mean distance between both paths, aligned at the start, cm.
    pub mean_cm: f64,
    /// Distance between their ends, cm.
    pub end_cm: f64,
}

/// Commands that differ by less count as the same, in percent of full.
const SAME_COMMAND: f64 = 0.6;
/// Fewest rows of a pair.
const FEWEST_ROWS: usize = 5;

/// Returns the pairs, in the order of the robot's runs.
pub fn pairs(simulator: &Logs, real: &Logs) -> Vec<Pair> {
    real.runs.iter().filter_map(|run| simulator.runs.iter().find_map(|other| pair(run, other))).collect()
}

/// Returns the poses of a run, each relative to the first; `None` where the robot was not seen.
pub fn from_start(run: &Run) -> Vec<Option<Pose>> {
    let start = run.rows.iter().find_map(|row| row.pose);
    run.rows.iter().map(|row| Some(start?.relative(&row.pose?))).collect()
}

fn pair(real: &Run, simulated: &Run) -> Option<Pair> {
    let rows = real.rows.len().min(simulated.rows.len());
    let is_same = |(a, b): (mindgap_logs::Row, mindgap_logs::Row)| {
        (a.left - b.left).abs() < SAME_COMMAND && (a.right - b.right).abs() < SAME_COMMAND
    };
    // The last row's command is never seen.
    let same = real.rows.iter().zip(simulated.rows.iter()).take(rows.saturating_sub(1)).all(is_same);
    if rows < FEWEST_ROWS || !same {
        return None;
    }
    let paths = [from_start(real), from_start(simulated)];
    let apart = paths[0].iter().zip(&paths[1]).filter_map(|(a, b)| Some((*a)?.position_cm.distance((*b)?.position_cm)));
    let apart: Vec<f64> = apart.collect();
    let mean_cm = apart.iter().sum::<f64>() / apart.len().max(1) as f64;
    Some(Pair { real: real.name.clone(), simulated: simulated.name.clone(), rows, mean_cm, end_cm: *apart.last()? })
}
