//! Figures as they are written: with four decimals, beyond which nothing that is measured here says anything.

use serde::{Serialize, Serializer};

/// Four decimals.
pub fn four_decimals(value: f64) -> f64 {
    (value * 1e4).round() / 1e4
}

/// Three digits, as strengths of effects are told.
pub fn three_digits(value: f64) -> f64 {
    format!("{value:.2e}").parse().unwrap_or(value)
}

/// For `serialize_with`: a number with four decimals.
///
/// # Errors
/// Those of the serializer.
pub fn number<S: Serializer>(value: &f64, to: S) -> Result<S::Ok, S::Error> {
    four_decimals(*value).serialize(to)
}

/// For `serialize_with`: a number with four decimals, if there is one.
///
/// # Errors
/// Those of the serializer.
pub fn optional<S: Serializer>(value: &Option<f64>, to: S) -> Result<S::Ok, S::Error> {
    value.map(four_decimals).serialize(to)
}

/// For `serialize_with`: an interval with four decimals.
///
/// # Errors
/// Those of the serializer.
pub fn interval<S: Serializer>(value: &[f64; 2], to: S) -> Result<S::Ok, S::Error> {
    value.map(four_decimals).serialize(to)
}
