//! Reads brick logs: runs without poses.

use std::path::{Path, PathBuf};

use mindgap_files as files;
use mindgap_foundations::error::Result;
use mindgap_logs::Run;

/// A brick log.
#[derive(Clone, Debug, PartialEq)]
pub struct BrickLog {
    /// File of the log.
    pub file: PathBuf,
    /// The rows, without poses.
    pub run: Run,
    /// Whether the last line was incomplete and dropped, because power or flash memory ran out.
    pub is_truncated: bool,
}

/// Required columns; the rotation counters are needed to align the clock.
const REQUIRED: [&str; 5] = ["t_ms", "left", "right", "rot_left_deg", "rot_right_deg"];

/// Returns whether a file is a brick log, judging by its first line.
///
/// # Errors
/// When it cannot be read.
pub fn is_brick_log(file: &Path) -> Result<bool> {
    let header = first_line(file)?;
    let has = |name| header.split(',').any(|column| column.trim() == name);
    Ok(has("left") && has("right"))
}

impl BrickLog {
    /// Reads a log; a last line without a line end is dropped.
    ///
    /// # Errors
    /// When a column is missing, fewer than two rows are complete, or a number is invalid.
    pub fn read(file: &Path, warn: impl FnMut(String)) -> Result<Self> {
        let text = files::read_text(file)?;
        let complete = text.rfind('\n').map_or("", |end| &text[..=end]);
        let run = Run::parse(file, complete, &REQUIRED, warn)?;
        Ok(BrickLog { file: file.to_owned(), run, is_truncated: complete.len() < text.len() })
    }
}

/// Returns the first line of a file, or an empty text.
fn first_line(file: &Path) -> Result<String> {
    Ok(files::read_text(file)?.lines().next().unwrap_or_default().to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROWS: &str = "t_ms,left,right,rot_left_deg,rot_right_deg,battery_mv,echo_cm\r\n0,30,30,0,0,8000,\r\n\
                        400,30,30,120,118,8000,87\r\n800,30,30,241,240,8000,8";

    fn read(text: &str) -> Result<BrickLog> {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("run-000.csv");
        files::write(&file, text)?;
        assert!(is_brick_log(&file)?);
        BrickLog::read(&file, |warning| panic!("{warning}"))
    }

    #[test]
    fn truncated_last_line_is_dropped() {
        let truncated = read(ROWS).expect("two complete rows");
        assert!(truncated.is_truncated && truncated.run.rows.len() == 2, "{truncated:?}");
        let complete = read(&format!("{ROWS}7\r\n")).expect("three rows");
        assert!(!complete.is_truncated && complete.run.rows.at(2).echo_cm == Some(87.0), "{complete:?}");
    }

    #[test]
    fn missing_rotation_counters_are_rejected() {
        let error = read("t_ms,left,right,echo_cm\n0,1,1,\n400,1,1,\n").expect_err("no counters");
        assert!(error.to_string().contains(":1: columns rot_left_deg, rot_right_deg are missing"), "{error}");
    }
}
