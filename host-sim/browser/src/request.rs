//! Requests of the page.

use std::path::PathBuf;

use mindgap_foundations::error::Result;
use serde::Deserialize;

use crate::report::{Answer, Reporter};
use crate::{archive, check, diagnose, import, record, train};

/// A request, by the name of the subcommand that does the same.
#[derive(Deserialize)]
#[serde(tag = "command", rename_all = "snake_case", deny_unknown_fields)]
pub enum Request {
    /// Lists the files of a ZIP archive.
    Archive {
        /// The archive.
        path: PathBuf,
    },
    /// Checks a folder of logs.
    Check {
        /// The folder.
        logs: PathBuf,
    },
    /// Diagnoses the gap between a simulator and logs.
    Diagnose {
        /// The simulator file, or nothing for the textbook.
        simulator: Option<PathBuf>,
        /// The folders of logs.
        logs: Vec<PathBuf>,
    },
    /// Imports recordings as logs.
    Import(import::Import),
    /// Records logs of the built-in robot.
    Record(record::Record),
    /// Lists the faults of the built-in robot.
    Faults,
    /// Trains a simulator.
    Train {
        /// The folder of logs.
        logs: PathBuf,
    },
}

/// Answers a request.
///
/// # Errors
/// When the files do not allow it; the error is one line.
pub fn answer(request: &Request, report: Reporter) -> Result<Answer> {
    match request {
        Request::Archive { path } => archive::answer(path),
        Request::Check { logs } => check::answer(logs, report),
        Request::Diagnose { simulator, logs } => diagnose::answer(simulator.as_deref(), logs, report),
        Request::Import(import) => import.answer(report),
        Request::Record(record) => record.answer(),
        Request::Faults => record::faults(),
        Request::Train { logs } => train::answer(logs, report),
    }
}
