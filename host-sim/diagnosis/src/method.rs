//! The settings of a diagnosis.

use super::calibration::Calibration;
use super::channel::Channel;
use mindgap_models::effects::{CATALOGUE, Effect};

/// What a diagnosis looks for, when a gain counts, and what its draws follow from.
#[derive(Clone, Copy)]
pub struct Method {
    /// The effects that compete.
    pub catalogue: &'static [&'static Effect],
    /// When a gain counts.
    pub calibration: Calibration,
    /// Seed of bootstrap intervals and of simulated noise; the verdict does not depend on it.
    pub seed: u64,
}

impl Method {
    /// The seed unless another is given.
    pub const SEED: u64 = 1;

    /// The thresholds for so many rows against a simulator that learned its motion from so many steps if it did, among all
    /// that competes.
    pub fn calibration_for(&self, rows: usize, trained_on: Option<f64>) -> Calibration {
        self.calibration.among(self.catalogue.len(), Channel::ALL.len()).for_rows(rows, trained_on)
    }
}

impl Default for Method {
    fn default() -> Self {
        Method { catalogue: CATALOGUE, calibration: Calibration::shipped(), seed: Method::SEED }
    }
}
