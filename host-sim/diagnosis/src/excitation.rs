//! Excitation: which effects these logs could show at all. An effect that they hardly excite is untestable, not absent.

use rayon::prelude::*;

use super::fit::{FitContext, Fitted};
use mindgap_models::effects::Candidate;

/// Returns the ids of the effects whose typical strengths promise no strong evidence, in the order of the catalogue.
pub fn untestable(null: &Fitted, context: &FitContext) -> Vec<&'static str> {
    let candidates = Candidate::all(&context.catalogue);
    let expected = |candidate: &Candidate| {
        let hypothesis = null.hypothesis.with(*candidate);
        let nats = |start: &Vec<f64>| {
            let changes = &hypothesis.scores_over(&null.scores, context.rows, start) - &null.scores;
            let rows = changes.rows().iter().zip(&context.rows.rows);
            rows.map(|(change, row)| expected_nats(change, &row.weights())).sum()
        };
        context.initial_guesses(candidate).iter().map(nats).fold(0.0, f64::max)
    };
    let expected: Vec<f64> = candidates.par_iter().map(expected).collect();
    let best = |id: &str| {
        candidates.iter().zip(&expected).filter(|(c, _)| c.effect == id).map(|(_, e)| *e).fold(0.0, f64::max)
    };
    let ids = context.catalogue.iter().map(|effect| effect.id);
    ids.filter(|id| best(id) < context.calibration.judgement.strong_nats).collect()
}

/// Returns the expected evidence of a row: to second order, half of the squared change of its log-likelihood by channel, over its
/// weight since that is contained in both factors.
fn expected_nats(change: &[f64], weights: &[f64]) -> f64 {
    let channels = change.iter().zip(weights).filter(|(_, weight)| **weight > 0.0);
    channels.map(|(change, weight)| 0.5 * change * change / weight).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise_model::log_density;
    use crate::test_support::*;
    use mindgap_learning::evaluation::observations::Observations;

    fn untestable_on(rows: Observations) -> Vec<&'static str> {
        let baseline = baseline_with_sonar();
        let rows = identification(&baseline, rows);
        let context = FitContext::new(&rows, METHOD);
        untestable(&Fitted::null(&context), &context)
    }

    /// Residuals are two standard deviations, and the first guess of the effect is 0.1 cm.
    #[test]
    fn effect_is_testable_once_its_rows_promise_strong_evidence() {
        let change = log_density(0, 1.9, 2.0) - log_density(0, 2.0, 2.0);
        let enough = (3.0 / (0.5 * change * change)).ceil() as usize;
        let straight = |rows| {
            observations(1, rows, |_, at| Made {
                off: [2.0 * alternating(at), 0.0, 0.0],
                echo_off_cm: None,
                ..Made::default()
            })
        };
        // Without left turns and readings these are never testable.
        let never = ["longer_to_the_left", "farther"];
        assert_eq!(untestable_on(straight(2 * enough)), never);
        assert_eq!(untestable_on(straight(enough / 2)), ["longer", never[0], never[1]]);
    }

    /// Four rows with a weight of one quarter promise what one row does.
    #[test]
    fn repeated_rows_promise_evidence_by_their_weight() {
        let rows = |count: usize, weight: f64| {
            let mut rows =
                observations(1, count, |_, at| Made { off: [2.0 * alternating(at), 0.0, 0.0], ..Made::default() });
            rows.rows.iter_mut().for_each(|row| row.motion_weight = [weight; 3]);
            rows
        };
        let counts = [8, 64, 512, 4096].map(|count| untestable_on(rows(count, 1.0)).contains(&"longer"));
        assert_eq!([32, 256, 2048, 16384].map(|count| untestable_on(rows(count, 0.25)).contains(&"longer")), counts);
        assert_eq!((counts[0], counts[3]), (true, false));
    }

    #[test]
    fn readings_make_effects_of_the_sensor_testable() {
        let rows = observations(1, 2000, |_, at| Made { echo_off_cm: Some(alternating(at)), ..Made::default() });
        assert!(!untestable_on(rows).contains(&"farther"));
    }
}
