//! Readings drawn from the outcomes.

use super::outcomes::{Component, Distribution, Outcomes};
use mindgap_foundations::statistics::student;

impl Outcomes {
    /// Draws a reading, cm, within the sensor's range; `None` if there is no reading. `uniform` draws from [0, 1). Without
    /// scatter, readings about a value equal that value.
    pub fn draw(&self, scatters: bool, mut uniform: impl FnMut() -> f64) -> Option<f64> {
        let [low, high] = self.range_cm;
        let component = self.pick(uniform())?;
        Some(component.distribution.draw(scatters, uniform).clamp(low, high))
    }

    /// Returns the component that a uniform draw from [0, 1) selects; `None` if there is no reading.
    pub fn pick(&self, draw: f64) -> Option<&Component> {
        let mut above = draw;
        self.components.iter().find(|component| {
            above -= component.probability;
            above < 0.0
        })
    }
}

impl Distribution {
    fn draw(&self, scatters: bool, mut uniform: impl FnMut() -> f64) -> f64 {
        match *self {
            Distribution::Student { middle_cm, .. } | Distribution::Within { middle_cm, .. } if !scatters => middle_cm,
            Distribution::Student { middle_cm, scale_cm } => middle_cm + scale_cm * student::draw(uniform),
            Distribution::Within { middle_cm, scale_cm, below, inside, at_ends: [at_low, _] } => {
                let share = self.reported() * uniform() - at_low;
                middle_cm + scale_cm * student::quantile(below + share.clamp(0.0, inside))
            }
            Distribution::Uniform { low_cm, high_cm } => low_cm + (high_cm - low_cm) * uniform(),
        }
    }
}
