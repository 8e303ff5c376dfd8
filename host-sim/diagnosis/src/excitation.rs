//! Which effects these logs could show at all: an effect that they hardly excite is untestable, not absent.

use rayon::prelude::*;

use super::fit::{FitContext, Fitted};
use mindgap_models::effects::Candidate;

/// The effects of which a plain strength promises no strong evidence, in the order of the catalogue.
pub fn untestable(none: &Fitted, context: &FitContext) -> Vec<&'static str> {
    let candidates = Candidate::all(context.catalogue);
    let here = &none.log_likelihood;
    let expected = |candidate: &Candidate| {
        let hypothesis = none.hypothesis.with(*candidate);
        let nats = |start: &Vec<f64>| {
            let there = hypothesis.log_likelihood(context.baseline, context.observations, start, Some(here));
            let rows = context.observations.rows.iter().enumerate();
            rows.map(|(i, row)| {
                told(&there.motion[i], &here.motion[i], &row.motion_weight)
                    + told(&there.sonar[i], &here.sonar[i], &row.echo_weight)
            })
            .sum()
        };
        context.initial_guesses(candidate).iter().map(nats).fold(0.0, f64::max)
    };
    let expected: Vec<f64> = candidates.par_iter().map(expected).collect();
    let reach = |id: &str| {
        candidates.iter().zip(&expected).filter(|(c, _)| c.effect == id).map(|(_, e)| *e).fold(0.0, f64::max)
    };
    let ids = context.catalogue.iter().map(|effect| effect.id);
    ids.filter(|id| reach(id) < context.calibration.judgement.strong_nats).collect()
}

/// To second order half of the squared change of its log-likelihood is what a row is expected to tell in a channel, as often
/// as it counts.
fn told(there: &[f64], here: &[f64], counts: &[f64]) -> f64 {
    let channels = there.iter().zip(here).zip(counts).filter(|(_, counts)| **counts > 0.0);
    channels.map(|((a, b), counts)| 0.5 * (a - b) * (a - b) / counts).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::residual_law::log_density;
    use crate::test_support::*;
    use mindgap_learning::evaluation::observations::Observations;

    fn untestable_on(rows: &Observations) -> Vec<&'static str> {
        let baseline = baseline_with_sonar();
        let context = FitContext::new(&baseline, rows, METHOD);
        untestable(&Fitted::none(&context), &context)
    }

    /// Steps that are two standard deviations off: a guess of 0.1 cm changes each by what the density says.
    #[test]
    fn an_effect_is_testable_once_its_rows_promise_strong_evidence() {
        let change = log_density(0, 1.9, 2.0) - log_density(0, 2.0, 2.0);
        let enough = (3.0 / (0.5 * change * change)).ceil() as usize;
        let straight = |rows| {
            observations(1, rows, |_, at| Made {
                off: [2.0 * alternating(at), 0.0, 0.0],
                echo_off_cm: None,
                ..Made::default()
            })
        };
        // Nothing turns left, and no reading is there to be longer.
        let never = ["longer_to_the_left", "farther"];
        assert_eq!(untestable_on(&straight(2 * enough)), never);
        assert_eq!(untestable_on(&straight(enough / 2)), ["longer", never[0], never[1]]);
    }

    /// Four rows that count a quarter each tell what one does.
    #[test]
    fn rows_that_others_repeat_promise_as_much_as_they_count() {
        let rows = |count: usize, weight: f64| {
            let mut rows =
                observations(1, count, |_, at| Made { off: [2.0 * alternating(at), 0.0, 0.0], ..Made::default() });
            rows.rows.iter_mut().for_each(|row| row.motion_weight = [weight; 3]);
            rows
        };
        let counts = [8, 64, 512, 4096].map(|count| untestable_on(&rows(count, 1.0)).contains(&"longer"));
        assert_eq!([32, 256, 2048, 16384].map(|count| untestable_on(&rows(count, 0.25)).contains(&"longer")), counts);
        assert_eq!((counts[0], counts[3]), (true, false));
    }

    #[test]
    fn readings_show_what_changes_them() {
        let rows = observations(1, 2000, |_, at| Made { echo_off_cm: Some(alternating(at)), ..Made::default() });
        assert!(!untestable_on(&rows).contains(&"farther"));
    }
}
