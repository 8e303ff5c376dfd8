//! The columns of run-*.csv: where they stand, what their cells say, and what to write where they say something else.

use std::path::Path;

use csv::StringRecord;

use super::row::Row;
use mindgap_foundations::error::{Error, Result};
use mindgap_foundations::geometry::Pose;

/// The columns, those first that every run must have.
pub const COLUMNS: [&str; 10] =
    [TIME, "left", "right", "x_cm", "y_cm", "heading_deg", ECHO, "rot_left_deg", "rot_right_deg", "battery_mv"];
/// Number of leading [`COLUMNS`] that every run must have.
pub const REQUIRED: usize = 7;
/// The same of a robot without a range sensor.
pub const REQUIRED_WITHOUT_SENSOR: usize = 6;
const TIME: &str = "t_ms";
/// The one whose cells may hold `inf` or `nan`.
const ECHO: &str = "echo_cm";
/// Number of leading [`COLUMNS`] whose cells must not be empty.
const ALWAYS_THERE: usize = 3;
/// Largest magnitude of a number in a log.
const HUGE: f64 = 1e7;
/// Largest time, ms: a run takes no twelve days. Beyond it clocks count from 1970.
const LATEST_MS: f64 = 1e9;
/// Upper ends of the times that clocks which count from 1970 show until the year 2100, and their units.
const SINCE_1970: [(f64, &str); 4] = [(4.2e9, "s"), (4.2e12, "ms"), (4.2e15, "us"), (4.2e18, "ns")];

/// Where each of [`COLUMNS`] stands in a file.
pub struct Columns([Option<usize>; COLUMNS.len()]);

impl Columns {
    /// Finds them by a header's names; `warn` receives a line for each unknown one.
    ///
    /// # Errors
    /// Names all that are missing of the `required` ones, and what stands there instead, or one that stands twice.
    pub fn find(path: &Path, header: &StringRecord, required: &[&str], warn: &mut impl FnMut(String)) -> Result<Self> {
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
        let is_there = |name: &&&str| COLUMNS.iter().zip(places).any(|(c, place)| c == *name && place.is_some());
        let missing: Vec<&str> = required.iter().filter(|name| !is_there(name)).copied().collect();
        if !missing.is_empty() {
            return Err(Error::at_line(path, 1, without(&missing, header, &unknown)));
        }
        for name in unknown {
            warn(format!("{}:1: column {name:?} is not known and left out", path.display()));
        }
        Ok(Columns(places))
    }

    /// The row that a record's cells say.
    ///
    /// # Errors
    /// What is wrong with a cell, and what to write instead.
    pub fn row(&self, record: &StringRecord) -> std::result::Result<Row, String> {
        let mut v = [None; COLUMNS.len()];
        for (c, name) in COLUMNS.iter().enumerate() {
            let Some(cell) = self.0[c].and_then(|i| record.get(i)).filter(|cell| !cell.is_empty()) else { continue };
            v[c] = Some(number(c, name, cell)?);
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
            t_ms: needed(t_ms, TIME)?,
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

/// The cells of a row, in the order of [`COLUMNS`].
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

/// Why columns are not found, as far as the header tells it.
fn without(missing: &[&str], header: &StringRecord, unknown: &[&str]) -> String {
    let first = header.get(0).unwrap_or_default();
    let other_separator = [(';', "semicolons"), ('\t', "tabs"), ('|', "bars"), (' ', "blanks")];
    let is_known = |name: &str| COLUMNS.iter().any(|column| column.eq_ignore_ascii_case(name));
    let parts = |(c, _): &(char, &str)| header.len() == 1 && first.contains(*c) && first.split(*c).any(is_known);
    if let Some((_, name)) = other_separator.into_iter().find(parts) {
        return format!(
            "the columns are parted by {name}: part them by commas, and write numbers with a decimal point"
        );
    }
    if let Some(sign) = ["#", "%", "//"].into_iter().find(|sign| first.starts_with(sign)) {
        return format!("the header begins with {sign}, as comments do: write it without");
    }
    if !first.is_empty() && header.iter().all(|cell| cell.is_empty() || cell.parse::<f64>().is_ok()) {
        return format!("there is no header: write {} as the first line", COLUMNS[..REQUIRED].join(","));
    }
    let in_capitals = |name: &&&str| unknown.iter().any(|other| other.eq_ignore_ascii_case(name));
    if let Some(name) = missing.iter().find(in_capitals) {
        return format!("column {name} is written in capitals: write names in small letters");
    }
    let (columns, are) = if missing.len() == 1 { ("column", "is") } else { ("columns", "are") };
    let others = if unknown.is_empty() { String::new() } else { format!("; not known are {}", unknown.join(", ")) };
    format!("{columns} {} {are} missing{others}", missing.join(", "))
}

fn number(column: usize, name: &str, cell: &str) -> std::result::Result<f64, String> {
    let number: f64 = cell.parse().map_err(|_| no_number(column, name, cell))?;
    if name == TIME && number.abs() > LATEST_MS {
        return Err(match SINCE_1970.into_iter().find(|(end, _)| number <= *end) {
            Some((_, unit)) if number > 0.0 => {
                format!("t_ms = {cell} counts from 1970 in {unit}: write milliseconds since the run began")
            }
            _ => format!("t_ms = {cell} is no number of milliseconds since a run began"),
        });
    }
    // Drivers say so that there was no echo: an inspection finds it, and no number that counts is not finite.
    let number = if name == ECHO && !number.is_finite() { HUGE } else { number };
    if !number.is_finite() || name != TIME && number.abs() > HUGE {
        let instead = if column < ALWAYS_THERE || number.is_finite() { "" } else { EMPTY };
        return Err(format!("{name} = {cell} is no number that a robot could log{instead}"));
    }
    Ok(number)
}

/// What to write where there is nothing to write.
const EMPTY: &str = "; leave the cell empty where there is none";

fn no_number(column: usize, name: &str, cell: &str) -> String {
    let is_date = cell.contains(':') || cell.len() > 6 && cell.get(4..).is_some_and(|rest| rest.starts_with('-'));
    let instead = if cell == name {
        ": the header stands here again; give every run a file of its own"
    } else if name == TIME && cell.is_ascii() && is_date {
        ", it is a date; write milliseconds since the run began"
    } else if cell.contains(',') && cell.replacen(',', ".", 1).parse::<f64>().is_ok() {
        "; write a decimal point"
    } else if column >= ALWAYS_THERE {
        EMPTY
    } else {
        ""
    };
    format!("{name} = {cell:?} is no number{instead}")
}
