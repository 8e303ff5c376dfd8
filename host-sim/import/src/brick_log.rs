//! Reads brick logs: runs without poses.

use std::path::{Path, PathBuf};

use super::table::read_source;
use mindgap_foundations::error::{Error, Result};
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

/// Returns whether a file is a brick log, judging by its header.
///
/// # Errors
/// When it cannot be read.
pub fn is_brick_log(file: &Path) -> Result<bool> {
    Ok(header_line(&read_source(file)?).is_some())
}

/// Returns the number of the header's line, from 0. A hub without files prints its log, so other output may surround it.
fn header_line(text: &str) -> Option<usize> {
    let is_header = |line: &str| {
        let has = |name| line.split(',').any(|column| column.trim() == name);
        has("t_ms") && has("left") && has("right")
    };
    text.lines().position(is_header)
}

impl BrickLog {
    /// Reads a log; a last line without a line end is dropped, and so is an incomplete row at the end of a printed log.
    ///
    /// # Errors
    /// When a column is missing, fewer than two rows are complete, or a number is invalid.
    pub fn read(file: &Path, warn: impl FnMut(String)) -> Result<Self> {
        let text = read_source(file)?;
        let complete = text.rfind('\n').map_or("", |end| &text[..=end]);
        let first = header_line(complete).unwrap_or_default();
        let lines: Vec<&str> = complete.lines().collect();
        let counters = &REQUIRED[3..];
        let header = lines.get(first).copied().unwrap_or_default();
        if !counters.iter().any(|name| header.contains(name)) {
            let missing = counters.join(", ");
            let what =
                format!("columns {missing} are missing: for a robot without counters use `mindgap import streams`");
            return Err(Error::at_line(file, first as u64 + 1, what));
        }
        let cells = |line: &str| line.split(',').count();
        let is_row = |line: &str| line.starts_with(|first: char| first.is_ascii_digit());
        let mut last = lines.iter().rposition(|line| is_row(line)).unwrap_or(first).max(first);
        let is_cut = last > first && cells(lines[last]) < cells(lines[first]);
        last -= usize::from(is_cut);
        // Empty lines in place of those before the header keep the numbers of lines in messages.
        let log: Vec<&str> =
            lines.iter().take(last + 1).enumerate().map(|(at, line)| if at < first { "" } else { *line }).collect();
        let run = Run::parse(file, &log.join("\n"), &REQUIRED, warn)?;
        let is_truncated = is_cut || complete.len() < text.len();
        Ok(BrickLog { file: file.to_owned(), run, is_truncated })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mindgap_files as files;

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
    fn output_around_a_printed_log_is_dropped() {
        let rows = ROWS.replace("\r\n", "\n");
        let printed = read(&format!("100%|####| 4.2k/4.2k\n\n{rows}7\nfinished\n")).expect("three rows");
        assert!(!printed.is_truncated && printed.run.rows.len() == 3, "{printed:?}");
        let cut = read(&format!("{rows}7\n1200,30,3\nThe hub was disconnected.\n")).expect("three rows");
        assert!(cut.is_truncated && cut.run.rows.len() == 3, "{cut:?}");
        let wrong = read(&format!("Connecting\n{rows}7\n1200,thirty,30,0,0,8000,\n1600,0,0,0,0,8000,\nfinished\n"));
        assert!(wrong.expect_err("a command that is not a number").to_string().contains(":6: "));
    }

    #[test]
    fn missing_rotation_counters_are_rejected() {
        let error = read("t_ms,left,right,echo_cm\n0,1,1,\n400,1,1,\n").expect_err("no counters");
        assert!(error.to_string().contains(":1: columns rot_left_deg, rot_right_deg are missing"), "{error}");
    }
}
