//! The columns of run-*.csv: finds them in the header, parses their cells, and says how to correct invalid ones.

use std::path::Path;

use csv::StringRecord;

use super::row::Row;
use mindgap_foundations::error::{Error, Result};
use mindgap_foundations::geometry::Pose;

/// All known columns, starting with those that every run must have.
pub const COLUMNS: [&str; 10] =
    [TIME, "left", "right", "x_cm", "y_cm", "heading_deg", ECHO, "rot_left_deg", "rot_right_deg", "battery_mv"];
/// Number of leading [`COLUMNS`] that every run must have.
pub const REQUIRED: usize = 7;
/// Number of leading [`COLUMNS`] that every run of a robot without a range sensor must have.
pub const REQUIRED_WITHOUT_SENSOR: usize = 6;
const TIME: &str = "t_ms";
/// The column whose cells may hold `inf` or `nan`.
const ECHO: &str = "echo_cm";
/// Number of leading [`COLUMNS`] whose cells must not be empty.
const NEVER_EMPTY: usize = 3;
/// Largest magnitude of a number in a log.
const MAX_MAGNITUDE: f64 = 1e7;
/// Largest time, ms: no run takes twelve days, so larger times are Unix times.
const MAX_TIME_MS: f64 = 1e9;
/// Upper limits of Unix times until the year 2100, with their units.
const UNIX_TIME_UNITS: [(f64, &str); 4] = [(4.2e9, "s"), (4.2e12, "ms"), (4.2e15, "us"), (4.2e18, "ns")];

/// The index in a file's header of each of [`COLUMNS`].
pub struct Columns([Option<usize>; COLUMNS.len()]);

impl Columns {
    /// Finds the columns in a header; `warn` receives a line for each unknown one.
    ///
    /// # Errors
    /// When `required` columns are missing or a column is duplicated.
    pub fn find(path: &Path, header: &StringRecord, required: &[&str], warn: &mut impl FnMut(String)) -> Result<Self> {
        let mut indices = [None; COLUMNS.len()];
        let mut unknown = Vec::new();
        for (i, name) in header.iter().enumerate() {
            match COLUMNS.iter().position(|c| *c == name) {
                None => unknown.push(name),
                Some(c) if indices[c].is_some() => {
                    return Err(Error::at_line(path, 1, format!("column {name} is duplicated")));
                }
                Some(c) => indices[c] = Some(i),
            }
        }
        let is_found = |name: &&&str| COLUMNS.iter().zip(indices).any(|(c, index)| c == *name && index.is_some());
        let missing: Vec<&str> = required.iter().filter(|name| !is_found(name)).copied().collect();
        if !missing.is_empty() {
            return Err(Error::at_line(path, 1, missing_columns(&missing, header, &unknown)));
        }
        for name in unknown {
            warn(format!("{}:1: unknown column {name:?} ignored", path.display()));
        }
        Ok(Columns(indices))
    }

    /// Parses a record as a row.
    ///
    /// # Errors
    /// When a cell is invalid; the message says what to write instead.
    pub fn row(&self, record: &StringRecord) -> std::result::Result<Row, String> {
        let mut v = [None; COLUMNS.len()];
        for (c, name) in COLUMNS.iter().enumerate() {
            let Some(cell) = self.0[c].and_then(|i| record.get(i)).filter(|cell| !cell.is_empty()) else { continue };
            v[c] = Some(number(c, name, cell)?);
        }
        let [t_ms, left, right, x_cm, y_cm, heading_deg, echo_cm, rot_left_deg, rot_right_deg, battery_mv] = v;
        let required = |value: Option<f64>, name: &str| value.ok_or(format!("{name} is empty"));
        let command = |value: Option<f64>, name: &str| match required(value, name)? {
            v if v.abs() <= 100.0 => Ok(v),
            v => Err(format!("{name} = {v} lies outside -100..100")),
        };
        let pose = match (x_cm, y_cm, heading_deg) {
            (Some(x), Some(y), Some(heading)) => Some(Pose::new(x, y, heading.to_radians())),
            (None, None, None) => None,
            _ => return Err("x_cm, y_cm and heading_deg must be all given or all empty".into()),
        };
        if let Some(echo_cm) = echo_cm.filter(|e| *e < 0.0) {
            return Err(format!("echo_cm = {echo_cm} is negative; leave the cell empty if there was no echo"));
        }
        Ok(Row {
            t_ms: required(t_ms, TIME)?,
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

/// Returns the cells of a row, in the order of [`COLUMNS`].
pub fn cells(row: &Row) -> [Option<f64>; COLUMNS.len()] {
    [
        Some(row.t_ms),
        Some(row.left),
        Some(row.right),
        row.pose.map(|p| p.position_cm.x),
        row.pose.map(|p| p.position_cm.y),
        row.pose.map(|p| p.heading_rad.to_degrees()),
        row.echo_cm,
        row.rot_left_deg,
        row.rot_right_deg,
        row.battery_mv,
    ]
}

/// Explains why columns are missing, as far as the header shows.
fn missing_columns(missing: &[&str], header: &StringRecord, unknown: &[&str]) -> String {
    let first = header.get(0).unwrap_or_default();
    let other_separator = [(';', "semicolons"), ('\t', "tabs"), ('|', "bars"), (' ', "spaces")];
    let is_known = |name: &str| COLUMNS.iter().any(|column| column.eq_ignore_ascii_case(name));
    let separates = |(c, _): &(char, &str)| header.len() == 1 && first.contains(*c) && first.split(*c).any(is_known);
    if let Some((_, name)) = other_separator.into_iter().find(separates) {
        return format!("columns are separated by {name}: use commas, and write numbers with a decimal point");
    }
    if let Some(sign) = ["#", "%", "//"].into_iter().find(|sign| first.starts_with(sign)) {
        return format!("the header starts with the comment sign {sign}: remove it");
    }
    if !first.is_empty() && header.iter().all(|cell| cell.is_empty() || cell.parse::<f64>().is_ok()) {
        return format!("the header is missing: write {} as the first line", COLUMNS[..REQUIRED].join(","));
    }
    let in_capitals = |name: &&&str| unknown.iter().any(|other| other.eq_ignore_ascii_case(name));
    if let Some(name) = missing.iter().find(in_capitals) {
        return format!("column {name} is in capitals: use lower-case names");
    }
    let (columns, are) = if missing.len() == 1 { ("column", "is") } else { ("columns", "are") };
    let others =
        if unknown.is_empty() { String::new() } else { format!("; unknown columns are {}", unknown.join(", ")) };
    format!("{columns} {} {are} missing{others}", missing.join(", "))
}

fn number(column: usize, name: &str, cell: &str) -> std::result::Result<f64, String> {
    let number: f64 = cell.parse().map_err(|_| not_a_number(column, name, cell))?;
    if name == TIME && number.abs() > MAX_TIME_MS {
        return Err(match UNIX_TIME_UNITS.into_iter().find(|(end, _)| number <= *end) {
            Some((_, unit)) if number > 0.0 => {
                format!("t_ms = {cell} is Unix time in {unit}: write milliseconds since the start of the run")
            }
            _ => format!("t_ms = {cell} is not a time in milliseconds since the start of a run"),
        });
    }
    // Some drivers write `inf` or `nan` for no echo. The inspection handles it as a huge number, so that all numbers
    // in a log are finite.
    let number = if name == ECHO && !number.is_finite() { MAX_MAGNITUDE } else { number };
    if !number.is_finite() || name != TIME && number.abs() > MAX_MAGNITUDE {
        let hint = if column < NEVER_EMPTY || number.is_finite() { "" } else { EMPTY };
        return Err(format!("{name} = {cell} is not a number that a robot could log{hint}"));
    }
    Ok(number)
}

/// How to log a missing value.
const EMPTY: &str = "; leave the cell empty if there is no value";

fn not_a_number(column: usize, name: &str, cell: &str) -> String {
    let is_date = cell.contains(':') || cell.len() > 6 && cell.get(4..).is_some_and(|rest| rest.starts_with('-'));
    let hint = if cell == name {
        ": the header is repeated here; write each run to its own file"
    } else if name == TIME && cell.is_ascii() && is_date {
        " but a date; write milliseconds since the start of the run"
    } else if cell.contains(',') && cell.replacen(',', ".", 1).parse::<f64>().is_ok() {
        "; write a decimal point"
    } else if column >= NEVER_EMPTY {
        EMPTY
    } else {
        ""
    };
    format!("{name} = {cell:?} is not a number{hint}")
}
