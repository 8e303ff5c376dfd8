//! robot.toml, the dimensions of a robot as Mindgap reads them.

use std::path::Path;

use toml::de::{DeTable, DeValue};

use super::cause::Query;
use super::edit::{Answer, Numbers};
use super::refusal;
use mindgap_foundations::error::Result;
use mindgap_logs::Robot;

/// Checks that a file is robot.toml.
///
/// # Errors
/// As [`Robot::parse`].
pub fn check(path: &Path, text: &str) -> Result<()> {
    Robot::parse(path, text).map(|_| ())
}

/// Returns the changes that write a cause.
///
/// # Errors
/// In words, if there is no key for it.
pub fn changes(text: &str, query: &Query) -> Answer {
    let (keys, unit, reason): (&[&str], &'static str, &str) = match query.cause.effect.as_str() {
        "drive_scale" => (&["full_speed_cm_s"], "cm/s", "full_speed_cm_s * factor"),
        "track_width" => (&["track_cm"], "cm", "track_cm / factor"),
        "sonar_yaw" => (&["ultrasonic", "yaw_deg"], "deg", "yaw_deg + deg"),
        _ => return Err(refusal::no_tag("robot.toml")),
    };
    let at = place(text, keys).ok_or_else(|| format!("robot.toml has no {}", keys.join(".")))?;
    let numbers = Numbers::parse(text, at, keys.join("."))?;
    let old = numbers.value(0)?;
    let new = match query.cause.effect.as_str() {
        "drive_scale" => query.number("factor")?.map(|f| old * f),
        "track_width" => query.number("factor")?.map(|f| old / f),
        _ => query.number("deg")?.map(|deg| old + deg),
    };
    Ok(vec![numbers.set(&[(0, new)], unit, reason.into())])
}

/// Returns the bytes of a value.
fn place(text: &str, keys: &[&str]) -> Option<std::ops::Range<usize>> {
    let root = DeTable::parse(text).ok()?;
    let (last, tables) = keys.split_last()?;
    let mut table = root.get_ref();
    for key in tables {
        let DeValue::Table(inner) = table.get(*key)?.get_ref() else { return None };
        table = inner;
    }
    Some(table.get(*last)?.span())
}
