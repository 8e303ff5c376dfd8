//! `run-*.csv`: one run of a robot (docs/reference/formats.md).

use std::io::Read;
use std::iter;
use std::path::Path;
use std::sync::Arc;

use csv::{StringRecord, Writer};

use super::columns::{COLUMNS, Columns, REQUIRED, REQUIRED_WITHOUT_SENSOR, cells, column_names, two_decimals};
use super::commands;
use super::range_sensor::Sensors;
use super::rows::Rows;
use mindgap_files::{self as files, Records, TextFile};
use mindgap_foundations::error::{Error, Result};

/// One run of a robot: at least two rows in temporal order.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// File name without its extension; in logs of several sessions after the folder and a slash.
    pub name: String,
    /// The rows.
    pub rows: Rows,
}

impl Run {
    /// Reads a run. `warn` receives a line for each unknown column and other irregularity.
    ///
    /// # Errors
    /// When the file cannot be read, lacks a column, has fewer than two rows, or has an invalid number.
    pub fn read(path: &Path, warn: impl FnMut(String)) -> Result<Self> {
        Run::read_with(path, &COLUMNS[..REQUIRED], warn)
    }

    /// Reads a run that must have the `required` columns.
    ///
    /// # Errors
    /// As [`Run::read`].
    pub fn read_with(path: &Path, required: &[&str], warn: impl FnMut(String)) -> Result<Self> {
        Run::read_of(path, required, &Arc::default(), warn).map(|(run, _)| run)
    }

    /// Reads a run of a robot with these range sensors.
    ///
    /// # Errors
    /// As [`Run::read`].
    pub fn read_by(path: &Path, sensors: &Sensors) -> Result<Self> {
        let required = if sensors.are_usual() { REQUIRED } else { REQUIRED_WITHOUT_SENSOR };
        Run::read_of(path, &COLUMNS[..required], &Arc::new(sensors.clone()), |_| ()).map(|(run, _)| run)
    }

    /// Reads a run of a robot with these range sensors, and whether each of them has a column.
    ///
    /// # Errors
    /// As [`Run::read`].
    pub fn read_of(
        path: &Path,
        required: &[&str],
        sensors: &Arc<Sensors>,
        mut warn: impl FnMut(String),
    ) -> Result<(Self, Vec<bool>)> {
        let mut text = TextFile::open(path)?;
        if text.had_bom {
            warn(format!("{}: starts with a byte-order mark (ignored)", path.display()));
        }
        let (rows, have_echoes) = rows(path, &mut text, required, sensors, &mut warn)?;
        if text.last != Some(b'\n') {
            warn(format!(
                "{}: the last line has no line end; if it was cut off, its last number may be wrong",
                path.display()
            ));
        }
        Ok((Run { name: name_of(path), rows }, have_echoes))
    }

    /// Parses the text of a file that must have the `required` columns; `path` is for messages and the run's name.
    ///
    /// # Errors
    /// As [`Run::read`].
    pub fn parse(path: &Path, text: &str, required: &[&str], warn: impl FnMut(String)) -> Result<Self> {
        Run::parse_of(path, text, required, &Arc::default(), warn).map(|(run, _)| run)
    }

    /// Parses the text of a file of a robot with these range sensors, and whether each of them has a column; `path` is for messages
    /// and the run's name.
    ///
    /// # Errors
    /// As [`Run::read`].
    pub fn parse_of(
        path: &Path,
        text: &str,
        required: &[&str],
        sensors: &Arc<Sensors>,
        mut warn: impl FnMut(String),
    ) -> Result<(Self, Vec<bool>)> {
        let (rows, have_echoes) = rows(path, text.as_bytes(), required, sensors, &mut warn)?;
        Ok((Run { name: name_of(path), rows }, have_echoes))
    }

    /// Writes a run.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn write(&self, path: &Path) -> Result<()> {
        files::write(path, self.to_text())
    }

    /// Returns the names and texts of its files: that of its rows, and that of its commands where their own times are known.
    pub fn files(&self) -> impl Iterator<Item = (String, String)> {
        let commands = self.rows.changes().map(|changes| (commands::file_beside(&self.name), changes.to_text()));
        iter::once((format!("{}.csv", self.name), self.to_text())).chain(commands)
    }

    /// Returns the text of the run's file; an optional column is included if any row has a value.
    pub fn to_text(&self) -> String {
        let names = column_names(self.rows.sensors());
        let rows: Vec<Vec<Option<f64>>> = self.cells().collect();
        // An empty column is one of a sensor that heard nothing, a missing one is not compared.
        let is_needed = |c: usize| c < REQUIRED || c >= COLUMNS.len();
        let is_written = |c: &usize| is_needed(*c) || rows.iter().any(|row| row[*c].is_some());
        let written: Vec<usize> = (0..names.len()).filter(is_written).collect();
        let mut writer = Writer::from_writer(Vec::new());
        let header = written.iter().map(|c| names[*c].clone()).collect();
        let row = |row: &Vec<Option<f64>>| {
            written.iter().map(|c| row[*c].map_or(String::new(), two_decimals)).collect::<Vec<String>>()
        };
        for record in iter::once(header).chain(rows.iter().map(row)) {
            writer.write_record(record).expect("rows of one length, into memory");
        }
        let bytes = writer.into_inner().expect("into memory");
        String::from_utf8(bytes).expect("names and numbers")
    }

    /// Returns the cells of its rows, in the order of [`column_names`].
    pub(super) fn cells(&self) -> impl Iterator<Item = Vec<Option<f64>>> {
        let further = 0..self.rows.sensors().further().len();
        self.rows.iter().enumerate().map(move |(k, row)| {
            let readings_cm = further.clone().map(|sensor| self.rows.further_cm(sensor, k));
            cells(&row).into_iter().chain(readings_cm).collect()
        })
    }

    /// Returns the text of a script that drives the same commands: `t_ms` from the first row on, `left` and `right`, each held
    /// until the next row; the last row is at rest.
    pub fn script_text(&self) -> String {
        let first_ms = self.rows.first().map_or(0.0, |row| row.t_ms);
        let last_ms = self.rows.last().map_or(0.0, |row| row.t_ms);
        let changes = self.rows.changes().map_or(&[][..], |changes| changes.before(last_ms));
        let at_rows = self.rows.iter().take(if changes.is_empty() { self.rows.len() - 1 } else { 0 });
        let at_rows = at_rows.map(|row| (row.t_ms, row.command()));
        let held = at_rows.chain(changes.iter().map(|change| (change.t_ms, change.command)));
        let held = held.map(|(t_ms, [left, right])| format!("{},{left},{right}\n", (t_ms - first_ms).max(0.0)));
        format!("t_ms,left,right\n{}{},0,0\n", held.collect::<String>(), last_ms - first_ms)
    }

    /// Returns the folder of its session, where logs are of several; otherwise nothing.
    pub fn session(&self) -> &str {
        self.name.rsplit_once('/').map_or("", |(folder, _)| folder)
    }

    /// Returns the left and right command of the row before `k`. At the first row these are zeros, since motors start from
    /// rest, unless a command is known to be older.
    pub fn previous_command(&self, k: usize) -> [f64; 2] {
        if k == 0 { self.rows.command_before_start() } else { self.rows.at(k - 1).command() }
    }
}

/// Reads rows one by one, so that the text of a long run is never in memory as a whole.
fn rows(
    path: &Path,
    text: impl Read,
    required: &[&str],
    sensors: &Arc<Sensors>,
    warn: &mut impl FnMut(String),
) -> Result<(Rows, Vec<bool>)> {
    let mut records = Records::new(path, text);
    let header = records.header()?;
    let columns = Columns::find(path, &header, required, sensors, warn)?;
    let mut rows = Rows::of(Arc::clone(sensors));
    let mut record = StringRecord::new();
    while let Some(line) = records.read(&mut record)? {
        let row = columns.row(&record).map_err(|what| Error::at_line(path, line, what))?;
        if let Some(before) = rows.last().filter(|before| row.t_ms <= before.t_ms) {
            let what = if row.t_ms == before.t_ms {
                format!("t_ms = {} is duplicated: write each row once", row.t_ms)
            } else {
                let (t_ms, before_ms) = (row.t_ms, before.t_ms);
                format!("t_ms = {t_ms} is not later than the row before ({before_ms}): write each run to its own file")
            };
            return Err(Error::at_line(path, line, what));
        }
        rows.push(row);
        for (sensor, reading_cm) in columns.further_cm(&record).enumerate() {
            let reading_cm = reading_cm.map_err(|what| Error::at_line(path, line, what))?;
            rows.set_further_cm(sensor, rows.len() - 1, reading_cm);
        }
    }
    if rows.len() < 2 {
        return Err(Error::in_file(path, format!("has {} row(s); a run needs at least two", rows.len())));
    }
    rows.shrink();
    Ok((rows, columns.have_echoes().collect()))
}

fn name_of(path: &Path) -> String {
    path.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Row;

    #[test]
    fn a_script_begins_at_zero_and_ends_at_rest() {
        let row = |k: u32| Row { t_ms: 70.0 + 400.0 * f64::from(k), left: 50.0, right: -12.5, ..Row::default() };
        let run = Run { name: "run-003".into(), rows: (0..3).map(row).collect() };
        assert_eq!(run.script_text(), "t_ms,left,right\n0,50,-12.5\n400,50,-12.5\n800,0,0\n");
    }
}
