//! Runs of both sides that drove the same commands, aligned at their starts.

use schemars::JsonSchema;
use serde::Serialize;

use mindgap_foundations::geometry::Pose;
use mindgap_learning::evaluation::replay::Moment;
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

/// Returns the simulator's recording of the commands of a robot's run.
pub fn recorded<'a>(pairs: &[Pair], simulator: &'a Logs, real: &Run) -> Option<&'a Run> {
    let pair = pairs.iter().find(|pair| pair.real == real.name)?;
    simulator.runs.iter().find(|run| run.name == pair.simulated)
}

/// Returns what the simulator's recording of a pair shows at each row of the robot's run, moved to begin where the robot was first
/// seen; empty moments where the recording has no row.
pub fn alongside(real: &Run, simulated: &Run, step_ms: f64) -> Vec<Moment> {
    let (Some(first), Some(recorded_first)) = (real.rows.first(), simulated.rows.first()) else { return Vec::new() };
    let start = real.rows.iter().find_map(|row| row.pose);
    let since_start = from_start(simulated);
    let times_ms: Vec<f64> = simulated.rows.iter().map(|row| row.t_ms - recorded_first.t_ms).collect();
    let at = |t_ms: f64| {
        let k = times_ms.partition_point(|other_ms| *other_ms < t_ms - step_ms / 2.0);
        let k = Some(k).filter(|k| times_ms.get(*k).is_some_and(|other_ms| *other_ms <= t_ms + step_ms / 2.0))?;
        let pose = since_start[k].and_then(|pose| Some(start?.compose(&pose)));
        Some(Moment { pose, echo_cm: simulated.rows.at(k).echo_cm })
    };
    real.rows.iter().map(|row| at(row.t_ms - first.t_ms).unwrap_or_default()).collect()
}

/// Returns the poses of a run, each relative to the first; `None` where the robot was not seen.
fn from_start(run: &Run) -> Vec<Option<Pose>> {
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
