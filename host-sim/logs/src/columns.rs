//! The columns of run-*.csv: finds them in the header, parses their cells, and says how to correct invalid ones.

use std::path::Path;

use csv::StringRecord;

use super::range_sensor::{ECHO, Sensors, ULTRASONIC, column_of, sensor_of};
use super::row::Row;
use mindgap_foundations::error::{Error, Result};
use mindgap_foundations::geometry::Pose;

/// All known columns, starting with those that every run must have.
pub const COLUMNS: [&str; 11] = [
    TIME,
    "left",
    "right",
    "x_cm",
    "y_cm",
    "heading_deg",
    ECHO,
    "rot_left_deg",
    "rot_right_deg",
    "battery_mv",
    "gyro_deg_s",
];
/// Number of leading [`COLUMNS`] that every run must have.
pub const REQUIRED: usize = 7;
/// Number of leading [`COLUMNS`] that every run of a robot without a range sensor must have.
pub const REQUIRED_WITHOUT_SENSOR: usize = 6;
/// The columns of commands-*.csv.
pub const COMMAND_COLUMNS: [&str; 3] = [COLUMNS[0], COLUMNS[1], COLUMNS[2]];
const TIME: &str = "t_ms";
/// The columns of the tracked pose.
const POSE: [&str; 3] = ["x_cm", "y_cm", "heading_deg"];
/// Columns with which a robot measures its own motion.
const WITNESSES: [&[&str]; 2] = [&["rot_left_deg", "rot_right_deg"], &["gyro_deg_s"]];
/// Place of the column of the first range sensor in [`COLUMNS`]. The cells of range sensors may hold `inf` or `nan`.
const FIRST_ECHO: usize = 6;
/// Number of leading [`COLUMNS`] whose cells must not be empty.
const NEVER_EMPTY: usize = 3;
/// Largest magnitude of a number in a log.
const MAX_MAGNITUDE: f64 = 1e7;
/// Largest time, ms: no run takes twelve days, so larger times are Unix times.
const MAX_TIME_MS: f64 = 1e9;
/// Upper limits of Unix times until the year 2100, with their units.
const UNIX_TIME_UNITS: [(f64, &str); 4] = [(4.2e9, "s"), (4.2e12, "ms"), (4.2e15, "us"), (4.2e18, "ns")];

/// Where columns are in a file's header.
pub struct Columns {
    /// The index of each of [`COLUMNS`].
    indices: [Option<usize>; COLUMNS.len()],
    /// The column of the first range sensor.
    first_echo: String,
    /// The columns of the further range sensors, with their index.
    further: Vec<(String, Option<usize>)>,
}

impl Columns {
    /// Finds the columns in a header; `warn` receives a line for each unknown one.
    ///
    /// # Errors
    /// When `required` columns are missing or a column is duplicated.
    pub fn find(
        path: &Path,
        header: &StringRecord,
        required: &[&str],
        sensors: &Sensors,
        warn: &mut impl FnMut(String),
    ) -> Result<Self> {
        Columns::find_among(&COLUMNS, path, header, required, sensors, warn)
    }

    /// Finds those of the `known` columns, which are the first of [`COLUMNS`], and those of further range sensors.
    ///
    /// # Errors
    /// As [`Columns::find`].
    pub fn find_among(
        known: &[&str],
        path: &Path,
        header: &StringRecord,
        required: &[&str],
        sensors: &Sensors,
        warn: &mut impl FnMut(String),
    ) -> Result<Self> {
        let further = sensors.further().iter().map(|sensor| (column_of(&sensor.name), None)).collect();
        let mut columns = Columns { indices: [None; COLUMNS.len()], first_echo: column_of(sensors.first()), further };
        let mut unknown = Vec::new();
        for (i, name) in header.iter().enumerate() {
            match columns.place(name, known.len()) {
                None => unknown.push(name),
                Some(place) if place.is_some() => {
                    return Err(Error::at_line(path, 1, format!("column {name} is duplicated")));
                }
                Some(place) => *place = Some(i),
            }
        }
        let is_found = |name: &&&str| COLUMNS.iter().zip(columns.indices).any(|(c, i)| c == *name && i.is_some());
        // A robot that measures its own motion need not be tracked; a part of a pose is a mistake.
        let measures_itself = WITNESSES.iter().any(|columns| columns.iter().all(|name| is_found(&name)));
        let is_untracked = measures_itself && !POSE.iter().any(|name| is_found(&name));
        let is_needed = |name: &&&str| !(is_untracked && POSE.contains(name));
        let missing: Vec<&str> = required.iter().filter(|name| !is_found(name)).filter(is_needed).copied().collect();
        if !missing.is_empty() {
            return Err(Error::at_line(path, 1, missing_columns(&missing, header, &unknown)));
        }
        for name in unknown {
            warn(format!("{}:1: {}", path.display(), ignored(name)));
        }
        Ok(columns)
    }

    /// Returns the place for the index of a column, if one of this name is among the first `count` of [`COLUMNS`].
    fn place(&mut self, name: &str, count: usize) -> Option<&mut Option<usize>> {
        let known = COLUMNS[..count].iter().enumerate().position(|(c, known)| match c {
            FIRST_ECHO => self.first_echo == name,
            _ => *known == name,
        });
        match known {
            Some(c) => Some(&mut self.indices[c]),
            None => self.further.iter_mut().find(|(further, _)| further == name).map(|(_, place)| place),
        }
    }

    /// Returns whether each range sensor has a column, in their order.
    pub fn have_echoes(&self) -> impl Iterator<Item = bool> {
        std::iter::once(&self.indices[FIRST_ECHO]).chain(self.further.iter().map(|(_, i)| i)).map(Option::is_some)
    }

    /// Parses the readings of the further range sensors of a record, cm.
    ///
    /// # Errors
    /// When a cell is invalid; the message says what to write instead.
    pub fn further_cm(&self, record: &StringRecord) -> impl Iterator<Item = std::result::Result<Option<f64>, String>> {
        self.further.iter().map(|(name, index)| {
            let cell = index.and_then(|i| record.get(i)).filter(|cell| !cell.is_empty());
            cell.map(|cell| number(FIRST_ECHO, name, cell).and_then(|cm| reading(name, cm))).transpose()
        })
    }

    /// Parses a record as a row.
    ///
    /// # Errors
    /// When a cell is invalid; the message says what to write instead.
    pub fn row(&self, record: &StringRecord) -> std::result::Result<Row, String> {
        let mut v = [None; COLUMNS.len()];
        for (c, name) in COLUMNS.iter().enumerate() {
            let Some(cell) = self.indices[c].and_then(|i| record.get(i)).filter(|cell| !cell.is_empty()) else {
                continue;
            };
            v[c] = Some(number(c, if c == FIRST_ECHO { &self.first_echo } else { name }, cell)?);
        }
        let [t_ms, left, right, x_cm, y_cm, heading_deg, echo_cm, rot_left_deg, rot_right_deg, battery_mv, gyro_deg_s] =
            v;
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
        let echo_cm = echo_cm.map(|cm| reading(&self.first_echo, cm)).transpose()?;
        Ok(Row {
            t_ms: required(t_ms, TIME)?,
            left: command(left, "left")?,
            right: command(right, "right")?,
            pose,
            echo_cm,
            rot_left_deg,
            rot_right_deg,
            battery_mv,
            gyro_deg_s,
        })
    }
}

/// Returns the names of all columns of a robot with these range sensors: [`COLUMNS`], then those of the further sensors.
pub fn column_names(sensors: &Sensors) -> Vec<String> {
    let first = column_of(sensors.first());
    let known =
        COLUMNS.iter().enumerate().map(|(c, name)| if c == FIRST_ECHO { first.clone() } else { (*name).into() });
    known.chain(sensors.further().iter().map(|sensor| column_of(&sensor.name))).collect()
}

/// Returns a reading in cm that is possible.
fn reading(column: &str, cm: f64) -> std::result::Result<f64, String> {
    if cm >= 0.0 {
        return Ok(cm);
    }
    Err(format!(
        "{column} = {cm} is negative; leave the cell empty if there was no echo, and add 256 if a byte was read as signed"
    ))
}

/// Says that a column is ignored, and why if it is that of a sensor.
fn ignored(name: &str) -> String {
    match sensor_of(name) {
        None => format!("unknown column {name:?} ignored"),
        Some(ULTRASONIC) => format!("column {name:?} ignored: robot.toml has no [ultrasonic]"),
        Some(sensor) => format!("column {name:?} ignored: robot.toml has no range_sensor named {sensor:?}"),
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
        row.gyro_deg_s,
    ]
}

/// Formats a number with at most two decimals, the precision of trackers and sensors.
pub fn two_decimals(value: f64) -> String {
    let text = format!("{value:.2}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".into() } else { text.into() }
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
    let number = if column == FIRST_ECHO && !number.is_finite() { MAX_MAGNITUDE } else { number };
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn poses_may_be_absent_where_the_robot_measures_itself() {
        let find = |header: &[&str]| {
            let header = StringRecord::from(header.to_vec());
            let path = Path::new("run-000.csv");
            Columns::find(path, &header, &COLUMNS[..REQUIRED], &Sensors::default(), &mut |_| ()).is_ok()
        };
        let commands = [TIME, "left", "right", ECHO];
        assert!(find(&[&commands, ["rot_left_deg", "rot_right_deg"].as_slice()].concat()));
        assert!(find(&[&commands, ["gyro_deg_s"].as_slice()].concat()));
        assert!(!find(&[&commands, ["rot_left_deg", "battery_mv"].as_slice()].concat()));
        assert!(!find(&["left", "right", ECHO, "gyro_deg_s"]), "the time is needed");
    }
}
