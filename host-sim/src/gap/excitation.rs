//! Which effects these logs could show at all: an effect that they hardly excite is untestable, not absent.

use rayon::prelude::*;

use super::fit::{FitContext, Fitted};
use crate::effects::Candidate;

/// The effects of which a plain strength promises no strong evidence, in the order of the catalogue.
pub fn untestable(none: &Fitted, context: &FitContext) -> Vec<&'static str> {
    let candidates = Candidate::all(context.catalogue);
    let here = none.log_likelihood.total();
    let expected = |candidate: &Candidate| {
        let hypothesis = none.hypothesis.with(*candidate);
        let nats = |start: &Vec<f64>| {
            let there =
                hypothesis.log_likelihood(context.baseline, context.observations, start, Some(&none.log_likelihood));
            // To second order half of the squared change of the log-likelihood is what a row is expected to tell.
            0.5 * there.total().iter().zip(&here).map(|(a, b)| (a - b) * (a - b)).sum::<f64>()
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
