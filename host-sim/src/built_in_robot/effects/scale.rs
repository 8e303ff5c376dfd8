//! The scale of an effect's number: its unit, where it does nothing, and how far it goes.

use rand::RngExt;

use crate::chance::Generator;

/// Which numbers an effect takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    /// What the number means.
    pub unit: &'static str,
    /// The number at which nothing is changed.
    pub neutral: f64,
    /// The least number allowed.
    pub lowest: f64,
    /// The largest number allowed.
    pub highest: f64,
    /// A random number is at least so far from the neutral one.
    pub least: f64,
    /// The number when none is given.
    pub default: f64,
}

impl Scale {
    /// A number that does nothing at zero and more the larger it is.
    pub(super) const fn rising(unit: &'static str, least: f64, default: f64, highest: f64) -> Self {
        Scale { unit, neutral: 0.0, lowest: 0.0, highest, least, default }
    }

    /// A number that works either way from zero.
    pub(super) const fn signed(unit: &'static str, least: f64, default: f64, highest: f64) -> Self {
        Scale { unit, neutral: 0.0, lowest: -highest, highest, least, default }
    }

    /// A factor that does nothing at one.
    pub(super) const fn factor(unit: &'static str, lowest: f64, default: f64, highest: f64, least: f64) -> Self {
        Scale { unit, neutral: 1.0, lowest, highest, least, default }
    }

    /// A number that does nothing at `highest` and more the smaller it is.
    pub(super) const fn falling(unit: &'static str, lowest: f64, default: f64, highest: f64, least: f64) -> Self {
        Scale { unit, neutral: highest, lowest, highest, least, default }
    }

    /// A number of which one is as good as another.
    pub(super) const fn free(unit: &'static str, lowest: f64, default: f64, highest: f64) -> Self {
        Scale { unit, neutral: lowest, lowest, highest, least: 0.0, default }
    }

    /// A random number that the scale allows and that is not next to neutral, each alike.
    pub fn draw(&self, rng: &mut Generator) -> f64 {
        let below = (self.neutral - self.least - self.lowest).max(0.0);
        let above = (self.highest - self.neutral - self.least).max(0.0);
        let at = rng.random::<f64>() * (below + above);
        if at < below { self.lowest + at } else { self.neutral + self.least + at - below }
    }

    /// The number that a text gives.
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
    use crate::chance::generator;

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
