//! Whole files in and out: reading with a clear problem, and writing so that nothing is ever left half-written.

mod leftovers;
pub mod places;
mod records;
mod temporary;
mod text;
mod words;
mod workshop;
mod write;

use std::fs;
use std::path::Path;

use csv::{ReaderBuilder, StringRecord};
use jiff::Timestamp;
use jiff::civil::Date;
use jiff::tz::TimeZone;
use serde::Serialize;
use serde::de::DeserializeOwned;

pub use leftovers::remove_ours as remove_temporary;
pub use records::Records;
pub use text::{NO_UTF8, TextFile, line_at, read_text};
pub use words::did_you_mean;
pub use write::{is_stream, leave_writing, make_folder, reason, to_standard_output, write, write_folder};

use mindgap_foundations::error::{Error, Result};

/// A TOML file as a `T`; a problem names the line.
///
/// # Errors
/// When the file cannot be read, is no TOML, or lacks what `T` needs.
pub fn read_toml<T: DeserializeOwned>(path: &Path) -> Result<T> {
    from_toml(path, &read_text(path)?)
}

/// The text of a TOML file as a `T`; a problem names the line.
///
/// # Errors
/// When it is no TOML, or lacks what `T` needs.
pub fn from_toml<T: DeserializeOwned>(path: &Path, text: &str) -> Result<T> {
    toml::from_str(text).map_err(|e| {
        let what = words::of_toml(e.message());
        match e.span() {
            Some(span) => Error::at_line(path, line_at(text, span.start), what),
            None => Error::in_file(path, what),
        }
    })
}

/// Reads a JSON file.
///
/// # Errors
/// When it is missing or not of the expected form.
pub fn read_json<T: DeserializeOwned>(path: &Path) -> Result<T> {
    let text = read_text(path)?;
    serde_json::from_str(&text).map_err(|e| Error::at_line(path, e.line() as u64, e.to_string()))
}

/// Writes rows as CSV under their fields' names.
///
/// # Errors
/// As [`write()`].
pub fn write_csv(path: &Path, rows: &[impl Serialize]) -> Result<()> {
    let mut table = csv::Writer::from_writer(Vec::new());
    for row in rows {
        table.serialize(row).map_err(|e| Error::in_file(path, e.to_string()))?;
    }
    write(path, table.into_inner().map_err(|e| Error::in_file(path, e.to_string()))?)
}

/// Reads what [`write_csv`] wrote.
///
/// # Errors
/// When the file is missing or a row is not of the expected form.
pub fn read_csv<T: DeserializeOwned>(path: &Path) -> Result<Vec<T>> {
    let mut records = Records::with(path, TextFile::open(path)?, &ReaderBuilder::new());
    let header = records.header()?;
    let (mut record, mut rows) = (StringRecord::new(), Vec::new());
    while let Some(line) = records.read(&mut record)? {
        rows.push(record.deserialize(Some(&header)).map_err(|e| Error::at_line(path, line, e.to_string()))?);
    }
    Ok(rows)
}

/// Writes a value as JSON.
///
/// # Errors
/// As [`write()`].
pub fn write_json(path: &Path, value: &impl Serialize) -> Result<()> {
    write(path, json(path, value)?)
}

/// A value as the text of a JSON file.
///
/// # Errors
/// When it has no form in JSON; the message names `path`.
pub fn json(path: &Path, value: &impl Serialize) -> Result<String> {
    let text = serde_json::to_string_pretty(value).map_err(|e| Error::in_file(path, e.to_string()))?;
    Ok(text + "\n")
}

/// The first and the last day (UTC) on which the CSV files of a folder were written; none where the file system does not
/// tell.
///
/// # Errors
/// When the folder cannot be read.
pub fn days_written(folder: &Path) -> Result<Option<[String; 2]>> {
    let listing = fs::read_dir(folder).map_err(|e| Error::in_file(folder, format!("cannot be read: {e}")))?;
    let days = listing.filter_map(|entry| {
        let entry = entry.ok().filter(|entry| entry.path().extension().is_some_and(|ending| ending == "csv"))?;
        let time = entry.metadata().ok()?.modified().ok()?;
        Some(Timestamp::try_from(time).ok()?.to_zoned(TimeZone::UTC).date())
    });
    let days: Vec<Date> = days.collect();
    Ok(days.iter().min().zip(days.iter().max()).map(|(first, last)| [first, last].map(Date::to_string)))
}
