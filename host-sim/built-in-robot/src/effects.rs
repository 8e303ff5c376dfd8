//! Effects: deviations of the built-in robot from its healthy state, each with an id.
//!
//! An effect changes a part or the floor (`fitting`), never a step of a simulator.

mod catalogue;
mod entry;
pub(super) mod fitting;
mod held_out;
mod scale;

use std::fmt;
use std::str::FromStr;

pub use catalogue::Effect;
pub use held_out::HeldOut;
pub use scale::Scale;

use mindgap_foundations::chance::Generator;

/// An active effect; its text form is `ID`, `ID=STRENGTH` or `ID=STRENGTH@DETAIL`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ActiveEffect {
    /// The effect.
    pub effect: Effect,
    /// Strength, in the unit of [`Effect::strength_range`].
    pub strength: f64,
    /// Second parameter, in the unit of [`Effect::detail_range`]; zero for an effect without one.
    pub detail: f64,
}

impl ActiveEffect {
    /// The effect at its default strength, which is clearly visible in logs.
    pub fn new(effect: Effect) -> Self {
        let detail = effect.detail_range().map_or(0.0, |range| range.default);
        ActiveEffect { effect, strength: effect.strength_range().default, detail }
    }

    /// The effect at a random strength within its range and away from neutral.
    pub fn random(effect: Effect, rng: &mut Generator) -> Self {
        let strength = effect.strength_range().draw(rng);
        let detail = effect.detail_range().map_or(0.0, |range| range.draw(rng));
        ActiveEffect { effect, strength, detail }
    }
}

impl fmt::Display for ActiveEffect {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{}={}", self.effect, self.strength)?;
        if self.effect.detail_range().is_some() { write!(f, "@{}", self.detail) } else { Ok(()) }
    }
}

impl FromStr for ActiveEffect {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (id, numbers) = match text.split_once('=') {
            Some((id, numbers)) => (id, Some(numbers)),
            None => (text, None),
        };
        let mut active = ActiveEffect::new(id.parse()?);
        let Some(numbers) = numbers else { return Ok(active) };
        let (strength, detail) = match numbers.split_once('@') {
            Some((strength, detail)) => (strength, Some(detail)),
            None => (numbers, None),
        };
        active.strength = active.effect.strength_range().parse(strength).map_err(|what| format!("{id}: {what}"))?;
        if let Some(detail) = detail {
            let range = active.effect.detail_range().ok_or(format!("{id} has no second number"))?;
            active.detail = range.parse(detail).map_err(|what| format!("{id}: {what}"))?;
        }
        Ok(active)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mindgap_foundations::chance::generator;

    #[test]
    fn text_and_effect_are_one() {
        let mut rng = generator(1, &[]);
        for effect in Effect::all() {
            for active in [ActiveEffect::new(effect), ActiveEffect::random(effect, &mut rng)] {
                assert_eq!(active.to_string().parse(), Ok(active));
            }
            assert_eq!(effect.id().parse(), Ok(ActiveEffect::new(effect)));
        }
    }

    #[test]
    fn a_wrong_name_or_number_is_refused() {
        let wrong = |text: &str| text.parse::<ActiveEffect>().unwrap_err();
        let unknown = wrong("battery_sagg");
        assert!(Effect::all().all(|effect| unknown.contains(effect.id())), "{unknown}");
        assert!(wrong("battery_sag=much").contains("\"much\" is no number"));
        assert!(wrong("battery_sag=-1").contains("between 0 and"));
        assert!(wrong("battery_sag=NaN").contains("between 0 and"));
        assert!(wrong("battery_sag=0.2@3").contains("no second number"));
        assert!(wrong("slope=0.05@north").contains("\"north\" is no number"));
    }
}
