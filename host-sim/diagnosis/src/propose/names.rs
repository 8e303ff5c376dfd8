//! The names that logs leave: the hypotheses between which further runs have to decide.

use crate::confirm::Confirmed;
use crate::explanation::Explanation;
use crate::fit::{FitContext, Fitted, TOLERANCE_NATS, best_of_each};
use crate::slot::relative_likelihood;

/// A hypothesis that logs leave.
pub struct Name {
    /// The effect in which it differs from the others; `None` for the simulator as it is.
    pub id: Option<&'static str>,
    /// Its fit.
    pub fit: Fitted,
    /// Its likelihood relative to that of the best.
    pub likelihood: f64,
}

/// A less likely name is ruled out: it leaves no more doubt than the accuracy of the clearest answers does, 3 %.
const LEAST_LIKELIHOOD: f64 = 0.03;
/// Maximum number of names. An effect with more rivals in reach is ambiguous with too many to be named, and the first of them are
/// discriminated first.
const MOST_NAMES: usize = 5;

/// Returns the names, most likely first: the chosen effects, and the same with a rival in the place of one. Where no effect is
/// confirmed, they are the single effects and the simulator as it is.
pub fn left(found: &Confirmed, context: &FitContext) -> Vec<Name> {
    let mut names = if found.chosen.ids().is_empty() { single(found) } else { chosen(found) };
    let best = names.iter().map(|name| &name.fit).max_by(|a, b| a.log_evidence().total_cmp(&b.log_evidence()));
    let Some(best) = best.cloned() else { return names };
    names.iter_mut().for_each(|name| name.likelihood = relative_likelihood(&best, &name.fit, &context.calibration));
    names.retain(|name| name.likelihood >= LEAST_LIKELIHOOD);
    // Stable: of equal likelihoods the first stays first.
    names.sort_by(|a, b| b.likelihood.total_cmp(&a.likelihood));
    names.truncate(MOST_NAMES);
    names
}

fn chosen(found: &Confirmed) -> Vec<Name> {
    let ids = found.chosen.ids();
    let mut names = vec![name(ids.first().copied(), &found.chosen)];
    for effect in 0..ids.len() {
        for rival in found.rivals_of(effect) {
            let id = rival.ids().into_iter().find(|id| !ids.contains(id));
            if names.iter().all(|known| known.id != id) {
                names.push(name(id, rival));
            }
        }
    }
    names
}

fn single(found: &Confirmed) -> Vec<Name> {
    let null = &found.fits.null;
    let singles = best_of_each(found.fits.singles.clone());
    let gaining = singles.iter().filter(|single| single.gain_over(null).nats > TOLERANCE_NATS);
    let names: Vec<Name> = gaining.map(|single| name(single.ids().first().copied(), single)).collect();
    if names.is_empty() { names } else { names.into_iter().chain([name(None, null)]).collect() }
}

fn name(id: Option<&'static str>, fit: &Fitted) -> Name {
    Name { id, fit: fit.clone(), likelihood: 1.0 }
}
