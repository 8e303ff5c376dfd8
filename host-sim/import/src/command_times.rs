//! Commands that changed between two rows: a logger that runs beside the controller writes the command that holds at each of its
//! rows, and the rotation counters show when within the row before it was set.

use mindgap_foundations::statistics::summary::median;
use mindgap_logs::{CommandChange, CommandChanges, Run};

/// Both wheels have to show the same time within this share of a row.
const SAME: f64 = 0.1;
/// Fewer changes show no rule.
const LEAST_CHANGES: usize = 5;
/// Share of the changes for which both wheels have to show the same time.
const MOST: f64 = 0.8;
/// Changes nearer to their row than this share lie at it: commands are set at rows.
const AT_ROWS: f64 = 0.9;

/// Gives a run its commands at their own times, where both rotation counters show the same time of a change. Returns the number
/// of changes that were placed within rows; none where commands are set at rows.
pub fn place(run: &mut Run) -> usize {
    let Some(turned) = turned_deg(run) else { return 0 };
    let Some(per_command) = deg_per_command(run, &turned) else { return 0 };
    let shares: Vec<(usize, Option<f64>)> =
        changes(run).map(|row| (row, share(run, &turned, per_command, row))).collect();
    let agreed: Vec<f64> = shares.iter().filter_map(|(_, share)| *share).collect();
    let is_rule = agreed.len() >= LEAST_CHANGES && agreed.len() as f64 >= MOST * shares.len() as f64;
    if !is_rule || median(agreed.iter().copied()) > AT_ROWS {
        return 0;
    }
    let response = response(run, &turned, per_command);
    let mut changes = Vec::new();
    let mut shares = shares.into_iter().peekable();
    for (at, row) in run.rows.iter().enumerate() {
        changes.push(CommandChange { t_ms: row.t_ms, command: row.command() });
        let share = shares.next_if(|(changed, _)| *changed == at).and_then(|(_, share)| share);
        if let (Some(share), Some(next)) = (share, run.rows.get(at + 1)) {
            // The wheels follow by their response, so that the command was set earlier than they show.
            let t_ms = row.t_ms + (share - response).clamp(0.0, 1.0) * (next.t_ms - row.t_ms);
            changes.push(CommandChange { t_ms, command: next.command() });
        }
    }
    if let Some(changes) = CommandChanges::of(changes) {
        run.rows.set_changes(changes);
    }
    agreed.len()
}

/// Returns how far each wheel turned in each row, degrees; `None` without counters.
fn turned_deg(run: &Run) -> Option<Vec<[f64; 2]>> {
    let counters = |at: usize| {
        let row = run.rows.at(at);
        Some([row.rot_left_deg?, row.rot_right_deg?])
    };
    let step = |at: usize| {
        let ([left, right], [left_next, right_next]) = (counters(at)?, counters(at + 1)?);
        Some([left_next - left, right_next - right])
    };
    (0..run.rows.len().saturating_sub(1)).map(step).collect()
}

/// Returns the rows after which another command holds.
fn changes(run: &Run) -> impl Iterator<Item = usize> {
    let command = |at: usize| run.rows.at(at).command();
    (0..run.rows.len().saturating_sub(2)).filter(move |at| command(*at) != command(at + 1))
}

/// Returns how far a wheel turns per row and command, from rows within a held command.
fn deg_per_command(run: &Run, turned: &[[f64; 2]]) -> Option<f64> {
    let command = |at: usize| run.rows.at(at).command();
    let is_held = |at: &usize| command(at - 1) == command(*at) && command(*at) == command(at + 1);
    let held = (1..turned.len().saturating_sub(1)).filter(is_held);
    let ratios = held.flat_map(|at| (0..2).map(move |wheel| (at, wheel)));
    let ratios = ratios.filter(|(at, wheel)| command(*at)[*wheel] != 0.0);
    let per_command = median(ratios.map(|(at, wheel)| turned[at][wheel] / command(at)[wheel]));
    (per_command > 0.0).then_some(per_command)
}

/// Returns the share of a row during which the wheels still turned by its own command, if both show the same.
fn share(run: &Run, turned: &[[f64; 2]], per_command: f64, row: usize) -> Option<f64> {
    let [now, next] = [row, row + 1].map(|at| run.rows.at(at).command());
    let of_wheel = |wheel: usize| {
        let change = now[wheel] - next[wheel];
        (change != 0.0).then(|| (turned[row][wheel] / per_command - next[wheel]) / change)
    };
    match [of_wheel(0), of_wheel(1)] {
        [Some(left), Some(right)] => ((left - right).abs() <= SAME).then_some(0.5 * (left + right)),
        [one, other] => one.or(other),
    }
    .filter(|share| (-SAME..=1.0 + SAME).contains(share))
}

/// Returns what the wheels lack in the first row, in which they start from rest: their response, as a share of a row.
fn response(run: &Run, turned: &[[f64; 2]], per_command: f64) -> f64 {
    let [command, next] = [0, 1].map(|at| run.rows.at(at).command());
    let is_held = command == next && command.iter().all(|command| *command != 0.0);
    let Some(turned) = turned.first().filter(|_| is_held) else { return 0.0 };
    let lacks = [0, 1].map(|wheel| 1.0 - turned[wheel] / per_command / command[wheel]);
    if (lacks[0] - lacks[1]).abs() <= SAME { (0.5 * (lacks[0] + lacks[1])).clamp(0.0, 1.0) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mindgap_logs::Row;

    /// A logger that writes every 400 ms beside a controller whose commands change at other times; wheels that turn by two
    /// degrees per row and command, `late` by this share of a row.
    fn logged(change_after: impl Fn(usize) -> f64, late: f64) -> Run {
        let commands: Vec<[f64; 2]> =
            (0..12).map(|i| [70.0 - 11.0 * f64::from(i % 5), 20.0 + 13.0 * f64::from(i % 4)]).collect();
        // Command i holds for three rows, to the share `change_after` of its last one.
        let (mut rows, mut rotation) = (Vec::new(), [0.0; 2]);
        for at in 0..36 {
            let [left, right] = commands[at / 3];
            let (rot_left_deg, rot_right_deg) = (Some(rotation[0]), Some(rotation[1]));
            rows.push(Row { t_ms: 400.0 * at as f64, left, right, rot_left_deg, rot_right_deg, ..Row::default() });
            let next = commands[(at / 3 + 1).min(11)];
            let own = match at {
                0 => 1.0 - late,
                _ if at % 3 == 2 => (change_after(at / 3) + late).min(1.0),
                _ => 1.0,
            };
            let other = if at == 0 { [0.0; 2] } else { next };
            for wheel in 0..2 {
                rotation[wheel] += 2.0 * (own * commands[at / 3][wheel] + (1.0 - own) * other[wheel]);
            }
        }
        Run { name: "run-000".into(), rows: rows.into_iter().collect() }
    }

    #[test]
    fn changes_within_rows_are_placed_by_the_counters() {
        let mut run = logged(|change| 0.2 + 0.05 * change as f64, 0.1);
        let [before, after] = [2, 3].map(|at| run.rows.at(at).command());
        assert!(place(&mut run) >= 10);
        let [left, right] = run.rows.at(2).command();
        assert!((left - (0.2 * before[0] + 0.8 * after[0])).abs() < 1e-9, "{left}");
        assert!((right - (0.2 * before[1] + 0.8 * after[1])).abs() < 1e-9, "{right}");
        assert_eq!(run.rows.at(3).command(), after);
    }

    #[test]
    fn commands_that_are_set_at_rows_stay() {
        let mut run = logged(|_| 1.0, 0.0);
        assert_eq!(place(&mut run), 0);
        assert_eq!(run.rows.at(2).command(), logged(|_| 1.0, 0.0).rows.at(2).command());
    }
}
