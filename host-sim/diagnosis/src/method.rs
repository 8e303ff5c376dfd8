//! The settings of a diagnosis.

use super::calibration::Calibration;
use super::further_shares::FurtherShares;
use mindgap_foundations::channel::Channel;
use mindgap_models::effects::{CATALOGUE, Effect, Place};

/// The candidates, thresholds and seed of a diagnosis.
#[derive(Clone, Copy)]
pub struct Method {
    /// The effects that compete.
    pub catalogue: &'static [&'static Effect],
    /// Where these sit; `None` if anywhere.
    pub place: Option<Place>,
    /// The thresholds.
    pub calibration: Calibration,
    /// Model-form error by effect.
    pub further_shares: &'static FurtherShares,
    /// Seed of bootstrap intervals and simulated noise. The verdict does not depend on it.
    pub seed: u64,
    /// Whether a robot is there to drive what is proposed: then a script is proposed even between names that are not certain
    /// enough to be reported.
    pub is_driving: bool,
}

impl Method {
    /// The default seed.
    pub const SEED: u64 = 1;

    /// Returns the thresholds for this number of rows, among all that competes, against a simulator that learned its motion
    /// from `trained_on` steps.
    pub fn calibration_for(&self, rows: usize, trained_on: Option<f64>) -> Calibration {
        self.calibration.among(self.catalogue.len(), Channel::SIMULATED.len()).for_rows(rows, trained_on)
    }
}

impl Default for Method {
    fn default() -> Self {
        Method {
            catalogue: CATALOGUE,
            place: None,
            calibration: Calibration::shipped(),
            further_shares: FurtherShares::shipped(),
            seed: Method::SEED,
            is_driving: false,
        }
    }
}
