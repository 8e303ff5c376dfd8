//! The strength of a named effect in words.

use serde_json::{Map, Value};

use super::ruler::{ends_of, written};
use super::verdict::NamedEffect;
use mindgap_foundations::statistics::rounding::three_digits;

impl NamedEffect {
    /// Describes its parameters, each number with its interval, or as beyond the bound at which it lies.
    pub fn strength(&self) -> String {
        strength(&self.parameters, &self.intervals, &self.at_bound)
    }
}

/// Describes parameters with their intervals; `at_bound` are the names of those at a bound.
pub(super) fn strength(parameters: &Map<String, Value>, intervals: &Map<String, Value>, at_bound: &[&str]) -> String {
    let parameters = parameters.iter().map(|(name, value)| match (value.as_f64(), ends_of(intervals, name)) {
        (Some(number), _) if at_bound.contains(&name.as_str()) => format!("{name} beyond {}", three_digits(number)),
        (Some(number), Some(ends)) => format!("{name} {}", written(number, ends).concat()),
        (Some(number), None) => format!("{name} {}", three_digits(number)),
        (None, _) => format!("{name} {}", value.as_str().unwrap_or_default()),
    });
    parameters.collect::<Vec<String>>().join(", ")
}
