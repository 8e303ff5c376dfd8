//! Commands that changed within rows: where a log has rows alone, such a row holds the mean of the commands before and after.
//! Each wheel shows by its mean when the command changed, and where both show the same time, that is the time.

use super::commands::{CommandChange, CommandChanges};
use super::run::Run;
use super::samples::LONGEST_STEP;

/// Both wheels have to show the same share of a row within this: commands in whole percent, of which a change of twenty shows
/// the share by no more.
const SAME: f64 = 0.05;
/// A wheel whose command changes by less shows no time: rounding to whole percent would hide it.
const LEAST_CHANGE: f64 = 2.0;
/// Fewer changes show no rule.
const LEAST_MIXED: usize = 5;
/// Share of the changes between held commands that must lie within rows: where commands are set at rows, next to none does by
/// chance.
const MOST: f64 = 0.8;
/// The shares must spread by this, as five that are uniform nearly always do. A controller that sets the mean of two commands
/// for one row has the same share in every row.
const LEAST_SPREAD: f64 = 0.3;

/// Gives runs the commands at their own times where most changes lie within rows. Returns the number of changes that were
/// placed.
pub fn take_apart(runs: &mut [Run], step_ms: f64) -> usize {
    if !are_mixed(runs, step_ms) {
        return 0;
    }
    let of_rows = runs.iter_mut().filter(|run| run.rows.changes().is_none());
    of_rows.map(|run| place(run, step_ms).unwrap_or(0)).sum()
}

/// Returns whether commands change within rows, as far as changes between two held commands show.
fn are_mixed(runs: &[Run], step_ms: f64) -> bool {
    let (mut shares, mut others) = (Vec::new(), 0);
    for run in runs.iter().filter(|run| run.rows.changes().is_none()) {
        let command = |row: usize| run.rows.at(row).command();
        for row in 2..run.rows.len().saturating_sub(2) {
            if !is_complete(run, row - 2, row + 2, step_ms) {
                continue;
            }
            let around = [row - 2, row - 1, row, row + 1, row + 2].map(command);
            let [earlier, before, now, after, later] = around;
            let is_between = earlier == before && after == later && now != before && now != after;
            match share(before, now, after).filter(|_| is_between) {
                Some(Share { by_both: true, share }) => shares.push(share),
                _ => others += usize::from(is_between || (earlier == before && before != now && now == after)),
            }
        }
    }
    let [least, most] = shares.iter().fold([1.0, 0.0], |[least, most]: [f64; 2], s| [least.min(*s), most.max(*s)]);
    shares.len() >= LEAST_MIXED
        && shares.len() as f64 >= MOST * (shares.len() + others) as f64
        && most - least >= LEAST_SPREAD
}

/// Gives a run its commands at their own times, and returns how many changed within a row.
fn place(run: &mut Run, step_ms: f64) -> Option<usize> {
    let mut changes = Vec::new();
    let (mut before, mut placed) = ([0.0; 2], 0);
    for (row, at) in run.rows.iter().enumerate() {
        let now = at.command();
        let is_known = is_complete(run, row.saturating_sub(1), row + 1, step_ms);
        let next = run.rows.get(row + 1).filter(|_| is_known);
        let mixed = next.and_then(|next| Some((share(before, now, next.command())?.share, next)));
        before = match mixed.filter(|_| now != before) {
            Some((share, next)) => {
                placed += 1;
                changes.push(CommandChange { t_ms: at.t_ms + share * (next.t_ms - at.t_ms), command: next.command() });
                next.command()
            }
            None => {
                changes.push(CommandChange { t_ms: at.t_ms, command: now });
                now
            }
        };
    }
    let changes = CommandChanges::of(changes).filter(|_| placed > 0)?;
    run.rows.set_changes(changes);
    Some(placed)
}

/// Returns whether no rows are missing between two rows, or after the last one.
fn is_complete(run: &Run, first: usize, last: usize, step_ms: f64) -> bool {
    let t_ms = |row: usize| run.rows.at(row).t_ms;
    last < run.rows.len() && (first..last).all(|row| t_ms(row + 1) - t_ms(row) <= LONGEST_STEP * step_ms)
}

/// When the command changed within a row.
struct Share {
    /// The share of the row that had passed, between 0 and 1.
    share: f64,
    /// Whether both wheels show it, and not one alone because the other one's command hardly changed.
    by_both: bool,
}

/// Returns the share of a row after which its command changed, if it holds the mean of the one before and the one after.
fn share(before: [f64; 2], now: [f64; 2], after: [f64; 2]) -> Option<Share> {
    let of_wheel = |wheel: usize| {
        let change = before[wheel] - after[wheel];
        (change.abs() >= LEAST_CHANGE).then(|| (now[wheel] - after[wheel]) / change)
    };
    let is_unchanged = |wheel: usize| {
        let [low, high] = [before[wheel].min(after[wheel]), before[wheel].max(after[wheel])];
        (low..=high).contains(&now[wheel])
    };
    let (share, by_both) = match [of_wheel(0), of_wheel(1)] {
        [Some(left), Some(right)] => ((left - right).abs() <= SAME).then_some((0.5 * (left + right), true))?,
        [Some(left), None] => is_unchanged(1).then_some((left, false))?,
        [None, right] => (right?, is_unchanged(0).then_some(false)?),
    };
    (share > 0.0 && share < 1.0).then_some(Share { share, by_both })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Row;

    const STEP_MS: f64 = 400.0;

    /// Rows that hold the means of these commands, as they are written.
    fn rows_of(changes: &CommandChanges, rows: usize) -> Run {
        let row = |k: usize| {
            let t_ms = STEP_MS * k as f64;
            let [left, right] = changes.mean(t_ms, t_ms + STEP_MS).map(|c| (c * 100.0).round() / 100.0);
            Row { t_ms, left, right, ..Row::default() }
        };
        Run { name: "run-000".into(), rows: (0..rows).map(row).collect() }
    }

    /// Commands that change every `hold_ms` or so.
    fn driven(count: u32, hold_ms: impl Fn(u32) -> f64) -> CommandChanges {
        let mut t_ms = 0.0;
        let change = |k: u32| {
            let command = [70.0 - 23.0 * f64::from(k % 5), 20.0 + 19.0 * f64::from(k % 4)];
            let change = CommandChange { t_ms, command };
            t_ms += hold_ms(k);
            change
        };
        CommandChanges::of((0..count).map(change).collect::<Vec<_>>()).expect("commands")
    }

    #[test]
    fn times_of_changes_within_rows_are_recovered() {
        let changes = driven(20, |k| 1230.0 + 70.0 * f64::from(k % 7));
        let mut runs = [rows_of(&changes, 80)];
        assert!(take_apart(&mut runs, STEP_MS) >= 15);
        let recovered = runs[0].rows.changes().expect("changes").as_slice();
        assert_eq!(recovered.len(), 20);
        for (recovered, change) in recovered.iter().zip(changes.as_slice()) {
            assert!((recovered.t_ms - change.t_ms).abs() < 0.5, "{recovered:?} for {change:?}");
        }
    }

    #[test]
    fn commands_that_are_set_at_rows_stay_as_they_are() {
        for holds in [1, 2, 3] {
            let mut runs = [rows_of(&driven(40, |_| STEP_MS * f64::from(holds)), 80)];
            let before = runs.clone();
            assert_eq!((take_apart(&mut runs, STEP_MS), &runs), (0, &before));
        }
    }

    /// A smoother in the controller sets the mean of two commands for one row.
    #[test]
    fn ramps_of_two_equal_halves_are_no_changes_within_rows() {
        let command = |k: u32| [4 * k, 4 * (k * 7 % 11)].map(f64::from);
        let row = |k: u32| {
            let (now, next) = (command(k / 4), command(k / 4 + 1));
            let [left, right] = if k % 4 == 3 { [0, 1].map(|wheel| 0.5 * (now[wheel] + next[wheel])) } else { now };
            Row { t_ms: STEP_MS * f64::from(k), left, right, ..Row::default() }
        };
        let mut runs = [Run { name: "run-000".into(), rows: (0..80).map(row).collect() }];
        assert_eq!(take_apart(&mut runs, STEP_MS), 0);
    }
}
