//! The commands of a step and of those before it at their own times, where a log knows these.

use mindgap_logs::{CommandChange, Rows};

/// Number of commands visible to an effect, newest first.
pub const HISTORY: usize = 16;
/// Left and right command of the present step and of those before it, newest first; zero before the run began.
pub type CommandHistory = [[f64; 2]; HISTORY];

/// Number of latest changes of command that a step remembers. Of those before them it knows the means of the steps.
const LATEST: usize = 16;
/// Changes nearer to each other than this are one: a thousandth of a step moves no wheel that a tracker would see.
const SAME_STEPS: f64 = 1e-3;

/// The latest commands of a step at their own times, newest first; none where the step's commands changed between rows alone.
///
/// In single precision, since every row of a diagnosis has some: that resolves a microstep and a millionth of full speed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pieces {
    count: usize,
    /// When each began, in steps since the present one began, which ends at one.
    begins_steps: [f32; LATEST],
    commands: [[f32; 2]; LATEST],
}

/// The history of commands as it is in several phases of a step: from one to the next no command changes.
pub struct Phases {
    /// When each begins, in steps since the present one began; the first at zero.
    pub begins_steps: Vec<f64>,
    /// The commands in each, newest first, a step apart.
    pub histories: Vec<CommandHistory>,
}

impl Pieces {
    /// Returns those of the step of a row; none where only the commands of rows are known.
    pub fn of(rows: &Rows, row: usize) -> Self {
        let mut pieces = Pieces::default();
        let Some(changes) = rows.changes() else { return pieces };
        let (begin_ms, end_ms) = (rows.at(row).t_ms, rows.end_ms(row));
        let known = changes.before(end_ms);
        let steps = |change: &CommandChange| (change.t_ms - begin_ms) / (end_ms - begin_ms);
        for change in known.iter().rev() {
            if pieces.count == LATEST {
                return pieces;
            }
            pieces.push(steps(change), change.command);
            if steps(change) < -(HISTORY as f64) {
                return pieces;
            }
        }
        // Before the first change the motors rest, unless that change is older than the run.
        let is_older = known.first().is_some_and(|first| rows.first().is_some_and(|row| first.t_ms < row.t_ms));
        if is_older {
            pieces.begins_steps[pieces.count - 1] = f32::NEG_INFINITY;
        } else if pieces.count < LATEST {
            pieces.push(f64::NEG_INFINITY, [0.0; 2]);
        }
        pieces
    }

    /// Returns whether there are none.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Returns the phases of a step to which the commands of the last `reach_steps` before it matter, and the one that holds when
    /// these begin; `by_step` are the means of the steps, for what is older than these pieces.
    pub fn phases(&self, by_step: &CommandHistory, reach_steps: f64) -> Phases {
        // A step takes part as a whole: its phases hold for the steps that matter alike.
        let oldest_steps = -libm::floor(reach_steps) - 1.0;
        let recent = self.begins_steps[..self.count].iter().map(|begin| f64::from(*begin));
        let recent = recent.filter(|begin| *begin > oldest_steps).map(|begin| begin - libm::floor(begin));
        let mut begins_steps: Vec<f64> = recent.filter(|phase| *phase < 1.0 - SAME_STEPS).collect();
        begins_steps.push(0.0);
        begins_steps.sort_by(f64::total_cmp);
        begins_steps.dedup_by(|next, before| *next - *before < SAME_STEPS);
        let end = |phase: usize| begins_steps.get(phase + 1).copied().unwrap_or(1.0);
        // Halfway through a phase no rounding decides which command holds.
        let at = |phase: usize| self.sampled(by_step, 0.5 * (begins_steps[phase] + end(phase)));
        let histories = (0..begins_steps.len()).map(at).collect();
        Phases { begins_steps, histories }
    }

    fn push(&mut self, begin_steps: f64, command: [f64; 2]) {
        self.begins_steps[self.count] = begin_steps as f32;
        self.commands[self.count] = command.map(|command| command as f32);
        self.count += 1;
    }

    /// Returns the commands at a share of each step, newest first.
    fn sampled(&self, by_step: &CommandHistory, share: f64) -> CommandHistory {
        let mut piece = 0;
        std::array::from_fn(|ago| {
            let begun = |piece: usize| f64::from(self.begins_steps[piece]) <= share - ago as f64;
            while piece < self.count && !begun(piece) {
                piece += 1;
            }
            if piece < self.count { self.commands[piece].map(f64::from) } else { by_step[ago] }
        })
    }
}

impl Phases {
    /// Returns the phase that holds at a share of a step, 0 to 1.
    pub fn at(&self, share: f64) -> usize {
        self.begins_steps.partition_point(|begin| *begin <= share).max(1) - 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mindgap_logs::{CommandChanges, Row};

    fn rows(changes: &[(f64, f64)]) -> Rows {
        let mut rows: Rows = (0..6).map(|k| Row { t_ms: 100.0 * f64::from(k), ..Row::default() }).collect();
        let change = |(t_ms, command): &(f64, f64)| CommandChange { t_ms: *t_ms, command: [*command, *command] };
        rows.set_changes(CommandChanges::of(changes.iter().map(change)).expect("changes"));
        rows
    }

    fn left(history: &CommandHistory) -> [f64; 4] {
        [0, 1, 2, 3].map(|ago| history[ago][0])
    }

    #[test]
    fn phases_begin_where_commands_change() {
        let rows = rows(&[(0.0, 10.0), (125.0, 20.0), (250.0, 30.0)]);
        let phases = Pieces::of(&rows, 2).phases(&[[0.0; 2]; HISTORY], 16.0);
        assert_eq!(phases.begins_steps, [0.0, 0.25, 0.5]);
        assert_eq!(left(&phases.histories[0]), [20.0, 10.0, 10.0, 0.0]);
        assert_eq!(left(&phases.histories[1]), [20.0, 20.0, 10.0, 0.0]);
        assert_eq!(left(&phases.histories[2]), [30.0, 20.0, 10.0, 0.0]);
        assert_eq!([0.0, 0.3, 0.5, 1.0].map(|share| phases.at(share)), [0, 1, 2, 2]);
        let held = Pieces::of(&rows, 4).phases(&[[0.0; 2]; HISTORY], 0.0);
        assert_eq!(held.begins_steps, [0.0], "all changes are more than a step old");
        assert_eq!(left(&held.histories[0])[..2], [30.0, 30.0]);
    }

    #[test]
    fn command_older_than_the_run_replaces_the_start_from_rest() {
        let rows = rows(&[(-50.0, 10.0), (125.0, 20.0)]);
        let phases = Pieces::of(&rows, 0).phases(&[[0.0; 2]; HISTORY], 16.0);
        assert!(phases.histories.iter().all(|history| left(history) == [10.0; 4]));
        assert_eq!(rows.command_before_start(), [10.0; 2]);
    }

    /// Of a log in which commands change often, only the latest are remembered at their own times.
    #[test]
    fn means_stand_for_what_is_older_than_the_pieces() {
        let often: Vec<(f64, f64)> = (0..50).map(|k| (10.0 * f64::from(k) + 5.0, f64::from(k))).collect();
        let by_step = std::array::from_fn(|ago| [-(ago as f64); 2]);
        let phases = Pieces::of(&rows(&often), 4).phases(&by_step, 1.0);
        assert_eq!(phases.begins_steps.len(), 11);
        assert_eq!(left(&phases.histories[10]), [49.0, 39.0, -2.0, -3.0]);
        assert!(Pieces::of(&rows(&often), 4).count == LATEST);
    }

    #[test]
    fn rows_alone_have_no_pieces() {
        let rows: Rows = (0..3).map(|k| Row { t_ms: f64::from(k), ..Row::default() }).collect();
        assert!(Pieces::of(&rows, 1).is_empty());
    }
}
