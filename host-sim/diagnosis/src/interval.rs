//! 95 % intervals of reported numbers: what chance leaves open, and what the form of an effect does.
//!
//! Chance is measured by the jackknife over blocks, with Student's law for their number. A form that is not quite the robot's
//! shifts an estimate by a share of its departure from neutral, however many rows there are. That share is measured on robots
//! whose effects have other forms (split-conformal prediction, Vovk et al. 2005): [`FormErrors`].

use std::collections::BTreeMap;
use std::sync::LazyLock;

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};

use super::fit::Fitted;
use super::shipped;
use mindgap_logs::Robot;
use mindgap_models::effects::Parameter;

/// How far the form of an effect shifts its reported numbers, as shares of their departure from neutral; of a radian for
/// directions.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FormErrors {
    /// The share for numbers that were not measured.
    pub usual: f64,
    /// The share by effect and parameter.
    pub measured: BTreeMap<String, BTreeMap<String, f64>>,
}

/// The file written by `mindgap challenge score --form-errors`.
const SHIPPED: &str = include_str!("form_errors.toml");

static FORM_ERRORS: LazyLock<FormErrors> = LazyLock::new(|| shipped::read(SHIPPED));

impl FormErrors {
    /// The form errors that diagnoses use.
    pub fn shipped() -> &'static Self {
        &FORM_ERRORS
    }

    /// Returns the text of a file of form errors.
    pub fn to_text(&self) -> String {
        shipped::to_text(self, "mindgap challenge score FOLDER --form-errors FILE")
    }

    /// Returns the share for a number.
    pub fn share(&self, effect: &str, parameter: &str) -> f64 {
        self.measured.get(effect).and_then(|of| of.get(parameter)).copied().unwrap_or(self.usual)
    }
}

/// Returns the intervals of the reported numbers of one effect.
pub fn intervals(fit: &Fitted, effect: usize, robot: &Robot) -> Map<String, Value> {
    let candidate = &fit.hypothesis.candidates[effect];
    let places = fit.parameters_of(effect).zip(candidate.variant.parameters);
    let of_parameter = |(place, parameter): (usize, &Parameter)| {
        let (name, number, by_chance) = parameter.reported_between(fit.values[place], fit.interval(place), robot)?;
        let share = FormErrors::shipped().share(candidate.effect, name);
        let form_error = share * parameter.departure(number, robot);
        let ends = by_chance.map(|end| number + (end - number).signum() * libm::hypot(end - number, form_error));
        Some((name.to_string(), json!(within_bounds(ends, parameter, robot))))
    };
    places.filter_map(of_parameter).collect()
}

fn within_bounds(ends: [f64; 2], parameter: &Parameter, robot: &Robot) -> [f64; 2] {
    let reached = [parameter.bounds[0], parameter.bounds[1], parameter.nominal].map(|v| parameter.number(v, robot));
    let [Some(a), Some(b), Some(neutral)] = reached else { return ends };
    // A magnitude is smallest where nothing is changed.
    let (low, high) = (a.min(b).min(neutral), a.max(b).max(neutral));
    ends.map(|end| end.clamp(low, high))
}

#[cfg(test)]
mod tests {
    use super::*;
    use mindgap_models::effects::CATALOGUE;

    #[test]
    fn shipped_shares_are_those_of_reported_numbers() {
        let FormErrors { usual, measured } = FormErrors::shipped();
        assert!((0.0..=1.0).contains(usual));
        for (effect, shares) in measured {
            let known = CATALOGUE.iter().find(|known| known.id == effect).unwrap_or_else(|| panic!("{effect}"));
            let names: Vec<&str> =
                known.variants.iter().flat_map(|v| v.parameters).map(|parameter| parameter.setting().0).collect();
            for (name, share) in shares {
                assert!(names.contains(&name.as_str()) && *share >= 0.0, "{effect}.{name}: {share}");
            }
        }
    }
}
