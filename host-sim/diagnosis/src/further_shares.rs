//! Model-form error by effect: how much of what an effect explains a better form of it could gain.
//!
//! Forms differ in how near they are to robots. A track of another width is one number; how tyres slide or a tracked heading
//! lags is a guess at a mechanism, and what it leaves looks like a second effect.

use std::collections::BTreeMap;
use std::sync::LazyLock;

use serde::{Deserialize, Serialize};

use super::shipped;

/// Fractions of what effects explain in a channel that their model-form error could account for, by effect; only those that
/// are larger than the [usual](super::calibration::Calibration::further_share).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct FurtherShares(BTreeMap<String, f64>);

/// The file written by `mindgap challenge calibrate --further-shares`.
const SHIPPED: &str = include_str!("further_shares.toml");

static FURTHER_SHARES: LazyLock<FurtherShares> = LazyLock::new(|| shipped::read(SHIPPED));

impl FurtherShares {
    /// Makes a table from fractions by id.
    pub const fn new(by_effect: BTreeMap<String, f64>) -> Self {
        FurtherShares(by_effect)
    }

    /// The fractions that diagnoses use.
    pub fn shipped() -> &'static Self {
        &FURTHER_SHARES
    }

    /// Returns the text of a file of fractions, with the command that made it.
    pub fn to_text(&self, command: &str) -> String {
        shipped::to_text(self, command)
    }

    /// Returns the largest fraction of these effects; zero if none has its own.
    pub fn largest<'a>(&self, ids: impl Iterator<Item = &'a str>) -> f64 {
        ids.filter_map(|id| self.0.get(id)).fold(0.0, |largest: f64, share| largest.max(*share))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calibration::Calibration;
    use mindgap_models::effects::CATALOGUE;

    #[test]
    fn shipped_file_equals_what_the_command_writes() {
        let command = shipped::command(SHIPPED);
        assert!(command.starts_with("mindgap challenge calibrate --cases "), "{command}");
        assert_eq!(FurtherShares::shipped().to_text(command), SHIPPED);
    }

    #[test]
    fn shipped_fractions_are_of_effects_and_larger_than_usual() {
        for (effect, share) in &FurtherShares::shipped().0 {
            assert!(CATALOGUE.iter().any(|known| known.id == effect), "{effect}");
            assert!((Calibration::shipped().further_share..1.0).contains(share), "{effect}: {share}");
        }
    }
}
