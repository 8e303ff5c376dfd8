//! Figures as they are written: with four decimals, beyond which nothing that is measured here says anything.

use serde::{Serialize, Serializer};

/// Four decimals.
pub fn four_decimals(value: f64) -> f64 {
    (value * 1e4).round() / 1e4
}

/// For `serialize_with`: a number with four decimals.
///
/// # Errors
/// Those of the serializer.
pub fn number<S: Serializer>(value: &f64, to: S) -> Result<S::Ok, S::Error> {
    four_decimals(*value).serialize(to)
}

/// For `serialize_with`: an interval with four decimals.
///
/// # Errors
/// Those of the serializer.
pub fn interval<S: Serializer>(value: &[f64; 2], to: S) -> Result<S::Ok, S::Error> {
    value.map(four_decimals).serialize(to)
}
