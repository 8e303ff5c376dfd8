//! What a command finds, for programs.

use std::path::{Path, PathBuf};

use clap::Args;
use serde::Serialize;

use mindgap_files as files;
use mindgap_foundations::error::Result;

/// The option of commands that tell what they found.
#[derive(Args)]
pub struct FactsOption {
    /// Also write the same facts here, for programs; `-` is standard output, in place of the text.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

impl FactsOption {
    /// The file, where one is asked for.
    pub fn asked(&self) -> &Option<PathBuf> {
        &self.json
    }

    /// As [`reported`].
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn told(&self, facts: &impl Serialize, text: String) -> Result<String> {
        reported(self.json.as_deref(), facts, text)
    }
}

/// Writes the facts where that is asked for; returns the `text` that tells them.
///
/// # Errors
/// When the file cannot be written.
pub fn reported(json: Option<&Path>, facts: &impl Serialize, text: String) -> Result<String> {
    json.map_or(Ok(()), |path| files::write_json(path, facts))?;
    Ok(text)
}
