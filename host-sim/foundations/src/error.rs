//! What can go wrong outside the program: one line, with file and line number where there is one.

use std::path::{Path, PathBuf};

/// Why a command could not do what was asked.
#[derive(Debug, thiserror::Error)]
#[error("{}{what}", self.place())]
pub struct Error {
    file: Option<PathBuf>,
    line: Option<u64>,
    what: String,
}

/// The result of anything that reads what a user gave.
pub type Result<T> = std::result::Result<T, Error>;

impl Error {
    /// An error that lies in no one file.
    pub fn new(what: impl Into<String>) -> Self {
        Error { file: None, line: None, what: what.into() }
    }

    /// An error of a whole file or folder.
    pub fn in_file(file: &Path, what: impl Into<String>) -> Self {
        Error { file: Some(file.to_owned()), line: None, what: what.into() }
    }

    /// An error at a line, counted from 1.
    pub fn at_line(file: &Path, line: u64, what: impl Into<String>) -> Self {
        Error { file: Some(file.to_owned()), line: Some(line), what: what.into() }
    }

    /// The same error, attributed to `file` unless it has a file already.
    pub fn or_in_file(self, file: &Path) -> Self {
        Error { file: self.file.or_else(|| Some(file.to_owned())), ..self }
    }

    /// The same error of a file in a folder that is to be another's: it is named as it would be there.
    pub fn moved(self, from: &Path, to: &Path) -> Self {
        let there = self.file.as_deref().and_then(|file| file.strip_prefix(from).ok()).map(|file| to.join(file));
        Error { file: there.or(self.file), ..self }
    }

    fn place(&self) -> String {
        match (&self.file, self.line) {
            (Some(file), Some(line)) => format!("{}:{line}: ", file.display()),
            (Some(file), None) => format!("{}: ", file.display()),
            _ => String::new(),
        }
    }
}
