//! A share as a fraction.

use schemars::JsonSchema;
use serde::Serialize;

/// A share as a fraction.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Share {
    /// Numerator.
    pub count: usize,
    /// Denominator.
    pub of: usize,
}
