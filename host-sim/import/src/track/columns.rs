//! Tracks as plain CSV, with columns named after quantity and unit such as `time_s`, `x_m`, `y_m`, `yaw_rad`.

use std::path::Path;

use clap::ValueEnum;
use csv::StringRecord;

use crate::frame::Frame;
use crate::units::Units;
use mindgap_files::Records;
use mindgap_foundations::error::{Error, Result};
use mindgap_foundations::geometry::Pose;

/// Accepted names of the quantities, before the unit.
const TIME: [&str; 3] = ["t", "time", "timestamp"];
const X: [&str; 1] = ["x"];
const Y: [&str; 1] = ["y"];
const HEADING: [&str; 3] = ["heading", "yaw", "theta"];

/// The frames of a track; `None` where the robot was lost (a cell of the pose is empty or `nan`).
pub(super) fn frames(file: &Path, text: &str, units: &Units) -> Result<Vec<Option<Frame>>> {
    let mut records = Records::new(file, text.as_bytes());
    let header = records.header()?;
    let find = |what: &str, names: &[&str]| Column::find(&header, what, names).map_err(|e| Error::at_line(file, 1, e));
    let [time, x, y, heading] = [find("time", &TIME)?, find("x", &X)?, find("y", &Y)?, find("the heading", &HEADING)?];
    let of_unit = |e| Error::at_line(file, 1, e);
    let ms = time.unit(units.time, "--time-unit").map_err(of_unit)?.ms();
    let [x_unit, y_unit] = [&x, &y].map(|column| column.unit(units.length, "--length-unit"));
    let (x_cm, y_cm) = (x_unit.map_err(of_unit)?.cm(), y_unit.map_err(of_unit)?.cm());
    let rad = heading.unit(units.angle, "--angle-unit").map_err(of_unit)?.rad();
    let (mut record, mut frames) = (StringRecord::new(), Vec::new());
    while let Some(line) = records.read(&mut record)? {
        let number = |column: &Column| column.number(&record).map_err(|what| Error::at_line(file, line, what));
        let t_ms = number(&time)?.ok_or_else(|| Error::at_line(file, line, format!("{} is empty", time.name)))? * ms;
        let pose = match (number(&x)?, number(&y)?, number(&heading)?) {
            (Some(x), Some(y), Some(heading)) => Some(Pose::new(x * x_cm, y * y_cm, heading * rad)),
            _ => None,
        };
        frames.push(pose.map(|pose| Frame { t_ms, pose }));
    }
    Ok(frames)
}

/// A column of the file.
struct Column {
    name: String,
    place: usize,
    /// The unit in its name; empty if there is none.
    unit: String,
}

impl Column {
    fn find(header: &StringRecord, what: &str, names: &[&str]) -> std::result::Result<Self, String> {
        let mut found = header.iter().enumerate().filter_map(|(place, name)| {
            let lower = name.to_lowercase();
            let (quantity, unit) = lower.split_once('_').unwrap_or((&lower, ""));
            names.contains(&quantity).then(|| Column { name: name.into(), place, unit: unit.into() })
        });
        match (found.next(), found.next()) {
            (Some(column), None) => Ok(column),
            (None, _) => Err(format!("no column for {what}: it has to be called {}, with a unit", names.join(" or "))),
            (Some(one), Some(other)) => {
                Err(format!("more than one column for {what}: {} and {}", one.name, other.name))
            }
        }
    }

    fn unit<U: ValueEnum>(&self, default: Option<U>, option: &str) -> std::result::Result<U, String> {
        if self.unit.is_empty() {
            return default.ok_or_else(|| format!("column {} has no unit: give {option}", self.name));
        }
        U::from_str(&self.unit, true).map_err(|_| format!("column {} has an unknown unit", self.name))
    }

    fn number(&self, record: &StringRecord) -> std::result::Result<Option<f64>, String> {
        let cell = record.get(self.place).unwrap_or_default();
        if cell.is_empty() || cell.eq_ignore_ascii_case("nan") {
            return Ok(None);
        }
        let number = cell.parse::<f64>().ok().filter(|v| v.is_finite());
        number.map(Some).ok_or_else(|| format!("{} = {cell:?} is no number", self.name))
    }
}
