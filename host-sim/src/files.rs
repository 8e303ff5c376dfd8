//! Whole files in and out: reading with a clear problem, and writing so that nothing is ever left half-written.

use std::fs;
use std::io::Write;
use std::path::Path;

use jiff::Timestamp;
use jiff::civil::Date;
use jiff::tz::TimeZone;
use serde::Serialize;
use serde::de::DeserializeOwned;
use tempfile::NamedTempFile;

use crate::error::{Error, Result};

/// The text of a file.
///
/// # Errors
/// When the file is missing, unreadable or no UTF-8.
pub fn read_text(path: &Path) -> Result<String> {
    fs::read_to_string(path).map_err(|e| Error::in_file(path, format!("cannot be read: {e}")))
}

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
        let what = e.message().replace('\n', "; ");
        match e.span() {
            Some(span) => Error::at_line(path, line_at(text, span.start), what),
            None => Error::in_file(path, what),
        }
    })
}

/// The line, from 1, of a byte in a text.
pub fn line_at(text: &str, byte: usize) -> u64 {
    1 + text.bytes().take(byte).filter(|b| *b == b'\n').count() as u64
}

/// Writes a file under a temporary name beside `path`, then renames it.
///
/// # Errors
/// When the folder is missing or not writable; `path` is then as it was.
pub fn write(path: &Path, content: impl AsRef<[u8]>) -> Result<()> {
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let attempt = || -> std::io::Result<()> {
        let mut file = NamedTempFile::new_in(folder)?;
        file.write_all(content.as_ref())?;
        make_readable(file.as_file())?;
        file.persist(path)?;
        Ok(())
    };
    attempt().map_err(|e| {
        // The error's own text would name the temporary file.
        let why =
            if folder.is_dir() { e.kind().to_string() } else { format!("there is no folder {}", folder.display()) };
        Error::in_file(path, format!("cannot be written: {why}"))
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
    let text = read_text(path)?;
    let rows = csv::Reader::from_reader(text.as_bytes()).deserialize().collect::<csv::Result<_>>();
    rows.map_err(|e| csv_error(path, &e))
}

/// What is wrong with a CSV file, and in which line.
pub fn csv_error(path: &Path, e: &csv::Error) -> Error {
    let line = e.position().map_or(1, csv::Position::line);
    let what = match e.kind() {
        csv::ErrorKind::UnequalLengths { expected_len, len, .. } => {
            format!("has {len} cells where the header has {expected_len}: torn or wrong line")
        }
        _ => e.to_string().replace('\n', " "),
    };
    Error::at_line(path, line, what)
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

/// Fills a folder under a temporary name beside `path`, then renames it. A folder that is there already is replaced
/// when `ours` holds for every file name in it, and left alone otherwise.
///
/// # Errors
/// What `fill` returns, when the folder holds something else, or when it cannot be written.
pub fn write_folder(path: &Path, ours: impl Fn(&str) -> bool, fill: impl FnOnce(&Path) -> Result<()>) -> Result<()> {
    let failed = |e: std::io::Error| Error::in_file(path, format!("cannot be written: {e}"));
    if path.exists() {
        for entry in fs::read_dir(path).map_err(failed)? {
            let name = entry.map_err(failed)?.file_name();
            if !name.to_str().is_some_and(&ours) {
                let what = format!("holds {name:?}, which this command did not write: give an empty or new folder");
                return Err(Error::in_file(path, what));
            }
        }
    }
    let parent = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    fs::create_dir_all(parent).map_err(failed)?;
    let workshop = tempfile::tempdir_in(parent).map_err(failed)?;
    let fresh = workshop.path().join("new");
    fs::create_dir(&fresh).map_err(failed)?;
    fill(&fresh)?;
    if path.exists() {
        fs::rename(path, workshop.path().join("old")).map_err(failed)?;
    }
    fs::rename(&fresh, path).map_err(failed)
}

/// Makes a folder unless it is there.
///
/// # Errors
/// When it cannot be made.
pub fn make_folder(path: &Path) -> Result<()> {
    fs::create_dir_all(path).map_err(|e| Error::in_file(path, format!("cannot be made: {e}")))
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

/// Temporary files are private to their owner; what is written here is as readable as any new file.
fn make_readable(file: &fs::File) -> std::io::Result<()> {
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        file.set_permissions(fs::Permissions::from_mode(0o644))?;
    }
    let _ = file;
    Ok(())
}
