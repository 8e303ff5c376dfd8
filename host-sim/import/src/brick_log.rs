//! Reads brick logs: runs without poses.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use mindgap_foundations::error::{Error, Result};
use mindgap_logs::Run;
use mindgap_logs::range_sensor::{ECHO, Sensors, column_of};

/// A brick log.
#[derive(Clone, Debug, PartialEq)]
pub struct BrickLog {
    /// File of the log.
    pub file: PathBuf,
    /// The rows, without poses.
    pub run: Run,
    /// Whether each range sensor has a column.
    pub have_echoes: Vec<bool>,
    /// Whether the last line was incomplete and dropped, because power or flash memory ran out.
    pub is_truncated: bool,
}

/// Required columns; the rotation counters are needed to align the clock.
const REQUIRED: [&str; 5] = ["t_ms", "left", "right", "rot_left_deg", "rot_right_deg"];

/// Returns whether a text is a brick log, judging by its header.
pub fn is_brick_log(text: &str) -> bool {
    header_line(text).is_some()
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
    /// Parses the text of a log of a robot with these range sensors; a last line without a line end is dropped, and so is an incomplete
    /// row at the end of a printed log. The file is for messages.
    ///
    /// # Errors
    /// When a column is missing, fewer than two rows are complete, or a number is invalid.
    pub fn parse(file: &Path, text: &str, sensors: &Arc<Sensors>, warn: impl FnMut(String)) -> Result<Self> {
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
        let named = as_named(header, sensors);
        let (mut run, have_echoes) = Run::parse_of(file, &log.join("\n"), &REQUIRED, &named, warn)?;
        run.rows = run.rows.of_sensors(Arc::clone(sensors));
        let is_truncated = is_cut || complete.len() < text.len();
        Ok(BrickLog { file: file.to_owned(), run, have_echoes, is_truncated })
    }
}

/// Returns the sensors under the names that the header uses: programs that collect logs write the first one's readings as `echo_cm`,
/// whatever its name.
fn as_named(header: &str, sensors: &Arc<Sensors>) -> Arc<Sensors> {
    let has = |column: &str| header.split(',').any(|cell| cell.trim() == column);
    if has(&column_of(sensors.first())) || !has(ECHO) {
        return Arc::clone(sensors);
    }
    Arc::new(Sensors::new(None, sensors.further().to_vec()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use mindgap_logs::Ultrasonic;
    use mindgap_logs::range_sensor::RangeSensor;

    const ROWS: &str = "t_ms,left,right,rot_left_deg,rot_right_deg,battery_mv,echo_cm\r\n0,30,30,0,0,8000,\r\n\
                        400,30,30,120,118,8000,87\r\n800,30,30,241,240,8000,8";

    fn read(text: &str) -> Result<BrickLog> {
        assert!(is_brick_log(text));
        BrickLog::parse(Path::new("run-000.csv"), text, &Arc::default(), |warning| panic!("{warning}"))
    }

    #[test]
    fn every_range_sensor_has_its_readings_and_the_first_any_name() {
        let mount = Ultrasonic { x_cm: 0.0, y_cm: 0.0, yaw_deg: 0.0, min_cm: 4.0, max_cm: 250.0 };
        let further = ["left", "rear"].map(|name| RangeSensor::new(name.into(), mount)).to_vec();
        let sensors = Arc::new(Sensors::new(Some("front".into()), further));
        for first in ["echo_cm", "echo_front_cm"] {
            let text = format!(
                "t_ms,left,right,rot_left_deg,rot_right_deg,echo_rear_cm,{first}\n0,1,1,0,0,30,10\n400,1,1,9,9,,11\n"
            );
            let log = BrickLog::parse(Path::new("run-000.csv"), &text, &sensors, |warning| panic!("{warning}"));
            let BrickLog { run, have_echoes, .. } = log.expect("a log");
            assert_eq!((have_echoes, run.rows.sensors().first()), (vec![true, false, true], "front"));
            assert_eq!([0, 1].map(|row| run.rows.at(row).echo_cm), [Some(10.0), Some(11.0)]);
            assert_eq!([0, 1].map(|row| run.rows.further_cm(1, row)), [Some(30.0), None]);
        }
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
