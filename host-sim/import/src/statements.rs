//! What a user states about tables.

use super::mapping::Mapping;
use super::units::Units;
use mindgap_logs::range_sensor::RangeSensor;

/// What a user states about the files.
#[derive(Clone, Debug, Default)]
pub struct Statements {
    /// Quantities of columns.
    pub mapping: Mapping,
    /// Units of columns whose names state none.
    pub units: Units,
    /// Name of the robot among several bodies.
    pub body: Option<String>,
    /// Range sensors of the robot.
    pub sensors: Vec<RangeSensor>,
}
