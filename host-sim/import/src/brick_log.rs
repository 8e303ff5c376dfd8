//! Reads the log of a brick: the rows of a run without poses.

use std::path::{Path, PathBuf};

use mindgap_files as files;
use mindgap_foundations::error::Result;
use mindgap_logs::Run;

/// A brick's log.
#[derive(Clone, Debug, PartialEq)]
pub struct BrickLog {
    /// Its file.
    pub file: PathBuf,
    /// Its rows, without poses.
    pub run: Run,
    /// Its last line was incomplete and left out: power or flash ran out while it was written.
    pub torn: bool,
}

/// Required columns; the rotation counters are needed to align its clock.
const REQUIRED: [&str; 5] = ["t_ms", "left", "right", "rot_left_deg", "rot_right_deg"];

/// Whether a file is a brick's log, judged by its first line.
///
/// # Errors
/// When it cannot be read.
pub fn is_one(file: &Path) -> Result<bool> {
    let header = first_line(file)?;
    let has = |name| header.split(',').any(|column| column.trim() == name);
    Ok(has("left") && has("right"))
}

impl BrickLog {
    /// Reads a log; a last line without its line end is left out.
    ///
    /// # Errors
    /// When a column is missing, fewer than two rows are complete, or a number is invalid.
    pub fn read(file: &Path, warn: impl FnMut(String)) -> Result<Self> {
        let text = files::read_text(file)?;
        let whole = text.rfind('\n').map_or("", |end| &text[..=end]);
        let run = Run::parse(file, whole, &REQUIRED, warn)?;
        Ok(BrickLog { file: file.to_owned(), run, torn: whole.len() < text.len() })
    }
}

/// The first line of a file; empty for an empty file.
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
        assert!(is_one(&file)?);
        BrickLog::read(&file, |warning| panic!("{warning}"))
    }

    #[test]
    fn a_torn_last_line_is_left_out() {
        let torn = read(ROWS).expect("two rows are whole");
        assert!(torn.torn && torn.run.rows.len() == 2, "{torn:?}");
        let whole = read(&format!("{ROWS}7\r\n")).expect("three rows");
        assert!(!whole.torn && whole.run.rows.at(2).echo_cm == Some(87.0), "{whole:?}");
    }

    #[test]
    fn without_rotation_counters_the_clock_cannot_be_aligned() {
        let error = read("t_ms,left,right,echo_cm\n0,1,1,\n400,1,1,\n").expect_err("no counters");
        assert!(error.to_string().contains(":1: columns rot_left_deg, rot_right_deg are missing"), "{error}");
    }
}
