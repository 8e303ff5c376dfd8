//! `run-*.csv`: one run of a robot (docs/formats.md).

use std::path::Path;

use csv::{ReaderBuilder, StringRecord, Writer};

use crate::error::{Error, Result};
use crate::files;
use crate::geometry::Pose;

/// One run of a robot: at least two rows in order of time.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// File name without its ending.
    pub name: String,
    /// The rows.
    pub rows: Vec<Row>,
}

/// One row of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Row {
    /// Time since the run began, ms.
    pub t_ms: f64,
    /// Command of the left motor, set at this row and held until the next, -100..=100.
    pub left: f64,
    /// Command of the right motor, likewise.
    pub right: f64,
    /// Tracked pose of the axle's middle; `None` if the tracker lost the robot.
    pub pose: Option<Pose>,
    /// Ultrasonic reading, cm; `None` if the sensor produced no value.
    pub echo_cm: Option<f64>,
    /// Rotation counter of the left motor, degrees.
    pub rot_left_deg: Option<f64>,
    /// Rotation counter of the right motor, degrees.
    pub rot_right_deg: Option<f64>,
    /// Battery voltage, millivolts.
    pub battery_mv: Option<f64>,
}

const COLUMNS: [&str; 10] =
    ["t_ms", "left", "right", "x_cm", "y_cm", "heading_deg", ECHO, "rot_left_deg", "rot_right_deg", "battery_mv"];
/// Number of leading [`COLUMNS`] that every run must have.
const REQUIRED: usize = 7;
/// The one whose cells may hold `inf` or `nan`.
const ECHO: &str = "echo_cm";
/// Largest magnitude of a number in a log.
const HUGE: f64 = 1e7;

impl Run {
    /// Reads a run. `warn` receives a line for each unknown column and for a missing line end.
    ///
    /// # Errors
    /// When the file cannot be read, lacks a column, has fewer than two rows, or has an invalid number.
    pub fn read(path: &Path, mut warn: impl FnMut(String)) -> Result<Self> {
        let text = files::read_text(path)?;
        let run = Run::parse(path, &text, &COLUMNS[..REQUIRED], &mut warn)?;
        if !text.ends_with('\n') {
            warn(format!(
                "{}: the last line has no line end; if it is torn, its last number may be wrong",
                path.display()
            ));
        }
        Ok(run)
    }

    /// Parses the text of a file that must have the `required` columns; `path` is for messages and the run's name.
    ///
    /// # Errors
    /// As [`Run::read`].
    pub fn parse(path: &Path, text: &str, required: &[&str], mut warn: impl FnMut(String)) -> Result<Self> {
        let mut reader = ReaderBuilder::new().trim(csv::Trim::All).from_reader(text.as_bytes());
        let header = reader.headers().map_err(|e| files::csv_error(path, &e))?.clone();
        let columns = Columns::find(path, &header, required, &mut warn)?;
        let mut rows: Vec<Row> = Vec::new();
        for record in reader.records() {
            let record = record.map_err(|e| files::csv_error(path, &e))?;
            let line = record.position().map_or(0, csv::Position::line);
            let row = columns.row(&record).map_err(|what| Error::at_line(path, line, what))?;
            if rows.last().is_some_and(|before| row.t_ms <= before.t_ms) {
                return Err(Error::at_line(
                    path,
                    line,
                    format!("t_ms = {} does not come after the row before", row.t_ms),
                ));
            }
            rows.push(row);
        }
        if rows.len() < 2 {
            return Err(Error::in_file(path, format!("has {} row(s); a run needs at least two", rows.len())));
        }
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        Ok(Run { name, rows })
    }

    /// Writes a run; an optional column is written if any row has a value.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn write(&self, path: &Path) -> Result<()> {
        let cells: Vec<[Option<f64>; COLUMNS.len()]> = self.rows.iter().map(Row::cells).collect();
        let written: Vec<usize> =
            (0..COLUMNS.len()).filter(|c| *c < REQUIRED || cells.iter().any(|row| row[*c].is_some())).collect();
        let mut writer = Writer::from_writer(Vec::new());
        let failed = |e: csv::Error| Error::in_file(path, e.to_string());
        writer.write_record(written.iter().map(|c| COLUMNS[*c])).map_err(failed)?;
        for row in &cells {
            writer.write_record(written.iter().map(|c| row[*c].map_or(String::new(), two_decimals))).map_err(failed)?;
        }
        let bytes = writer.into_inner().map_err(|e| Error::in_file(path, e.to_string()))?;
        files::write(path, bytes)
    }

    /// Left and right command of the row before `k`; zeros at the first row, since motors start from rest.
    pub fn previous_command(&self, k: usize) -> [f64; 2] {
        if k == 0 { [0.0, 0.0] } else { self.rows[k - 1].command() }
    }
}

impl Row {
    /// Left and right command.
    pub fn command(&self) -> [f64; 2] {
        [self.left, self.right]
    }

    fn cells(&self) -> [Option<f64>; COLUMNS.len()] {
        [
            Some(self.t_ms),
            Some(self.left),
            Some(self.right),
            self.pose.map(|p| p.position_cm.x),
            self.pose.map(|p| p.position_cm.y),
            self.pose.map(|p| p.heading_rad.to_degrees()),
            self.echo_cm,
            self.rot_left_deg,
            self.rot_right_deg,
            self.battery_mv,
        ]
    }
}

/// Where each of [`COLUMNS`] stands in a file.
struct Columns([Option<usize>; COLUMNS.len()]);

impl Columns {
    fn find(path: &Path, header: &StringRecord, required: &[&str], warn: &mut impl FnMut(String)) -> Result<Self> {
        let mut places = [None; COLUMNS.len()];
        let mut unknown = Vec::new();
        for (i, name) in header.iter().enumerate() {
            match COLUMNS.iter().position(|c| *c == name) {
                None => unknown.push(name),
                Some(c) if places[c].is_some() => {
                    return Err(Error::at_line(path, 1, format!("column {name} stands twice")));
                }
                Some(c) => places[c] = Some(i),
            }
        }
        let is_there = |name: &&str| COLUMNS.iter().zip(places).any(|(c, place)| c == name && place.is_some());
        if let Some(name) = required.iter().find(|name| !is_there(name)) {
            return Err(Error::at_line(path, 1, format!("column {name} is missing")));
        }
        for name in unknown {
            warn(format!("{}:1: column {name:?} is not known and left out", path.display()));
        }
        Ok(Columns(places))
    }

    fn row(&self, record: &StringRecord) -> std::result::Result<Row, String> {
        let mut v = [None; COLUMNS.len()];
        for (c, name) in COLUMNS.iter().enumerate() {
            let Some(cell) = self.0[c].and_then(|i| record.get(i)).filter(|cell| !cell.is_empty()) else { continue };
            let number: f64 = cell.parse().map_err(|_| format!("{name} = {cell:?} is no number"))?;
            // Drivers say so that there was no echo: an inspection finds it, and no number that counts is not finite.
            let number = if *name == ECHO && !number.is_finite() { HUGE } else { number };
            if !number.is_finite() || number.abs() > HUGE {
                return Err(format!("{name} = {cell} is no number that a robot could log"));
            }
            v[c] = Some(number);
        }
        let [t_ms, left, right, x_cm, y_cm, heading_deg, echo_cm, rot_left_deg, rot_right_deg, battery_mv] = v;
        let needed = |value: Option<f64>, name: &str| value.ok_or(format!("{name} is empty"));
        let command = |value: Option<f64>, name: &str| match needed(value, name)? {
            v if v.abs() <= 100.0 => Ok(v),
            v => Err(format!("{name} = {v} lies outside -100..100")),
        };
        let pose = match (x_cm, y_cm, heading_deg) {
            (Some(x), Some(y), Some(heading)) => Some(Pose::new(x, y, heading.to_radians())),
            (None, None, None) => None,
            _ => return Err("x_cm, y_cm and heading_deg must be there together or empty together".into()),
        };
        if let Some(echo_cm) = echo_cm.filter(|e| *e < 0.0) {
            return Err(format!("echo_cm = {echo_cm} is below zero; leave the cell empty where there was no echo"));
        }
        Ok(Row {
            t_ms: needed(t_ms, "t_ms")?,
            left: command(left, "left")?,
            right: command(right, "right")?,
            pose,
            echo_cm,
            rot_left_deg,
            rot_right_deg,
            battery_mv,
        })
    }
}

/// Numbers are written with at most two decimals, the precision of trackers and readings.
fn two_decimals(value: f64) -> String {
    let text = format!("{value:.2}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".into() } else { text.into() }
}
