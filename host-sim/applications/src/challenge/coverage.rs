//! How often the 95 % intervals of an answer hold the true values, and what the forms of effects add to chance.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Serialize;

use super::share::Share;
use mindgap_diagnosis::interval::FormErrors;

/// A reported number of an effect that is there.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// Id of the effect.
    pub effect: String,
    /// Name of the parameter.
    pub parameter: &'static str,
    /// Reported minus true value.
    pub error: f64,
    /// Half of the width of the interval.
    pub half_width: f64,
    /// Whether the interval holds the true value.
    pub is_inside: bool,
    /// How far the reported number lies from neutral.
    pub departure: f64,
}

/// How often intervals hold the true values.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Coverage {
    /// Coverage over all parameters of effects that are present.
    pub all: Share,
    /// Coverage by effect and parameter.
    pub by_parameter: Vec<(String, Share)>,
    /// Median half-width of an interval, as a share of the parameter's departure from neutral; null if there are none.
    pub median_half_width: Option<f64>,
}

impl Coverage {
    /// Counts intervals.
    pub fn of(measured: &[Measured]) -> Self {
        let share = |of: &[&Measured]| Share { count: of.iter().filter(|m| m.is_inside).count(), of: of.len() };
        let mut widths: Vec<f64> = measured.iter().map(|m| m.half_width / m.departure).collect();
        widths.sort_by(f64::total_cmp);
        Coverage {
            all: share(&measured.iter().collect::<Vec<_>>()),
            by_parameter: by_parameter(measured)
                .into_iter()
                .map(|((effect, parameter), of)| (format!("{effect}.{parameter}"), share(&of)))
                .collect(),
            median_half_width: widths.get(widths.len() / 2).copied(),
        }
    }
}

/// Fewer numbers than this measure no form error.
const LEAST_NUMBERS: usize = 3;
/// Share of intervals that are to hold the true value.
const COVERED: f64 = 0.95;

/// Returns the form errors with which intervals would have held 95 % of these values. What chance contributes is what the widths
/// contain beyond the form errors that are `used` now. Of few numbers the largest error is exceeded by the next one in one case of
/// n + 1, so that the share is raised by one n-th.
pub fn form_errors(measured: &[Measured], used: &FormErrors) -> FormErrors {
    let share = |effect: &str, of: &Measured| {
        let form = used.share(effect, of.parameter) * of.departure;
        let by_chance_squared = (of.half_width * of.half_width - form * form).max(0.0);
        (of.error * of.error - by_chance_squared).max(0.0).sqrt() / of.departure
    };
    let mut shares: BTreeMap<String, BTreeMap<String, f64>> = BTreeMap::new();
    for ((effect, parameter), of) in by_parameter(measured) {
        if of.len() < LEAST_NUMBERS {
            continue;
        }
        let mut each: Vec<f64> = of.iter().map(|m| share(effect, m)).collect();
        each.sort_by(f64::total_cmp);
        let n = each.len() as f64;
        let rank = ((COVERED * (n + 1.0)).ceil() as usize).clamp(1, each.len());
        let raised = each[rank - 1] * (1.0 + 1.0 / n);
        shares.entry(effect.into()).or_default().insert(parameter.into(), (raised * 1e3).ceil() / 1e3);
    }
    let mut all: Vec<f64> = shares.values().flat_map(BTreeMap::values).copied().collect();
    all.sort_by(f64::total_cmp);
    // Three of four measured numbers have a smaller error.
    let usual = all.get(3 * all.len() / 4).copied().unwrap_or(used.usual);
    FormErrors { usual, measured: shares }
}

fn by_parameter(measured: &[Measured]) -> BTreeMap<(&str, &'static str), Vec<&Measured>> {
    let mut groups: BTreeMap<(&str, &'static str), Vec<&Measured>> = BTreeMap::new();
    for one in measured {
        groups.entry((&one.effect, one.parameter)).or_default().push(one);
    }
    groups
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Reported numbers that depart by 100 with an interval of 3 to each side.
    fn off_by(errors: &[f64]) -> Vec<Measured> {
        let measured = |error: &f64| Measured {
            effect: "slope".into(),
            parameter: "loss",
            error: *error,
            half_width: 3.0,
            is_inside: error.abs() <= 3.0,
            departure: 100.0,
        };
        errors.iter().map(measured).collect()
    }

    const NONE: FormErrors = FormErrors { usual: 0.0, measured: BTreeMap::new() };

    #[test]
    fn intervals_are_counted_by_parameter() {
        let Coverage { all, by_parameter, median_half_width } = Coverage::of(&off_by(&[1.0, -2.0, 5.0, 2.5]));
        assert_eq!((all.count, all.of, median_half_width), (3, 4, Some(0.03)));
        assert_eq!(by_parameter[0].0, "slope.loss");
    }

    /// An error of 5 leaves √(5² − 3²) = 4 per hundred for the form, raised by one third for three numbers.
    #[test]
    fn form_error_is_what_chance_does_not_contain() {
        let found = form_errors(&off_by(&[1.0, -2.0, 5.0]), &NONE);
        assert_eq!(found.share("slope", "loss"), 0.054);
        assert_eq!(form_errors(&off_by(&[1.0, -2.0, 2.5]), &NONE).share("slope", "loss"), 0.0);
        assert!(form_errors(&off_by(&[5.0]), &NONE).measured.is_empty(), "one number measures nothing");
    }

    /// With the form errors that were found the same answers give the same form errors again.
    #[test]
    fn form_errors_in_use_are_not_counted_twice() {
        let found = form_errors(&off_by(&[1.0, -2.0, 5.0]), &NONE);
        let mut wider = off_by(&[1.0, -2.0, 5.0]);
        wider.iter_mut().for_each(|m| m.half_width = libm::hypot(3.0, 5.4));
        assert_eq!(form_errors(&wider, &found), found);
    }
}
