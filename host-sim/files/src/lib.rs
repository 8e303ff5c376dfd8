//! Reads and writes whole files: read errors name file and line, and writes never leave a partial file.

mod input;
mod lock;
mod parser_messages;
pub mod places;
mod records;
pub mod source;
mod staging;
mod stale_temp;
mod temporary;
mod text;
mod write;

use std::path::{Path, PathBuf};

use csv::{ReaderBuilder, StringRecord};
use jiff::Timestamp;
use jiff::civil::Date;
use jiff::tz::TimeZone;
use serde::Serialize;
use serde::de::DeserializeOwned;

pub use input::{absolute, in_folder, open, read_bytes, unreadable};
pub use lock::lock_folder;
pub use parser_messages::did_you_mean;
pub use records::Records;
pub use staging::StagingFolder;
pub use stale_temp::remove_own as remove_temporary;
pub use text::{NOT_UTF8, TextFile, decoded, line_at, read_raw_text, read_text};
pub use write::{disable_writing, is_stream, make_folder, reason, to_standard_output, write, write_folder};

use mindgap_foundations::error::{Error, Result};

/// Reads a TOML file as a `T`.
///
/// # Errors
/// When the file cannot be read, is not TOML, or does not fit `T`; the error names the line.
pub fn read_toml<T: DeserializeOwned>(path: &Path) -> Result<T> {
    from_toml(path, &read_text(path)?)
}

/// Parses the text of a TOML file as a `T`; `path` is for messages.
///
/// # Errors
/// When it is not TOML or does not fit `T`; the error names the line.
pub fn from_toml<T: DeserializeOwned>(path: &Path, text: &str) -> Result<T> {
    toml::from_str(text).map_err(|e| {
        let what = parser_messages::toml_message(e.message());
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

/// Writes rows as CSV; the header holds the field names.
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

/// Returns a value as the text of a JSON file; `path` is for messages.
///
/// # Errors
/// When JSON cannot represent it.
pub fn json(path: &Path, value: &impl Serialize) -> Result<String> {
    let text = serde_json::to_string_pretty(value).map_err(|e| Error::in_file(path, e.to_string()))?;
    Ok(text + "\n")
}

/// Returns the first and last day (UTC) on which the CSV files of folders were modified, or `None` if the file system does not
/// say.
///
/// # Errors
/// When a folder cannot be read.
pub fn days_written(folders: &[PathBuf]) -> Result<Option<[String; 2]>> {
    let mut days: Vec<Date> = Vec::new();
    for folder in folders {
        let names = source::names(folder).map_err(|e| unreadable(folder, &e))?;
        days.extend(names.iter().map(|name| folder.join(name)).filter_map(|path| {
            let time = path.extension().filter(|ending| *ending == "csv").and_then(|_| source::modified(&path))?;
            Some(Timestamp::try_from(time).ok()?.to_zoned(TimeZone::UTC).date())
        }));
    }
    Ok(days.iter().min().zip(days.iter().max()).map(|(first, last)| [first, last].map(Date::to_string)))
}
