//! Logs in longer steps: rows that come faster than motion shows above the tracker's noise say little one by one.

use super::{Logs, Row, Run};
use mindgap_foundations::geometry::{Pose, wrap_rad};

impl Logs {
    /// The same logs with rows every `step_ms`, which is at least the step that they have. A command is the mean of those
    /// held within the step, a pose lies between its neighbours in time, and a reading is the last one of at most a present
    /// step's age. Runs that are shorter than two such steps are left out.
    pub fn in_steps_of(&self, step_ms: f64) -> Logs {
        let mut logs = Logs { robot: self.robot, scene: self.scene.clone(), runs: Vec::new() };
        logs.robot.step_ms = step_ms;
        logs.runs.extend(
            self.runs.iter().map(|run| resampled(run, step_ms, self.robot.step_ms)).filter(|run| run.rows.len() > 1),
        );
        logs
    }
}

/// Two rows that are farther apart than this multiple of their usual distance have something missing between them.
const GAP: f64 = 2.5;

fn resampled(run: &Run, step_ms: f64, usual_ms: f64) -> Run {
    let (first, last) = (run.rows.at(0).t_ms, run.rows.at(run.rows.len() - 1).t_ms);
    // A step is there that ends a rounding error after the last row.
    let steps = ((last - first) / step_ms + 1e-6) as usize;
    let row = |step: usize| {
        let t_ms = first + step as f64 * step_ms;
        let at = run.rows.later_than(t_ms + 1e-6) - 1;
        let (before, after) = (run.rows.at(at), run.rows.get(at + 1));
        let [left, right] = mean_command(run, t_ms, t_ms + step_ms);
        let is_fresh = t_ms - before.t_ms < usual_ms;
        Row {
            t_ms,
            left,
            right,
            pose: pose(&before, after, t_ms, usual_ms),
            echo_cm: before.echo_cm.filter(|_| is_fresh),
            ..before
        }
    };
    Run { name: run.name.clone(), rows: (0..=steps).map(row).collect() }
}

/// The mean of the commands that are held between two times.
fn mean_command(run: &Run, from_ms: f64, to_ms: f64) -> [f64; 2] {
    let mut sum = [0.0; 2];
    let begin = run.rows.later_than(from_ms).saturating_sub(1);
    let rows = run.rows.between(begin..run.rows.len());
    for (i, row) in (begin..).zip(rows).take_while(|(_, row)| row.t_ms < to_ms) {
        let until_ms = run.rows.get(i + 1).map_or(to_ms, |next| next.t_ms.min(to_ms));
        let held_ms = until_ms - row.t_ms.max(from_ms);
        sum = [sum[0] + held_ms * row.left, sum[1] + held_ms * row.right];
    }
    sum.map(|s| s / (to_ms - from_ms))
}

/// The pose at a time from those before and after it; none where either is missing or too far away.
fn pose(before: &Row, after: Option<Row>, t_ms: f64, usual_ms: f64) -> Option<Pose> {
    let from = before.pose?;
    let Some(after) = after else { return Some(from) };
    let share = (t_ms - before.t_ms) / (after.t_ms - before.t_ms);
    if share < 1e-6 {
        return Some(from);
    }
    let to = after.pose.filter(|_| after.t_ms - before.t_ms < GAP * usual_ms)?;
    Some(Pose {
        position_cm: from.position_cm.lerp(to.position_cm, share),
        heading_rad: wrap_rad(from.heading_rad + share * wrap_rad(to.heading_rad - from.heading_rad)),
    })
}
