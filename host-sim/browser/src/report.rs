//! What is reported to the page.

use std::path::Path;

use mindgap_foundations::error::Result;
use mindgap_import::draft;
use mindgap_logs::{LogFiles, Logs};
use serde::Serialize;

use crate::drive::Drives;

/// A message to the page.
#[derive(Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Report {
    /// How far the work is, 0..=1, and what is being done.
    Progress(f64, String),
    /// A warning.
    Warning(String),
    /// Why there is no answer.
    Error(String),
    /// The answer; nothing follows.
    Answer(Answer),
}

/// The answer to a request.
#[derive(Default, Serialize)]
pub struct Answer {
    /// What the subcommand prints.
    pub text: String,
    /// What it writes with `--json`.
    pub json: Option<String>,
    /// What it writes with `--html`.
    pub page: Option<String>,
    /// The files that it writes into a folder, as names and texts.
    pub files: Option<LogFiles>,
    /// The drives of the logs.
    pub drives: Option<Drives>,
    /// Those of a robot without faults that gets the same commands.
    pub sound_drives: Option<Drives>,
}

/// Reports messages.
pub type Reporter<'a> = &'a dyn Fn(Report);

/// Reads a folder of logs and reports its oddities.
///
/// # Errors
/// When it cannot be read.
pub fn read_logs(folder: &Path, report: Reporter) -> Result<Logs> {
    let warn = |warning| report(Report::Warning(warning));
    let logs = Logs::read(folder, warn)?;
    draft::warning(folder)?.into_iter().for_each(warn);
    Ok(logs)
}
