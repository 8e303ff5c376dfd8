//! `commands-*.csv`: the commands of a run at the times when they changed (docs/reference/formats.md).

use std::path::Path;

use csv::{StringRecord, Writer};

use super::columns::{COMMAND_COLUMNS, Columns, two_decimals};
use super::range_sensor::Sensors;
use mindgap_files::{Records, TextFile};
use mindgap_foundations::error::{Error, Result};

/// A command and when it was set.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CommandChange {
    /// Time on the run's clock, ms.
    pub t_ms: f64,
    /// Left and right command, -100..=100.
    pub command: [f64; 2],
}

/// The commands of a run at their own times: at least one, in temporal order. Each is held until the next, the last to the
/// end. Before the first the motors rest, or hold the first command if it is older than the run's first row.
#[derive(Clone, Debug, PartialEq)]
pub struct CommandChanges(Vec<CommandChange>);

/// Times nearer to each other than this may be equal in a file, which has hundredths.
const SAME_MS: f64 = 0.02;

impl CommandChanges {
    /// Returns the changes among commands in temporal order; `None` where there is none. Repeated commands change nothing, and of
    /// those at one time the last counts.
    pub fn of(commands: impl IntoIterator<Item = CommandChange>) -> Option<Self> {
        let mut changes: Vec<CommandChange> = commands.into_iter().collect();
        changes.dedup_by(|next, before| {
            let is_same_time = next.t_ms - before.t_ms < SAME_MS;
            if is_same_time {
                before.command = next.command;
            }
            is_same_time
        });
        changes.dedup_by(|next, before| next.command == before.command);
        (!changes.is_empty()).then_some(CommandChanges(changes))
    }

    /// Reads a file. `warn` receives a line for each unknown column.
    ///
    /// # Errors
    /// When the file cannot be read, lacks a column or a row, or has an invalid number or times that do not ascend.
    pub fn read(path: &Path, mut warn: impl FnMut(String)) -> Result<Self> {
        let mut text = TextFile::open(path)?;
        let mut records = Records::new(path, &mut text);
        let (known, header, sensors) = (&COMMAND_COLUMNS, records.header()?, Sensors::default());
        let columns = Columns::find_among(known, path, &header, known, &sensors, &mut warn)?;
        let mut commands: Vec<CommandChange> = Vec::new();
        let mut record = StringRecord::new();
        while let Some(line) = records.read(&mut record)? {
            let row = columns.row(&record).map_err(|what| Error::at_line(path, line, what))?;
            if let Some(before) = commands.last().filter(|before| row.t_ms <= before.t_ms) {
                let what = format!("t_ms = {} is not later than the row before ({})", row.t_ms, before.t_ms);
                return Err(Error::at_line(path, line, what));
            }
            commands.push(CommandChange { t_ms: row.t_ms, command: row.command() });
        }
        CommandChanges::of(commands).ok_or_else(|| Error::in_file(path, "has no command; delete it if there is none"))
    }

    /// Returns the text of the file.
    pub fn to_text(&self) -> String {
        let mut writer = Writer::from_writer(Vec::new());
        let header = COMMAND_COLUMNS.map(str::to_owned);
        let cells = |change: &CommandChange| [change.t_ms, change.command[0], change.command[1]].map(two_decimals);
        for record in std::iter::once(header).chain(self.0.iter().map(cells)) {
            writer.write_record(record).expect("rows of one length, into memory");
        }
        let bytes = writer.into_inner().expect("into memory");
        String::from_utf8(bytes).expect("names and numbers")
    }

    /// Returns the changes in temporal order.
    pub fn as_slice(&self) -> &[CommandChange] {
        &self.0
    }

    /// Returns the changes before a time.
    pub fn before(&self, t_ms: f64) -> &[CommandChange] {
        &self.0[..self.0.partition_point(|change| change.t_ms < t_ms)]
    }

    /// Returns the time-weighted mean command between two times, the second of which is later.
    pub fn mean(&self, from_ms: f64, to_ms: f64) -> [f64; 2] {
        let (mut sum, mut until_ms) = ([0.0; 2], to_ms);
        for change in self.before(to_ms).iter().rev() {
            let held_ms = until_ms - change.t_ms.max(from_ms);
            sum = [0, 1].map(|wheel| sum[wheel] + held_ms * change.command[wheel]);
            until_ms = change.t_ms;
            if until_ms <= from_ms {
                break;
            }
        }
        sum.map(|sum| sum / (to_ms - from_ms))
    }

    /// Changes every one of them.
    pub fn edit_each(&mut self, change: impl FnMut(&mut CommandChange)) {
        self.0.iter_mut().for_each(change);
    }
}

/// Returns the name of the file beside a run's.
pub fn file_beside(run: &str) -> String {
    format!("commands-{}.csv", run.strip_prefix("run-").unwrap_or(run))
}

/// Returns the name of the run of such a file, without its extension; `None` if the file is not one.
pub fn run_beside(file: &str) -> Option<String> {
    Some(format!("run-{}", file.strip_prefix("commands-")?.strip_suffix(".csv")?))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn changes(changes: &[(f64, f64)]) -> CommandChanges {
        let change = |(t_ms, command): &(f64, f64)| CommandChange { t_ms: *t_ms, command: [*command, -*command] };
        CommandChanges::of(changes.iter().map(change)).expect("changes")
    }

    #[test]
    fn means_are_weighted_by_time_and_rest_comes_first() {
        let changes = changes(&[(100.0, 40.0), (300.0, 80.0), (350.0, 80.0), (500.0, 0.0)]);
        assert_eq!(changes.as_slice().len(), 3, "a repeated command is no change");
        assert_eq!(changes.mean(0.0, 200.0), [20.0, -20.0]);
        assert_eq!(changes.mean(200.0, 400.0), [60.0, -60.0]);
        assert_eq!(changes.mean(400.0, 600.0), [40.0, -40.0]);
        assert_eq!(changes.mean(600.0, 700.0), [0.0, 0.0]);
        assert_eq!(changes.mean(150.0, 250.0), [40.0, -40.0]);
    }

    #[test]
    fn files_are_named_after_their_runs() {
        assert_eq!(file_beside("run-007"), "commands-007.csv");
        assert_eq!(run_beside("commands-007.csv").as_deref(), Some("run-007"));
        assert_eq!(run_beside("run-007.csv"), None);
    }
}
