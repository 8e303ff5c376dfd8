//! The error of everything that reads user input: one line, with the file and line number where they are known.

use std::path::{Path, PathBuf};

/// Why a command failed.
#[derive(Debug, thiserror::Error)]
#[error("{}{message}", self.location())]
pub struct Error {
    file: Option<PathBuf>,
    line: Option<u64>,
    message: String,
}

/// The result of anything that reads user input.
pub type Result<T> = std::result::Result<T, Error>;

impl Error {
    /// Returns an error that belongs to no particular file.
    pub fn new(message: impl Into<String>) -> Self {
        Error { file: None, line: None, message: message.into() }
    }

    /// Returns an error about a whole file or folder.
    pub fn in_file(file: &Path, message: impl Into<String>) -> Self {
        Error { file: Some(file.to_owned()), line: None, message: message.into() }
    }

    /// Returns an error at a line, counted from 1.
    pub fn at_line(file: &Path, line: u64, message: impl Into<String>) -> Self {
        Error { file: Some(file.to_owned()), line: Some(line), message: message.into() }
    }

    /// Attributes the error to `file` unless it already names one.
    pub fn or_in_file(self, file: &Path) -> Self {
        Error { file: self.file.or_else(|| Some(file.to_owned())), ..self }
    }

    /// Replaces the folder `from` by `to` in the error's path: a file that failed in a staging folder is reported under its final
    /// name.
    pub fn moved(self, from: &Path, to: &Path) -> Self {
        let there = self.file.as_deref().and_then(|file| file.strip_prefix(from).ok()).map(|file| to.join(file));
        Error { file: there.or(self.file), ..self }
    }

    fn location(&self) -> String {
        match (&self.file, self.line) {
            (Some(file), Some(line)) => format!("{}:{line}: ", file.display()),
            (Some(file), None) => format!("{}: ", file.display()),
            _ => String::new(),
        }
    }
}
