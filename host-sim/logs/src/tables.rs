//! Runs as tables in memory, column by column: for programs that keep logs in arrays and not in files.

use std::path::Path;

use csv::Writer;

use super::columns::{COLUMNS, cells};
use super::{Logs, Robot, Run, Scene};
use mindgap_foundations::error::{Error, Result};

/// What messages call logs that stand in no folder.
const IN_MEMORY: &str = "logs";

/// A run: its name, and its columns by the names of `run-*.csv`. NaN is an empty cell.
pub struct Table {
    /// Name of the run.
    pub name: String,
    /// The columns, equally long.
    pub columns: Vec<(String, Vec<f64>)>,
}

impl Logs {
    /// Logs of tables, with the checks of [`Logs::read`]; line 2 in a message is a table's first row.
    ///
    /// # Errors
    /// As [`Logs::read`], or when the columns of a table are not equally long.
    pub fn of_tables(robot: Robot, scene: Scene, tables: &[Table], mut warn: impl FnMut(String)) -> Result<Self> {
        if tables.is_empty() {
            return Err(Error::in_file(Path::new(IN_MEMORY), "there is no run"));
        }
        let required = robot.required_columns();
        let read = |table: &Table| Run::parse(Path::new(&table.name), &table.text()?, required, &mut warn);
        let runs = tables.iter().map(read).collect::<Result<_>>()?;
        Logs { robot, scene, runs }.checked(Path::new(IN_MEMORY), warn)
    }
}

impl Table {
    /// A run as a table; a column is in it if any row has a value there.
    pub fn of(run: &Run) -> Self {
        let rows: Vec<_> = run.rows.iter().map(|row| cells(&row)).collect();
        let column = |c: usize| rows.iter().map(|row| row[c].unwrap_or(f64::NAN)).collect();
        let written = (0..COLUMNS.len()).filter(|c| rows.iter().any(|row| row[*c].is_some()));
        Table { name: run.name.clone(), columns: written.map(|c| (COLUMNS[c].into(), column(c))).collect() }
    }

    /// The same as the text of a file, with every digit: one place decides what a cell may say.
    fn text(&self) -> Result<String> {
        let named = |what: String| Error::in_file(Path::new(&self.name), what);
        let length = self.columns.first().map_or(0, |(_, first)| first.len());
        if let Some((name, values)) = self.columns.iter().find(|(_, values)| values.len() != length) {
            return Err(named(format!("column {name} has {} rows, and the first has {length}", values.len())));
        }
        let failed = |e: csv::Error| named(e.to_string());
        let mut writer = Writer::from_writer(Vec::new());
        writer.write_record(self.columns.iter().map(|(name, _)| name)).map_err(failed)?;
        let cell = |value: f64| if value.is_nan() { String::new() } else { value.to_string() };
        for row in 0..length {
            writer.write_record(self.columns.iter().map(|(_, values)| cell(values[row]))).map_err(failed)?;
        }
        let bytes = writer.into_inner().map_err(|e| named(e.to_string()))?;
        String::from_utf8(bytes).map_err(|e| named(e.to_string()))
    }
}
