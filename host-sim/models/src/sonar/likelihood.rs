//! Likelihood of logged readings given the outcomes.

use super::outcomes::{Distribution, Outcomes};
use mindgap_foundations::statistics::student;

impl Outcomes {
    /// Returns the log-likelihood of a logged reading: of its value per cm, or of no reading.
    pub fn log_likelihood(&self, echo_cm: Option<f64>) -> f64 {
        libm::log(echo_cm.map_or(self.none, |echo_cm| self.density(echo_cm)))
    }

    /// Returns the log-likelihood of whether there was a reading.
    pub fn log_detection(&self, echo_cm: Option<f64>) -> f64 {
        libm::log(echo_cm.map_or(self.none, |_| 1.0 - self.none))
    }

    /// Returns the density at a reading, per cm; beyond the sensor's range, the density at its end.
    pub fn density(&self, echo_cm: f64) -> f64 {
        let echo_cm = echo_cm.clamp(self.range_cm[0], self.range_cm[1]);
        let possible = self.components.iter().filter(|component| component.probability > 0.0);
        possible.map(|component| component.probability * component.distribution.density(echo_cm)).sum()
    }
}

impl Distribution {
    /// Returns the density at a reading, per cm.
    fn density(&self, echo_cm: f64) -> f64 {
        match *self {
            Distribution::Student { middle_cm, scale_cm } => student::density(echo_cm - middle_cm, scale_cm),
            // The caller clamps readings to the range.
            Distribution::Within { middle_cm, scale_cm, .. } => {
                student::density(echo_cm - middle_cm, scale_cm) / self.reported()
            }
            Distribution::Uniform { low_cm, high_cm } if (low_cm..=high_cm).contains(&echo_cm) => {
                1.0 / (high_cm - low_cm)
            }
            Distribution::Uniform { .. } => 0.0,
        }
    }
}
