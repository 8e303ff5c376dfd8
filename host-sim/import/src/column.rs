//! A column of a table, with its unit.

use super::quantities::{Dimension, Unit};
use super::table::Line;
use mindgap_foundations::error::Result;

/// A column of a table.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// Index of the column.
    pub index: usize,
    /// Name of the column.
    pub name: String,
    /// Unit; `None` for a time or motor command whose unit is guessed from the numbers, and for numbers without a unit.
    pub unit: Option<Unit>,
    /// The sign of its numbers.
    pub sign: f64,
}

/// Distance to a wall per time of flight of an echo, cm/ms, at 20 °C.
const ECHO_CM_PER_MS: f64 = 17.15;

impl Column {
    /// Makes a column with a unit.
    pub fn of(index: usize, name: impl Into<String>, unit: Option<Unit>) -> Self {
        Column { index, name: name.into(), unit, sign: 1.0 }
    }

    /// Returns the number in a cell, in ms, cm, rad, cm/s or rad/s if its unit is known; `None` if it is empty.
    ///
    /// # Errors
    /// When it is not a number.
    pub fn value(&self, line: &Line) -> Result<Option<f64>> {
        let factor = self.sign * self.unit.map_or(1.0, |unit| unit.factor);
        Ok(line.number(self.index)?.map(|number| factor * number))
    }

    /// Returns whether the column holds the time of flight of echoes.
    pub fn is_time_of_flight(&self) -> bool {
        self.unit.is_some_and(|unit| unit.dimension == Dimension::Time)
    }

    /// Returns the distance in a cell, cm; `None` without an echo. Negative ones may be bytes whose sign was misread.
    ///
    /// # Errors
    /// When it is not a number.
    pub fn reading_cm(&self, line: &Line) -> Result<Option<f64>> {
        let factor = if self.is_time_of_flight() { ECHO_CM_PER_MS } else { 1.0 };
        Ok(self.value(line)?.map(|value| factor * value).filter(|cm| cm.is_finite() && *cm != 0.0))
    }
}
