//! `run-*.csv`: one run of a robot (docs/formats.md).

use std::io::Read;
use std::iter;
use std::path::Path;

use csv::{StringRecord, Writer};

use super::columns::{COLUMNS, Columns, REQUIRED, cells};
use super::rows::Rows;
use mindgap_files::{self as files, Records, TextFile};
use mindgap_foundations::error::{Error, Result};

/// One run of a robot: at least two rows in order of time.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// File name without its ending.
    pub name: String,
    /// The rows.
    pub rows: Rows,
}

impl Run {
    /// Reads a run. `warn` receives a line for each unknown column and other oddity.
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
    pub fn read_with(path: &Path, required: &[&str], mut warn: impl FnMut(String)) -> Result<Self> {
        let mut text = TextFile::open(path)?;
        if text.had_mark {
            warn(format!("{}: begins with a byte order mark, which is passed over: save it without", path.display()));
        }
        let rows = rows(path, &mut text, required, &mut warn)?;
        if text.last != Some(b'\n') {
            warn(format!(
                "{}: the last line has no line end; if it is torn, its last number may be wrong",
                path.display()
            ));
        }
        Ok(Run { name: name_of(path), rows })
    }

    /// Parses the text of a file that must have the `required` columns; `path` is for messages and the run's name.
    ///
    /// # Errors
    /// As [`Run::read`].
    pub fn parse(path: &Path, text: &str, required: &[&str], mut warn: impl FnMut(String)) -> Result<Self> {
        Ok(Run { name: name_of(path), rows: rows(path, text.as_bytes(), required, &mut warn)? })
    }

    /// Writes a run.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn write(&self, path: &Path) -> Result<()> {
        files::write(path, self.to_text())
    }

    /// The text of its file; an optional column is there if any row has a value.
    pub fn to_text(&self) -> String {
        let cells = || self.rows.iter().map(|row| cells(&row));
        let written: Vec<usize> =
            (0..COLUMNS.len()).filter(|c| *c < REQUIRED || cells().any(|row| row[*c].is_some())).collect();
        let mut writer = Writer::from_writer(Vec::new());
        let header = written.iter().map(|c| COLUMNS[*c].to_owned()).collect();
        let row = |row: [Option<f64>; COLUMNS.len()]| {
            written.iter().map(|c| row[*c].map_or(String::new(), two_decimals)).collect::<Vec<String>>()
        };
        for record in iter::once(header).chain(cells().map(row)) {
            writer.write_record(record).expect("rows of one length, into memory");
        }
        let bytes = writer.into_inner().expect("into memory");
        String::from_utf8(bytes).expect("names and numbers")
    }

    /// Left and right command of the row before `k`; zeros at the first row, since motors start from rest.
    pub fn previous_command(&self, k: usize) -> [f64; 2] {
        if k == 0 { [0.0, 0.0] } else { self.rows.at(k - 1).command() }
    }
}

/// Reads rows one by one: the text of a long run is never there as a whole.
fn rows(path: &Path, text: impl Read, required: &[&str], warn: &mut impl FnMut(String)) -> Result<Rows> {
    let mut records = Records::new(path, text);
    let header = records.header()?;
    let columns = Columns::find(path, &header, required, warn)?;
    let mut rows = Rows::default();
    let mut record = StringRecord::new();
    while let Some(line) = records.read(&mut record)? {
        let row = columns.row(&record).map_err(|what| Error::at_line(path, line, what))?;
        if let Some(before) = rows.last().filter(|before| row.t_ms <= before.t_ms) {
            let what = if row.t_ms == before.t_ms {
                format!("t_ms = {} stands twice: write every row once", row.t_ms)
            } else {
                let (t_ms, before_ms) = (row.t_ms, before.t_ms);
                format!(
                    "t_ms = {t_ms} does not come after the row before ({before_ms}): give every run a file of its own"
                )
            };
            return Err(Error::at_line(path, line, what));
        }
        rows.push(row);
    }
    if rows.len() < 2 {
        return Err(Error::in_file(path, format!("has {} row(s); a run needs at least two", rows.len())));
    }
    rows.shrink();
    Ok(rows)
}

fn name_of(path: &Path) -> String {
    path.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}

/// Numbers are written with at most two decimals, the precision of trackers and readings.
fn two_decimals(value: f64) -> String {
    let text = format!("{value:.2}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".into() } else { text.into() }
}
