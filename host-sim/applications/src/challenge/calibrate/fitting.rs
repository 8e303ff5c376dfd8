//! Fits each threshold to the measurements by its own criterion.

use std::collections::BTreeMap;

use super::Measured;
use mindgap_diagnosis::calibration::{CALIBRATED_STEPS, Calibration, Judgement};
use mindgap_diagnosis::further_shares::FurtherShares;
use mindgap_diagnosis::verdict::{Explained, probability};

/// Share of the cases without effects that pass the gate for an effect. A gain on held-out runs is required as well: fewer
/// than one in a hundred passes both.
const FALSE_EFFECTS: f64 = 0.02;
/// The same for the unexplained residual, where the simulator's own misfit often recurs on held-out runs.
const FALSE_REMAINDERS: f64 = 0.02;
/// Share of the cases with one effect to which a false second effect is added.
const FALSE_FURTHER: f64 = 0.05;
/// Fewer cases than this measure no model-form error of an effect.
const FEWEST_OF_EFFECT: usize = 3;
/// More than this is not what a form lacks: a second effect imitates the first, as carpet nap does slope. Between the two lie
/// no cases of 240, from 0.13 to 0.54.
const LARGEST_FORM_ERROR: f64 = 0.3;
/// Provisional threshold for further effects, until the model-form error of the first ones is known.
const FIRST_SHARE: f64 = 0.05;
/// Share of the sample from which the tail distribution is estimated.
const TAIL: f64 = 0.2;
/// Share of the right answers whose unexplained remainder exceeds the limit of adequacy.
const FALSE_UNKNOWNS: f64 = 0.05;
/// Factor applied to these remainders: no variant fits other robots as well as the built-in one, and the worst right
/// answer on another robot's logs leaves 1.7 times as much.
const OTHER_ROBOTS: f64 = 2.0;
/// Grids for the parameters of the probabilities. A test checks that the best value is not at the edge, except for the
/// width, whose narrowest value is already a step, and for the cap, since some two hundred right answers cannot show that
/// more than 199 in 200 are right.
const WIDTHS: [f64; 7] = [0.005, 0.01, 0.02, 0.04, 0.06, 0.1, 0.2];
const TEMPERATURES: [f64; 9] = [0.25, 0.5, 0.7, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0];
const ACCURACY_CAPS: [f64; 8] = [0.8, 0.85, 0.9, 0.93, 0.95, 0.97, 0.99, 0.995];

/// Returns the thresholds against false alarms; everything that explains a gap counts as its cause, and every rival is
/// named.
pub fn open(nulls: &[Measured]) -> Calibration {
    let rows = nulls.iter().map(|m| m.rows as f64).sum::<f64>() / nulls.len() as f64;
    let ungated = Calibration {
        rows: rows.round(),
        adequate: 0.0,
        adequacy_width: 1.0,
        temperature: 1.0,
        accuracy_cap: 1.0,
        effect_nats: 0.0,
        remainder_nats: 0.0,
        further_share: FIRST_SHARE,
        judgement: Judgement::USUAL,
    };
    let gate = |share: f64, gain: fn(&Measured) -> f64| {
        rounded(tail(nulls.iter().map(|m| gain(m) / ungated.growth(m.rows, Some(CALIBRATED_STEPS))).collect(), share))
    };
    Calibration {
        effect_nats: gate(FALSE_EFFECTS, |m| m.effect_nats),
        remainder_nats: gate(FALSE_REMAINDERS, |m| m.remainder_nats),
        ..ungated
    }
}

/// Adds the thresholds that separate known from unknown causes, and the calibration of the probabilities.
pub fn weighed(open: Calibration, others: &[Measured]) -> Calibration {
    let answered: Vec<&Measured> = others.iter().filter(|m| !m.first.is_empty()).collect();
    let right = answered.iter().filter(|m| m.first_is_there());
    let adequate = 1.0 - OTHER_ROBOTS * (1.0 - quantile(right.map(|m| m.explained_fraction).collect(), FALSE_UNKNOWNS));
    let form_errors: Vec<f64> = form_errors(others).map(|(_, fraction)| fraction).collect();
    let further_share =
        if form_errors.is_empty() { open.further_share } else { quantile(form_errors, 1.0 - FALSE_FURTHER) };
    let settled = Calibration { adequate: rounded(adequate), further_share: rounded(further_share), ..open };
    let known: Vec<&Measured> = answered.into_iter().filter(|m| m.explained_fraction >= settled.adequate).collect();
    let tried = WIDTHS.iter().flat_map(|width| {
        TEMPERATURES
            .iter()
            .flat_map(move |temperature| ACCURACY_CAPS.iter().map(move |cap| [*width, *temperature, *cap]))
    });
    let tried = tried.map(|[adequacy_width, temperature, accuracy_cap]| {
        let calibration = Calibration { adequacy_width, temperature, accuracy_cap, ..settled };
        (known.iter().map(|m| m.log_likelihood(&calibration)).sum::<f64>(), calibration)
    });
    tried.max_by(|a, b| a.0.total_cmp(&b.0)).map_or(settled, |(_, calibration)| calibration)
}

/// Returns the model-form error of each effect for which it is larger than the usual fraction. It is the largest of few, which
/// the next one exceeds in one case of n + 1, so that it is raised by one n-th.
pub fn further_shares(others: &[Measured], usual: f64) -> FurtherShares {
    let mut by_effect: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
    form_errors(others).for_each(|(effect, fraction)| by_effect.entry(effect).or_default().push(fraction));
    let raised = |(effect, fractions): (&str, Vec<f64>)| {
        let n = fractions.len();
        let raised = quantile(fractions, 1.0 - FALSE_FURTHER) * (1.0 + 1.0 / n as f64);
        (n >= FEWEST_OF_EFFECT && raised > usual).then(|| (effect.to_owned(), rounded(raised)))
    };
    FurtherShares::new(by_effect.into_iter().filter_map(raised).collect())
}

/// Returns the effect and the model-form error of each case in which it was measured.
fn form_errors(others: &[Measured]) -> impl Iterator<Item = (&str, f64)> {
    let measured = others.iter().filter_map(|m| Some((m.truth.as_str(), m.form_error_fraction?)));
    measured.filter(|(_, fraction)| *fraction <= LARGEST_FORM_ERROR)
}

impl Measured {
    fn first_is_there(&self) -> bool {
        self.likelihood_of_truth == 1.0
    }

    /// Returns the log-likelihood of the truth about the first effect under its reported probability.
    fn log_likelihood(&self, calibration: &Calibration) -> f64 {
        let explained = Explained { fraction: self.explained_fraction, error: self.explained_error };
        let there = probability(explained, self.rivals.iter().copied(), calibration);
        libm::log(if self.first_is_there() { there } else { 1.0 - there })
    }
}

/// Returns the value exceeded by a share of the sample, assuming an exponential tail.
fn tail(mut values: Vec<f64>, share: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    let above = &values[((1.0 - TAIL) * values.len() as f64) as usize..];
    let mean_excess = above.iter().map(|v| v - above[0]).sum::<f64>() / above.len() as f64;
    above[0] + mean_excess * libm::log(TAIL / share)
}

/// Returns the quantile `at`, or one if there are no values.
fn quantile(mut values: Vec<f64>, at: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get((at * values.len() as f64) as usize).copied().unwrap_or(1.0)
}

fn rounded(value: f64) -> f64 {
    (value * 1e3).round() / 1e3
}

#[cfg(test)]
mod tests {
    use super::*;

    fn measured(truth_weight: f64, adequacy: f64, rival: f64) -> Measured {
        Measured {
            truth: "slope".into(),
            in_table: true,
            rows: 100,
            effect_nats: 100.0,
            remainder_nats: 0.0,
            form_error_fraction: Some(0.0),
            first: "slope".into(),
            explained_fraction: adequacy,
            explained_error: 0.0,
            likelihood_of_truth: truth_weight,
            rivals: vec![rival],
        }
    }

    fn nulls() -> Vec<Measured> {
        let exponential = |i: usize| -libm::log(1.0 - (i as f64 + 0.5) / 1000.0);
        (0..1000).map(|i| Measured { effect_nats: 4.0 * exponential(i), ..measured(0.0, 0.0, 0.0) }).collect()
    }

    #[test]
    fn gates_pass_the_specified_share_of_false_alarms() {
        let nats = open(&nulls()).effect_nats;
        assert!((nats - 4.0 * libm::log(1.0 / FALSE_EFFECTS)).abs() < 0.4, "{nats}");
    }

    #[test]
    fn effects_of_poor_form_have_their_own_share() {
        let of = |truth: &str, fraction: f64| Measured {
            truth: truth.into(),
            form_error_fraction: Some(fraction),
            ..measured(1.0, 0.9, 0.0)
        };
        let cases = [("slip", [0.1, 0.15, 0.05]), ("slope", [0.01, 0.01, 1.0]), ("latency", [0.2, 1.0, 1.0])];
        let cases: Vec<Measured> =
            cases.iter().flat_map(|(truth, fractions)| fractions.map(|fraction| of(truth, fraction))).collect();
        let found = further_shares(&cases, 0.02);
        assert_eq!(found, FurtherShares::new([("slip".to_owned(), 0.2)].into()), "slope is as usual, latency too rare");
    }

    #[test]
    fn frequent_errors_lower_the_probability() {
        let answers = |wrong: usize| -> Vec<Measured> {
            (0..100).map(|i| measured(if i < wrong { 0.0 } else { 1.0 }, 0.9, 0.0)).collect()
        };
        let cap = |wrong: usize| weighed(open(&nulls()), &answers(wrong)).accuracy_cap;
        assert_eq!([cap(0), cap(5), cap(15)], [0.995, 0.95, 0.85]);
    }

    /// A value at the edge of its grid is not calibrated, since a better one may lie beyond.
    #[test]
    fn shipped_values_lie_within_their_grids() {
        let Calibration { adequacy_width, temperature, accuracy_cap, .. } = Calibration::shipped();
        let within = |value: f64, grid: &[f64]| grid[0] < value && value < grid[grid.len() - 1];
        assert!(within(temperature, &TEMPERATURES));
        assert!(adequacy_width < WIDTHS[WIDTHS.len() - 1] && accuracy_cap > ACCURACY_CAPS[0]);
    }
}
