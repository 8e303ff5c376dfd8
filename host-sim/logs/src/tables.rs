//! Runs as tables of columns in memory, for programs that keep logs in arrays instead of files.

use std::path::Path;

use csv::Writer;

use super::columns::column_names;
use super::range_sensor::Sensors;
use super::{Logs, Robot, Run, Scene};
use mindgap_foundations::error::{Error, Result};

/// Name of logs without a folder in messages.
const IN_MEMORY: &str = "logs";

/// A run as columns, named as in `run-*.csv`. NaN is an empty cell.
pub struct Table {
    /// Name of the run.
    pub name: String,
    /// The columns, all of the same length.
    pub columns: Vec<(String, Vec<f64>)>,
}

impl Logs {
    /// Builds logs from tables, with the checks of [`Logs::read`]; line 2 in a message is the first row of a table.
    ///
    /// # Errors
    /// As [`Logs::read`], or when the columns of a table differ in length.
    pub fn from_tables(robot: Robot, scene: Scene, tables: &[Table], mut warn: impl FnMut(String)) -> Result<Self> {
        if tables.is_empty() {
            return Err(Error::in_file(Path::new(IN_MEMORY), "there is no run"));
        }
        let required = robot.required_columns(&Sensors::default());
        let read = |table: &Table| Run::parse(Path::new(&table.name), &table.text()?, required, &mut warn);
        let runs = tables.iter().map(read).collect::<Result<_>>()?;
        Logs { robot, scene, runs }.checked(Path::new(IN_MEMORY), warn)
    }
}

impl Table {
    /// Converts a run to a table; a column is included if any row has a value.
    pub fn from_run(run: &Run) -> Self {
        let (names, rows) = (column_names(run.rows.sensors()), run.cells().collect::<Vec<_>>());
        let column = |c: usize| rows.iter().map(|row| row[c].unwrap_or(f64::NAN)).collect();
        let written = (0..names.len()).filter(|c| rows.iter().any(|row| row[*c].is_some()));
        Table { name: run.name.clone(), columns: written.map(|c| (names[c].clone(), column(c))).collect() }
    }

    /// Returns the table as the text of a file at full precision, so that cells are validated in one place.
    fn text(&self) -> Result<String> {
        let located = |what: String| Error::in_file(Path::new(&self.name), what);
        let length = self.columns.first().map_or(0, |(_, first)| first.len());
        if let Some((name, values)) = self.columns.iter().find(|(_, values)| values.len() != length) {
            return Err(located(format!("column {name} has {} rows, but the first has {length}", values.len())));
        }
        let failed = |e: csv::Error| located(e.to_string());
        let mut writer = Writer::from_writer(Vec::new());
        writer.write_record(self.columns.iter().map(|(name, _)| name)).map_err(failed)?;
        let cell = |value: f64| if value.is_nan() { String::new() } else { value.to_string() };
        for row in 0..length {
            writer.write_record(self.columns.iter().map(|(_, values)| cell(values[row]))).map_err(failed)?;
        }
        let bytes = writer.into_inner().map_err(|e| located(e.to_string()))?;
        String::from_utf8(bytes).map_err(|e| located(e.to_string()))
    }
}
