//! Fits each threshold to the measurements by a criterion of its own.

use super::Measured;
use crate::gap::calibration::{Calibration, Gate};
use crate::gap::verdict::probability;

/// Share of cases without effects whose gain passes the gate for an effect in nats, and share that passes it in standard
/// errors. A case has to pass both, and gain on the held-out runs as well: at most two in a hundred pass all three.
const FALSE_EFFECTS: f64 = 0.05;
/// The same for the remainder that no effect explains, where a simulator's own misfit often recurs on held-out runs.
const FALSE_LEFTOVERS: f64 = 0.02;
/// Share of the values that an exponential tail is fitted to.
const TAIL: f64 = 0.2;
/// Share of right answers that leave more unexplained than counts as adequate.
const FALSE_UNKNOWNS: f64 = 0.05;
/// Factor on the unexplained share, since no effect fits other robots as well as the built-in one.
const OTHER_ROBOTS: f64 = 3.0;
/// Share of the doubtful answers whose set of effects has to contain the true one.
const COVERED: f64 = 0.9;
/// Relative likelihood below which a rival raises no doubt.
const DOUBT: f64 = 0.01;
/// Relative likelihood above which a rival is always named, about two standard errors behind the first.
const TWO_ERRORS: f64 = 0.12;
/// Grid of values tried for the parameters of the probabilities.
const WIDTHS: [f64; 5] = [0.01, 0.02, 0.04, 0.06, 0.1];
const TEMPERATURES: [f64; 6] = [1.0, 1.5, 2.0, 3.0, 4.0, 6.0];
const TRUSTS: [f64; 6] = [0.85, 0.9, 0.93, 0.95, 0.97, 0.99];

/// Calibration with fitted gates only: every explanation counts as adequate, and every rival is named.
pub fn open(nulls: &[Measured]) -> Calibration {
    let rows = nulls.iter().map(|m| m.rows as f64).sum::<f64>() / nulls.len() as f64;
    let ungated = Calibration {
        rows: rows.round(),
        adequate: 0.0,
        adequacy_width: 1.0,
        rival: 0.0,
        temperature: 1.0,
        trust: 1.0,
        effect: Gate { nats: 0.0, z: 0.0 },
        leftover: Gate { nats: 0.0, z: 0.0 },
    };
    let gate = |share: f64, gain: fn(&Measured) -> [f64; 2]| {
        let nats = nulls.iter().map(|m| gain(m)[0] / ungated.growth(m.rows)).collect();
        let z = nulls.iter().map(|m| gain(m)[1]).collect();
        Gate { nats: rounded(tail(nats, share)), z: rounded(tail(z, share)) }
    };
    Calibration {
        effect: gate(FALSE_EFFECTS, |m| [m.effect_nats, m.effect_z]),
        leftover: gate(FALSE_LEFTOVERS, |m| [m.learner_nats, m.learner_z]),
        ..ungated
    }
}

/// Completes a calibration by the thresholds on adequacy and rivals and the parameters of the probabilities.
pub fn weighed(open: Calibration, others: &[Measured]) -> Calibration {
    let answered: Vec<&Measured> = others.iter().filter(|m| !m.first.is_empty()).collect();
    let right = answered.iter().filter(|m| m.first_is_there());
    let adequate = 1.0 - OTHER_ROBOTS * (1.0 - quantile(right.map(|m| m.adequacy).collect(), FALSE_UNKNOWNS));
    let doubtful = answered.iter().filter(|m| m.weight_of_truth >= DOUBT && m.rivals.iter().any(|w| *w >= DOUBT));
    let rival = quantile(doubtful.map(|m| m.weight_of_truth).collect(), 1.0 - COVERED).min(TWO_ERRORS);
    let settled = Calibration { adequate: rounded(adequate), rival: rounded(rival), ..open };
    let known: Vec<&Measured> = answered.into_iter().filter(|m| m.adequacy >= settled.adequate).collect();
    let tried = WIDTHS.iter().flat_map(|width| {
        TEMPERATURES.iter().flat_map(move |temperature| TRUSTS.iter().map(move |trust| [*width, *temperature, *trust]))
    });
    let tried = tried.map(|[adequacy_width, temperature, trust]| {
        let calibration = Calibration { adequacy_width, temperature, trust, ..settled };
        (known.iter().map(|m| m.log_likelihood(&calibration)).sum::<f64>(), calibration)
    });
    tried.max_by(|a, b| a.0.total_cmp(&b.0)).map_or(settled, |(_, calibration)| calibration)
}

impl Measured {
    fn first_is_there(&self) -> bool {
        self.weight_of_truth == 1.0
    }

    /// Log-likelihood of whether the first effect is true, under the probability that the diagnosis gives it.
    fn log_likelihood(&self, calibration: &Calibration) -> f64 {
        let there = probability(self.adequacy, self.rivals.iter().copied(), calibration);
        libm::log(if self.first_is_there() { there } else { 1.0 - there })
    }
}

/// The value that a share of all exceeds, by an exponential fit to the tail.
fn tail(mut values: Vec<f64>, share: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    let above = &values[((1.0 - TAIL) * values.len() as f64) as usize..];
    let mean_excess = above.iter().map(|v| v - above[0]).sum::<f64>() / above.len() as f64;
    above[0] + mean_excess * libm::log(TAIL / share)
}

/// The quantile `at` of values; one if there is none.
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
            effect_z: 10.0,
            learner_nats: 0.0,
            learner_z: 0.0,
            first: "slope".into(),
            adequacy,
            weight_of_truth: truth_weight,
            rivals: vec![rival],
        }
    }

    fn nulls() -> Vec<Measured> {
        let exponential = |i: usize| -libm::log(1.0 - (i as f64 + 0.5) / 1000.0);
        (0..1000)
            .map(|i| Measured {
                effect_nats: 4.0 * exponential(i),
                effect_z: exponential(i),
                ..measured(0.0, 0.0, 0.0)
            })
            .collect()
    }

    #[test]
    fn gates_let_through_the_share_of_false_alarms() {
        let gate = open(&nulls()).effect;
        let exact = libm::log(1.0 / FALSE_EFFECTS);
        assert!((gate.z - exact).abs() < 0.1 && (gate.nats - 4.0 * exact).abs() < 0.4, "{gate:?}");
    }

    #[test]
    fn what_is_often_wrong_is_trusted_less() {
        let answers = |wrong: usize| -> Vec<Measured> {
            (0..100).map(|i| measured(if i < wrong { 0.0 } else { 1.0 }, 0.9, 0.0)).collect()
        };
        let trust = |wrong: usize| weighed(open(&nulls()), &answers(wrong)).trust;
        assert_eq!([trust(0), trust(5), trust(15)], [0.99, 0.95, 0.85]);
    }

    #[test]
    fn a_rival_is_named_as_far_behind_as_truths_are_found() {
        let answers = |behind: f64| -> Vec<Measured> {
            (0..100).map(|i| measured(if i < 20 { behind } else { 1.0 }, 1.0, 0.5)).collect()
        };
        let rival = |behind: f64| weighed(open(&nulls()), &answers(behind)).rival;
        assert_eq!([rival(0.05), rival(0.6)], [0.05, TWO_ERRORS]);
    }
}
