//! Assigns quantities and units to the columns of a table: by the layout of a known format, by a mapping file, or by name.

mod by_mapping;
mod by_name;
mod commands;
mod joints;
mod times;

use super::body::{Body, Rotation};
use super::column::Column;
use super::left_out::LeftOut;
use super::mapping::Mapped;
use super::quantities::{Dimension, Quantity, Unit};
use super::table::Table;
use super::units::Units;
use super::upright::Axis;
use mindgap_foundations::error::{Error, Result};
use mindgap_logs::range_sensor::RangeSensor;

pub use self::commands::{CommandColumns, CommandKind};
pub use self::times::{ReadTimes, TimeColumns};

/// The recognised columns of a table.
#[derive(Default)]
pub struct Columns {
    /// Clocks; which of several is used depends on their times.
    pub times: Vec<TimeColumns>,
    /// Commands, if any.
    pub commands: Option<CommandColumns>,
    /// Commanded speed to the left, which is reported and not used.
    pub sideways: Option<Column>,
    /// Bodies with their poses.
    pub bodies: Vec<Body>,
    /// The axis that points upwards where the motion does not show it.
    pub upright: Axis,
    /// Readings of range sensors, with the index of the sensor.
    pub ranges: Vec<(usize, Column)>,
    /// Angles of the left and of the right wheels.
    pub counters: [Vec<Column>; 2],
    /// Yaw rate that the robot measures, if any.
    pub gyro: Option<Column>,
    /// Guesses made.
    pub guessed: Vec<String>,
    /// Columns that are not used, with the reason.
    pub left_out: Vec<LeftOut>,
}

impl Columns {
    /// Finds the columns of a table of a robot with these range sensors: those that are `mapped`, or else those with recognised
    /// names.
    ///
    /// # Errors
    /// When a required column or unit is missing, or columns are ambiguous.
    pub fn find(table: &Table, mapped: Option<&[Mapped]>, units: &Units, sensors: &[RangeSensor]) -> Result<Self> {
        let found = match mapped {
            Some(mapped) => by_mapping::columns(table, mapped, units, sensors),
            None => by_name::columns(table, units, sensors),
        };
        let mut columns = found.map_err(|what| Error::at_line(&table.file, table.header.line, what))?;
        columns.note_unused(table);
        for (_, range) in columns.ranges.iter().filter(|(_, range)| range.is_time_of_flight()) {
            columns
                .guessed
                .push(format!("{} is the time of flight of echoes: a wall at 1 cm for every 58.3 us", range.name));
        }
        if let [_, _, ..] = sensors {
            let what = |(sensor, range): &(usize, Column)| {
                format!("{} is of range sensor {}", range.name, sensors[*sensor].name)
            };
            columns.guessed.extend(columns.ranges.iter().map(what));
        }
        Ok(columns)
    }

    /// Returns the assignments of quantities to columns, except for the time.
    pub fn mapped(&self) -> Vec<String> {
        let mut mapped = Vec::new();
        let mut assign =
            |quantity: Quantity, column: &Column| mapped.push(format!("{} = {}", quantity.name(), column.name));
        if let [body] = self.bodies.as_slice() {
            let [x, y, z] = &body.position;
            let position = [(Quantity::X, x), (Quantity::Y, y), (Quantity::Z, z)];
            position.iter().for_each(|(q, column)| column.iter().for_each(|column| assign(*q, column)));
            match &body.rotation {
                Rotation::Heading(column) => assign(Quantity::Heading, column),
                Rotation::Quaternion(parts) => {
                    let parts = [Quantity::Qx, Quantity::Qy, Quantity::Qz, Quantity::Qw].into_iter().zip(parts);
                    parts.for_each(|(q, column)| column.iter().for_each(|column| assign(q, column)));
                }
                Rotation::Euler(angles) | Rotation::Vector(angles) => {
                    angles.iter().for_each(|column| assign(Quantity::Heading, column));
                }
            }
        }
        if let Some(commands) = &self.commands {
            commands.assignments().into_iter().for_each(|(q, column)| assign(q, column));
        }
        self.ranges.iter().for_each(|(_, column)| assign(Quantity::Range, column));
        let [left, right] = &self.counters;
        left.iter().for_each(|column| assign(Quantity::CountLeft, column));
        right.iter().for_each(|column| assign(Quantity::CountRight, column));
        self.gyro.iter().for_each(|column| assign(Quantity::Gyro, column));
        mapped
    }

    /// Notes every column that is neither used nor left out for a reason.
    fn note_unused(&mut self, table: &Table) {
        let bodies = self.bodies.iter().flat_map(Body::columns);
        let commands = self.commands.iter().flat_map(|commands| &commands.columns);
        let times = self.times.iter().flat_map(|times| &times.columns);
        let used: Vec<usize> = bodies
            .chain(commands)
            .chain(times)
            .chain(self.ranges.iter().map(|(_, column)| column))
            .chain(self.counters.iter().flatten())
            .chain(&self.gyro)
            .chain(&self.sideways)
            .map(|column| column.index)
            .collect();
        let is_noted = |name: &String| self.left_out.iter().any(|left_out| left_out.name == *name);
        let unused = table.names().iter().enumerate().filter(|(index, name)| !used.contains(index) && !is_noted(name));
        let unused: Vec<LeftOut> = unused
            .filter(|(_, name)| !name.is_empty())
            .map(|(_, name)| LeftOut::column(name, "not used: its name is not recognised; assign it in a --map file"))
            .collect();
        self.left_out.extend(unused);
    }
}

/// Returns the unit of a column: the stated one, or else that of the options, or else that of ROS messages.
///
/// # Errors
/// When a unit is required and there is none.
fn unit_of(
    quantity: Quantity,
    name: &str,
    stated: Option<Unit>,
    units: &Units,
    is_field: bool,
) -> std::result::Result<(Option<Unit>, bool), String> {
    let of = |factor: Option<f64>, dimension| factor.map(|factor| Unit { dimension, factor });
    let length = |dimension| of(units.length.map(|length| length.cm()), dimension);
    let angle = |dimension| of(units.angle.map(|angle| angle.rad()), dimension);
    let (option, si, how) = match quantity.dimensions()[0] {
        Dimension::Time => (of(units.time.map(|time| time.ms()), Dimension::Time), None, None),
        dimension @ Dimension::Length => {
            (length(dimension), Some(100.0), Some("_m, _cm or _mm, or give --length-unit"))
        }
        dimension @ Dimension::Angle => (angle(dimension), Some(1.0), Some("_rad or _deg, or give --angle-unit")),
        dimension @ Dimension::Speed => {
            (length(dimension), Some(100.0), Some("_m_s, _cm_s or _mm_s, or give --length-unit"))
        }
        dimension @ Dimension::Rate => (angle(dimension), Some(1.0), Some("_rad_s or _deg_s, or give --angle-unit")),
        Dimension::Command | Dimension::Number => (None, None, None),
    };
    let by_convention = of(si.filter(|_| is_field), quantity.dimensions()[0]);
    let unit = stated.or(option).or(by_convention);
    match how {
        Some(how) if unit.is_none() => Err(format!("column {name} has no unit: name it {name}{how}")),
        _ => Ok((unit, stated.or(option).is_none() && by_convention.is_some())),
    }
}

#[cfg(test)]
mod tests;
