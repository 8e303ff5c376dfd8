//! Further range sensors: `[[range_sensor]]` of `robot.toml`.

use std::collections::BTreeSet;
use std::path::Path;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use toml::Spanned;

use super::ultrasonic::Ultrasonic;
use mindgap_files as files;
use mindgap_foundations::error::{Error, Result};

/// The name of the sensor in `[ultrasonic]`.
pub const ULTRASONIC: &str = "ultrasonic";
/// The column of that sensor.
pub const ECHO: &str = "echo_cm";

/// A `[[range_sensor]]` table of `robot.toml`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RangeSensor {
    /// Its name, unique among the robot's sensors.
    pub name: String,
    /// Distance ahead of the centre of the axle, cm.
    pub x_cm: f64,
    /// Distance to the left of the centre of the axle, cm.
    pub y_cm: f64,
    /// Direction of its axis, degrees counter-clockwise from straight ahead.
    pub yaw_deg: f64,
    /// Smallest reading, cm.
    pub min_cm: f64,
    /// Largest reading, cm.
    pub max_cm: f64,
}

/// The names of a robot's range sensors, and the mountings of those beyond the first. The first, which a controller asks unless
/// it names another, is [`Robot::ultrasonic`](super::Robot::ultrasonic).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sensors {
    /// The first is a `[[range_sensor]]` of this name; `None` if it is `[ultrasonic]`.
    first: Option<String>,
    further: Vec<RangeSensor>,
}

impl Sensors {
    /// Takes the tables of a file in their order and returns the first sensor beside the names; `path` and `text` are for messages.
    ///
    /// # Errors
    /// When a name is not possible or is used twice, or when numbers are not possible.
    pub fn of_file(
        path: &Path,
        text: &str,
        ultrasonic: Option<Ultrasonic>,
        tables: Vec<Spanned<RangeSensor>>,
    ) -> Result<(Option<Ultrasonic>, Self)> {
        let mut names = BTreeSet::new();
        for table in &tables {
            let fault = table.get_ref().fault(&names);
            fault.map_or(Ok(()), |what| Err(Error::at_line(path, files::line_at(text, table.span().start), what)))?;
            names.insert(table.get_ref().name.as_str());
        }
        let mut further: Vec<RangeSensor> = tables.into_iter().map(Spanned::into_inner).collect();
        if ultrasonic.is_some() || further.is_empty() {
            return Ok((ultrasonic, Sensors { first: None, further }));
        }
        let first = further.remove(0);
        Ok((Some(first.mount()), Sensors { first: Some(first.name), further }))
    }

    /// Returns sensors whose first is a `[[range_sensor]]` of this name, or `[ultrasonic]` if there is none.
    pub fn new(first: Option<String>, further: Vec<RangeSensor>) -> Self {
        Sensors { first, further }
    }

    /// Returns whether there is no sensor beyond `[ultrasonic]`.
    pub fn are_usual(&self) -> bool {
        self.first.is_none() && self.further.is_empty()
    }

    /// Returns whether there are several.
    pub fn are_several(&self) -> bool {
        !self.further.is_empty()
    }

    /// Returns the name of the first.
    pub fn first(&self) -> &str {
        self.first.as_deref().unwrap_or(ULTRASONIC)
    }

    /// Returns the name of the first if it is not that of `[ultrasonic]`.
    pub fn first_table(&self) -> Option<&str> {
        self.first.as_deref()
    }

    /// Returns the others.
    pub fn further(&self) -> &[RangeSensor] {
        &self.further
    }

    /// Returns the names of all.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        std::iter::once(self.first()).chain(self.further.iter().map(|sensor| sensor.name.as_str()))
    }

    /// Returns all of them, of a robot whose first is mounted like this.
    pub fn all(&self, first: Option<Ultrasonic>) -> Vec<RangeSensor> {
        let first = first.map(|mount| RangeSensor::new(self.first().into(), mount));
        first.into_iter().chain(self.further.iter().cloned()).collect()
    }

    /// Returns the tables of a file whose first sensor is mounted like this: `[ultrasonic]` and the `[[range_sensor]]` tables.
    pub(super) fn tables(&self, mount: Option<Ultrasonic>) -> (Option<Ultrasonic>, Vec<RangeSensor>) {
        match (&self.first, mount) {
            (Some(name), Some(mount)) => {
                let first = RangeSensor::new(name.clone(), mount);
                (None, std::iter::once(first).chain(self.further.iter().cloned()).collect())
            }
            _ => (mount, self.further.clone()),
        }
    }
}

impl RangeSensor {
    /// Returns a sensor of this name with a mounting and a range.
    pub fn new(name: String, mount: Ultrasonic) -> Self {
        let Ultrasonic { x_cm, y_cm, yaw_deg, min_cm, max_cm } = mount;
        RangeSensor { name, x_cm, y_cm, yaw_deg, min_cm, max_cm }
    }

    /// Returns its mounting and its range.
    pub fn mount(&self) -> Ultrasonic {
        let RangeSensor { x_cm, y_cm, yaw_deg, min_cm, max_cm, .. } = *self;
        Ultrasonic { x_cm, y_cm, yaw_deg, min_cm, max_cm }
    }

    /// Returns what is not possible about it beside sensors of these names.
    fn fault(&self, names: &BTreeSet<&str>) -> Option<String> {
        let name = &self.name;
        let is_part_of_a_column = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
        if name == ULTRASONIC {
            Some(format!("a range_sensor is named {ULTRASONIC:?}, which is the name of [ultrasonic] alone"))
        } else if names.contains(name.as_str()) {
            Some(format!("two range sensors are named {name:?}"))
        } else if name.is_empty() || !name.chars().all(is_part_of_a_column) {
            Some(format!(
                "the range sensor's name {name:?} may have letters, digits, _ and - only, as a part of echo_NAME_cm"
            ))
        } else if !self.mount().is_possible() {
            Some(format!("range sensor {name:?} needs numbers within 100000 and 0 <= min_cm < max_cm"))
        } else {
            None
        }
    }
}

/// Returns the column with the readings of a sensor.
pub fn column_of(sensor: &str) -> String {
    if sensor == ULTRASONIC { ECHO.into() } else { format!("echo_{sensor}_cm") }
}

/// Returns the sensor whose readings are in a column of this name, if it is named like one.
pub fn sensor_of(column: &str) -> Option<&str> {
    if column == ECHO { Some(ULTRASONIC) } else { column.strip_prefix("echo_")?.strip_suffix("_cm") }
}
