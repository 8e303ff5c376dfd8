//! How likely the outcomes make what was logged.

use super::outcomes::{Distribution, Outcomes};
use mindgap_foundations::statistics::student;

impl Outcomes {
    /// The log-likelihood of a logged reading: of its value per cm, or of none.
    pub fn log_likelihood(&self, echo_cm: Option<f64>) -> f64 {
        libm::log(echo_cm.map_or(self.none, |echo_cm| self.density(echo_cm)))
    }

    /// The log-likelihood of there being a reading, or none.
    pub fn log_detection(&self, echo_cm: Option<f64>) -> f64 {
        libm::log(echo_cm.map_or(self.none, |_| 1.0 - self.none))
    }

    /// The density at a reading, per cm; beyond the sensor's range, that at its end.
    pub fn density(&self, echo_cm: f64) -> f64 {
        let echo_cm = echo_cm.clamp(self.range_cm[0], self.range_cm[1]);
        let possible = self.components.iter().filter(|component| component.probability > 0.0);
        possible.map(|component| component.probability * component.distribution.density(echo_cm)).sum()
    }
}

impl Distribution {
    /// The density at a reading, per cm.
    fn density(&self, echo_cm: f64) -> f64 {
        match *self {
            Distribution::Student { middle_cm, scale_cm } => student::density(echo_cm - middle_cm, scale_cm),
            // Whoever asks is within the range.
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
