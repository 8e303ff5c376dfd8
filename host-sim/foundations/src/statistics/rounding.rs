//! Rounding of written figures: four decimals, more than any measurement here resolves.

use serde::{Serialize, Serializer};

/// Rounds to four decimals.
pub fn four_decimals(value: f64) -> f64 {
    (value * 1e4).round() / 1e4
}

/// Rounds to three significant digits, as effect strengths are reported.
pub fn three_digits(value: f64) -> f64 {
    format!("{value:.2e}").parse().unwrap_or(value)
}

/// Serialises a number with four decimals, for `serialize_with`.
///
/// # Errors
/// Returns the serializer's errors.
pub fn number<S: Serializer>(value: &f64, to: S) -> Result<S::Ok, S::Error> {
    four_decimals(*value).serialize(to)
}

/// Serialises an optional number with four decimals, for `serialize_with`.
///
/// # Errors
/// Returns the serializer's errors.
pub fn optional<S: Serializer>(value: &Option<f64>, to: S) -> Result<S::Ok, S::Error> {
    value.map(four_decimals).serialize(to)
}

/// Serialises an interval with four decimals, for `serialize_with`.
///
/// # Errors
/// Returns the serializer's errors.
pub fn interval<S: Serializer>(value: &[f64; 2], to: S) -> Result<S::Ok, S::Error> {
    value.map(four_decimals).serialize(to)
}

/// Serialises an optional interval with four decimals, for `serialize_with`.
///
/// # Errors
/// Returns the serializer's errors.
pub fn optional_interval<S: Serializer>(value: &Option<[f64; 2]>, to: S) -> Result<S::Ok, S::Error> {
    value.map(|ends| ends.map(four_decimals)).serialize(to)
}
