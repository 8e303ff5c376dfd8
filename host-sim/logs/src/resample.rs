//! Resamples logs to longer steps, since motion between closely spaced rows vanishes in the tracker's noise.

use std::sync::Arc;

use super::{Logs, Row, Rows, Run};
use mindgap_foundations::geometry::Pose;

impl Logs {
    /// Returns the logs with rows every `step_ms`, which must be at least their present step. Commands are averaged over the step,
    /// poses and rotation counters interpolated between their neighbours, and a reading is the latest one no older than a present step. Runs shorter
    /// than two such steps are dropped.
    pub fn resampled(&self, step_ms: f64) -> Logs {
        let mut logs = Logs { robot: self.robot, scene: self.scene.clone(), runs: Vec::new() };
        logs.robot.step_ms = step_ms;
        logs.runs.extend(
            self.runs
                .iter()
                .map(|run| resampled_run(run, step_ms, self.robot.step_ms))
                .filter(|run| run.rows.len() > 1),
        );
        logs
    }
}

/// Two rows farther apart than this multiple of the usual interval have rows missing between them.
const GAP: f64 = 2.5;

fn resampled_run(run: &Run, step_ms: f64, usual_ms: f64) -> Run {
    let (first, last) = (run.rows.at(0).t_ms, run.rows.at(run.rows.len() - 1).t_ms);
    // A last step may end a rounding error after the last row.
    let steps = ((last - first) / step_ms + 1e-6) as usize;
    let row = |step: usize| {
        let t_ms = first + step as f64 * step_ms;
        let at = run.rows.first_later_than(t_ms + 1e-6) - 1;
        let (before, after) = (run.rows.at(at), run.rows.get(at + 1));
        let [left, right] = mean_command(run, t_ms, t_ms + step_ms);
        let is_fresh = t_ms - before.t_ms < usual_ms;
        let resampled = Row {
            t_ms,
            left,
            right,
            pose: pose(&before, after, t_ms, usual_ms),
            echo_cm: before.echo_cm.filter(|_| is_fresh),
            rot_left_deg: between(&before, after, t_ms, |row| row.rot_left_deg),
            rot_right_deg: between(&before, after, t_ms, |row| row.rot_right_deg),
            ..before
        };
        (resampled, at)
    };
    let mut rows = Rows::of(Arc::new(run.rows.sensors().clone()));
    for step in 0..=steps {
        let (row, at) = row(step);
        let is_fresh = row.t_ms - run.rows.at(at).t_ms < usual_ms;
        rows.push(row);
        for sensor in 0..run.rows.sensors().further().len() {
            rows.set_further_cm(sensor, step, run.rows.further_cm(sensor, at).filter(|_| is_fresh));
        }
    }
    if let Some(changes) = run.rows.changes() {
        rows.set_changes(changes.clone());
    }
    Run { name: run.name.clone(), rows }
}

/// Returns the time-weighted mean of the commands between two times.
fn mean_command(run: &Run, from_ms: f64, to_ms: f64) -> [f64; 2] {
    let mut sum = [0.0; 2];
    let first_row = run.rows.first_later_than(from_ms).saturating_sub(1);
    let rows = run.rows.between(first_row..run.rows.len());
    for (i, row) in (first_row..).zip(rows).take_while(|(_, row)| row.t_ms < to_ms) {
        let until_ms = run.rows.get(i + 1).map_or(to_ms, |next| next.t_ms.min(to_ms));
        let held_ms = until_ms - row.t_ms.max(from_ms);
        sum = [sum[0] + held_ms * row.left, sum[1] + held_ms * row.right];
    }
    sum.map(|s| s / (to_ms - from_ms))
}

/// Interpolates a number that rises and falls steadily; `None` if a neighbour lacks it.
fn between(before: &Row, after: Option<Row>, t_ms: f64, number: impl Fn(&Row) -> Option<f64>) -> Option<f64> {
    let from = number(before)?;
    let Some(after) = after.filter(|_| t_ms > before.t_ms) else { return Some(from) };
    Some(from + (t_ms - before.t_ms) / (after.t_ms - before.t_ms) * (number(&after)? - from))
}

/// Interpolates the pose at a time; `None` if a neighbour is missing or too far away.
fn pose(before: &Row, after: Option<Row>, t_ms: f64, usual_ms: f64) -> Option<Pose> {
    let from = before.pose?;
    let Some(after) = after else { return Some(from) };
    let share = (t_ms - before.t_ms) / (after.t_ms - before.t_ms);
    if share < 1e-6 {
        return Some(from);
    }
    let to = after.pose.filter(|_| after.t_ms - before.t_ms < GAP * usual_ms)?;
    Some(from.between(&to, share))
}
