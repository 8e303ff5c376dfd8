//! Everything of an input that is not used, with the reason.

use std::path::Path;

use schemars::JsonSchema;
use serde::Serialize;

use mindgap_foundations::error::Error;

/// Something that was not used.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct LeftOut {
    /// Kind of the thing.
    pub what: What,
    /// Its name; for rows, a short description.
    pub name: String,
    /// Number of rows or messages concerned; null where they were not counted.
    pub rows: Option<usize>,
    /// Why it was not used.
    pub reason: String,
    /// The file or topic that it belongs to; null for whole files and topics.
    pub source: Option<String>,
}

/// Kinds of things that are not used.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum What {
    /// A topic of a bag.
    Topic,
    /// A column of a table.
    Column,
    /// A body of a motion capture.
    Body,
    /// Rows or messages.
    Row,
    /// A file.
    File,
}

impl LeftOut {
    /// Describes rows.
    pub fn rows(name: &str, rows: usize, reason: impl Into<String>) -> Self {
        LeftOut { what: What::Row, name: name.into(), rows: Some(rows), reason: reason.into(), source: None }
    }

    /// Describes a column.
    pub fn column(name: &str, reason: impl Into<String>) -> Self {
        LeftOut { what: What::Column, name: name.into(), rows: None, reason: reason.into(), source: None }
    }

    /// Describes a body.
    pub fn body(name: &str, rows: Option<usize>, reason: impl Into<String>) -> Self {
        LeftOut { what: What::Body, name: name.into(), rows, reason: reason.into(), source: None }
    }

    /// Describes messages of a topic.
    pub fn topic(name: &str, messages: usize, reason: impl Into<String>) -> Self {
        LeftOut { what: What::Topic, name: name.into(), rows: Some(messages), reason: reason.into(), source: None }
    }

    /// Describes a file.
    pub fn file(file: &Path, reason: impl Into<String>) -> Self {
        LeftOut { what: What::File, name: file.display().to_string(), rows: None, reason: reason.into(), source: None }
    }

    /// Describes a file that cannot be used.
    pub fn failed(file: &Path, error: &Error) -> Self {
        let text = error.to_string();
        let reason = text.strip_prefix(&format!("{}:", file.display())).unwrap_or(&text).trim_start();
        let line = reason.split_once(": ").filter(|(line, _)| line.bytes().all(|b| b.is_ascii_digit()));
        LeftOut::file(file, line.map_or_else(|| reason.to_owned(), |(line, what)| format!("line {line}: {what}")))
    }

    /// Attributes it to a file.
    pub fn of(self, file: &Path) -> Self {
        LeftOut { source: Some(file.display().to_string()), ..self }
    }

    /// Returns the line of the report.
    pub fn line(&self) -> String {
        let LeftOut { what, name, rows, reason, .. } = self;
        match (what, rows) {
            (What::Row, Some(1)) => format!("1 row ({name}): {reason}"),
            (What::Row, _) => format!("{} rows ({name}): {reason}", rows.unwrap_or(0)),
            (What::Topic, Some(rows)) => format!("{rows} messages of {name}: {reason}"),
            (What::Topic, None) => format!("topic {name}: {reason}"),
            (What::Column, _) => format!("column {name}: {reason}"),
            (What::Body, _) => format!("body {name}: {reason}"),
            (What::File, _) => format!("{name}: {reason}"),
        }
    }
}
