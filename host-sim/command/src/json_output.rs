//! The option `--json`: results for programs.

use std::path::{Path, PathBuf};

use clap::Args;
use serde::Serialize;

use mindgap_files as files;
use mindgap_foundations::error::{Error, Result};

/// The option `--json` of commands with results.
#[derive(Args)]
pub struct JsonOption {
    /// Write the results as JSON (`-`: to standard output, instead of the text).
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

impl JsonOption {
    /// Returns the requested file, if any.
    pub fn path(&self) -> &Option<PathBuf> {
        &self.json
    }

    /// Writes `results` to the requested file, if any, and returns `text`.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn emit(&self, results: &impl Serialize, text: String) -> Result<String> {
        emit(self.json.as_deref(), results, text)
    }

    /// As [`emit`](Self::emit), with the keys of all objects in alphabetical order.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn emit_sorted(&self, results: &impl Serialize, text: String) -> Result<String> {
        emit_sorted(self.json.as_deref(), results, text)
    }
}

/// As [`emit`], with the keys of all objects in alphabetical order.
///
/// # Errors
/// If the file cannot be written.
pub fn emit_sorted(json: Option<&Path>, results: &impl Serialize, text: String) -> Result<String> {
    let sorted = |path| {
        let value = serde_json::to_value(results);
        value.map_err(|e| Error::in_file(path, format!("cannot be written: {e}")))
    };
    emit(json, &json.map(sorted).transpose()?, text)
}

/// Writes `results` to `json`, if given, and returns `text`.
///
/// # Errors
/// If the file cannot be written.
fn emit(json: Option<&Path>, results: &impl Serialize, text: String) -> Result<String> {
    json.map_or(Ok(()), |path| files::write_json(path, results))?;
    Ok(text)
}
