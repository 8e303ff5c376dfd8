//! Columns that a mapping file assigns.

use super::by_name::{complete, pose_columns};
use super::{Columns, CommandColumns, TimeColumns, unit_of};
use crate::column::Column;
use crate::mapping::Mapped;
use crate::quantities::{Quantity, meaning};
use crate::table::Table;
use crate::units::Units;
use mindgap_logs::range_sensor::RangeSensor;

/// Finds the columns that are mapped, of a robot with these range sensors.
///
/// # Errors
/// When a column, unit or range sensor is missing.
pub fn columns(table: &Table, mapped: &[Mapped], units: &Units, sensors: &[RangeSensor]) -> Result<Columns, String> {
    let mut found: Vec<(Quantity, Column)> = Vec::new();
    let mut ranges = Vec::new();
    for Mapped { quantity, sensor, column, unit, negate } in mapped {
        let names = table.names();
        let index = names.iter().position(|name| name == column).ok_or_else(|| {
            format!("has no column {column:?}, which the --map file names: its columns are {}", names.join(", "))
        })?;
        let fits = |unit: &crate::quantities::Unit| quantity.dimensions().contains(&unit.dimension);
        let stated = unit.or(table.unit(index).filter(fits)).or(meaning(column).unit.filter(fits));
        let (unit, _) = unit_of(*quantity, column, stated, units, false)?;
        let sign = if *negate { -1.0 } else { 1.0 };
        let found_column = Column { index, name: column.clone(), unit, sign };
        if let Some(name) = sensor {
            let index = sensors.iter().position(|sensor| sensor.name == *name);
            let what = || format!("range_{name} in the --map file: robot.toml has no range sensor {name:?}");
            ranges.push((index.ok_or_else(what)?, found_column.clone()));
        } else if *quantity == Quantity::Range {
            ranges.push((0, found_column.clone()));
        }
        found.push((*quantity, found_column));
    }
    let of = |quantity: Quantity| found.iter().find(|(q, _)| *q == quantity).map(|(_, column)| column.clone());
    let pair = |a, b| of(a).zip(of(b)).map(|(a, b)| [a, b]);
    let times =
        of(Quantity::Time).map(|column| TimeColumns { columns: vec![column], is_stamp: false, is_shared: true });
    let twist = pair(Quantity::Forward, Quantity::Turn).map(|columns| CommandColumns::of(true, columns)).transpose()?;
    let wheels = pair(Quantity::Left, Quantity::Right).map(|columns| CommandColumns::of(false, columns)).transpose()?;
    if twist.is_some() && wheels.is_some() {
        return Err("both speeds and wheels are mapped as the commands: keep one pair".into());
    }
    let quantities: Vec<(Quantity, &str)> = found.iter().map(|(q, column)| (*q, column.name.as_str())).collect();
    complete(table, &quantities)?;
    Ok(Columns {
        times: times.into_iter().collect(),
        commands: twist.or(wheels),
        bodies: pose_columns(String::new(), of).into_iter().collect(),
        sideways: of(Quantity::Sideways),
        ranges,
        counters: [Quantity::CountLeft, Quantity::CountRight].map(|side| of(side).into_iter().collect()),
        gyro: of(Quantity::Gyro),
        ..Columns::default()
    })
}
