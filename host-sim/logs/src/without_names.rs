//! The files of logs without names and comments, for people who give logs to others.

use std::path::Path;

use csv::{StringRecord, Writer};

use super::columns::{COMMAND_COLUMNS, column_names};
use super::commands::file_beside;
use super::robot::Robot;
use super::run::Run;
use super::scene::Scene;
use mindgap_files::{self as files, Records, TextFile};
use mindgap_foundations::error::{Error, Result};

/// Least number of digits in the names of runs.
const DIGITS: usize = 3;

/// The files of a folder of logs, as name and text.
pub type Texts = Vec<(String, String)>;

/// Returns the files of a folder of logs whose runs are these: runs are numbered in their order, numbers are as they are written, and
/// comments and columns that nothing reads are left out. The names of range sensors stay, since columns have them.
///
/// # Errors
/// When a file cannot be read.
pub fn texts(folder: &Path, runs: &[Run]) -> Result<Texts> {
    let (robot, sensors) = Robot::read_all(&folder.join("robot.toml"))?;
    let scene = Scene::read(&folder.join("scene.toml"))?;
    let mut texts =
        vec![("robot.toml".to_owned(), robot.to_text_with(&sensors)), ("scene.toml".to_owned(), scene.to_text())];
    for (run, name) in runs.iter().zip(numbered(runs.len())) {
        let stem = run.name.rsplit('/').next().unwrap_or_default();
        let file = format!("{stem}.csv");
        texts.push((format!("{name}.csv"), known_columns(&folder.join(file), &column_names(&sensors))?));
        let commands = folder.join(file_beside(stem));
        if files::source::is_file(&commands) {
            let known: Vec<String> = COMMAND_COLUMNS.map(str::to_owned).into();
            texts.push((file_beside(&name), known_columns(&commands, &known)?));
        }
    }
    Ok(texts)
}

/// Returns the names of runs by their numbers, which the alphabet leaves in this order.
pub fn numbered(runs: usize) -> impl Iterator<Item = String> {
    let digits = runs.saturating_sub(1).to_string().len().max(DIGITS);
    (0..runs).map(move |run| format!("run-{run:0digits$}"))
}

/// Returns the text of a table with these of its columns alone, each cell as it is written.
fn known_columns(path: &Path, known: &[String]) -> Result<String> {
    let mut records = Records::new(path, TextFile::open(path)?);
    let header = records.header()?;
    let kept: Vec<usize> = (0..header.len()).filter(|c| known.iter().any(|name| *name == header[*c])).collect();
    let mut writer = Writer::from_writer(Vec::new());
    let mut write = |record: &StringRecord| {
        let written = writer.write_record(kept.iter().map(|c| &record[*c]));
        written.map_err(|e| Error::in_file(path, e.to_string()))
    };
    write(&header)?;
    let mut record = StringRecord::new();
    while records.read(&mut record)?.is_some() {
        write(&record)?;
    }
    let bytes = writer.into_inner().map_err(|e| Error::in_file(path, e.to_string()))?;
    String::from_utf8(bytes).map_err(|e| Error::in_file(path, e.to_string()))
}
