//! Which effects these logs could show at all: an effect that they hardly excite is untestable, not absent.

use rayon::prelude::*;

use super::search::{Fitted, Given};
use crate::effects;

/// An effect from which fewer nats are to be expected at a plain strength cannot be tested.
const LEAST_NATS: f64 = 3.0;

/// The effects that cannot be tested, in the order of the bank.
pub fn untestable(none: &Fitted, logs: &Given) -> Vec<&'static str> {
    let forms = effects::all();
    let expected: Vec<f64> = forms
        .par_iter()
        .map(|form| {
            let hypothesis = none.hypothesis.with(form);
            let here = none.terms.total();
            let strongest = |start: &&[f64]| {
                let there = hypothesis.terms(logs.baseline, logs.evidence, start, Some(&none.terms)).total();
                // To second order half of the squared change of the log-likelihood is what a row is expected to tell.
                0.5 * there.iter().zip(&here).map(|(a, b)| (a - b) * (a - b)).sum::<f64>()
            };
            form.starts.iter().map(strongest).fold(0.0, f64::max)
        })
        .collect();
    let mut ids: Vec<&'static str> = forms.iter().map(|form| form.id).collect();
    ids.dedup();
    let reach = |id: &str| forms.iter().zip(&expected).filter(|(f, _)| f.id == id).map(|(_, e)| *e).fold(0.0, f64::max);
    ids.retain(|id| reach(id) < LEAST_NATS);
    ids
}
