//! The scale of an effect's parameter: unit, neutral value and bounds.

use rand::RngExt;

use mindgap_foundations::chance::Generator;

/// The scale of a parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    /// Meaning and unit, for people.
    pub unit: &'static str,
    /// The value that changes nothing.
    pub neutral: f64,
    /// Lower bound.
    pub lowest: f64,
    /// Upper bound.
    pub highest: f64,
    /// Least distance of a random value from the neutral one.
    pub least: f64,
    /// Default value.
    pub default: f64,
}

impl Scale {
    /// A scale whose effect grows from zero.
    pub(super) const fn rising(unit: &'static str, least: f64, default: f64, highest: f64) -> Self {
        Scale { unit, neutral: 0.0, lowest: 0.0, highest, least, default }
    }

    /// A scale symmetric about zero.
    pub(super) const fn signed(unit: &'static str, least: f64, default: f64, highest: f64) -> Self {
        Scale { unit, neutral: 0.0, lowest: -highest, highest, least, default }
    }

    /// A factor, neutral at one.
    pub(super) const fn factor(unit: &'static str, lowest: f64, default: f64, highest: f64, least: f64) -> Self {
        Scale { unit, neutral: 1.0, lowest, highest, least, default }
    }

    /// A scale whose effect grows as the value falls from `highest`.
    pub(super) const fn falling(unit: &'static str, lowest: f64, default: f64, highest: f64, least: f64) -> Self {
        Scale { unit, neutral: highest, lowest, highest, least, default }
    }

    /// A scale without a neutral value, such as a direction.
    pub(super) const fn free(unit: &'static str, lowest: f64, default: f64, highest: f64) -> Self {
        Scale { unit, neutral: lowest, lowest, highest, least: 0.0, default }
    }

    /// A uniform random value within the bounds and away from neutral.
    pub fn draw(&self, rng: &mut Generator) -> f64 {
        let below = (self.neutral - self.least - self.lowest).max(0.0);
        let above = (self.highest - self.neutral - self.least).max(0.0);
        let at = rng.random::<f64>() * (below + above);
        if at < below { self.lowest + at } else { self.neutral + self.least + at - below }
    }

    /// Parses a value within the bounds.
    pub(super) fn parse(&self, text: &str) -> Result<f64, String> {
        let number: f64 = text.parse().map_err(|_| format!("{text:?} is no number"))?;
        if !(self.lowest..=self.highest).contains(&number) {
            return Err(format!("{number} must lie between {} and {} ({})", self.lowest, self.highest, self.unit));
        }
        Ok(number)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mindgap_foundations::chance::generator;

    #[test]
    fn random_numbers_fill_the_scale_but_for_its_neutral_part() {
        let mut rng = generator(3, &[]);
        for scale in
            [Scale::rising("", 0.2, 0.5, 1.0), Scale::signed("", 0.2, 0.5, 1.0), Scale::free("", -3.0, 0.0, 3.0)]
        {
            let drawn: Vec<f64> = (0..2000).map(|_| scale.draw(&mut rng)).collect();
            assert!(drawn.iter().all(|d| (scale.lowest..=scale.highest).contains(d)));
            assert!(drawn.iter().all(|d| (d - scale.neutral).abs() >= scale.least));
            let low = drawn.iter().copied().fold(f64::INFINITY, f64::min);
            let high = drawn.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            let reached = if scale.lowest == scale.neutral { scale.neutral + scale.least } else { scale.lowest };
            assert!(low < reached + 0.05 && high > scale.highest - 0.05);
        }
    }
}
