//! Confirmation: what holds on runs that nothing was sought on.

use super::compare::Comparison;
use super::fit::{FitContext, Fitted};
use super::remainder::{Remainder, remainders};
use crate::evaluation::observations::Observations;

/// Effects that gain nothing on the runs held out explain nothing, and neither does the residual model.
pub fn confirm(mut found: Comparison, context: &FitContext, hold_out: Option<&Observations>) -> Comparison {
    let Some(hold_out) = hold_out else { return found };
    let judged = |fit: &Fitted| fit.judged_on(hold_out, context).total().iter().sum::<f64>();
    let gained = judged(&found.chosen) - judged(&found.none);
    if !found.chosen.ids().is_empty() && gained < context.calibration.judgement.strong_nats {
        found.chosen = found.none.clone();
        found.rivals = Vec::new();
        found.beyond_chosen = remainders(&found.none, context);
    }
    let hold = |remainders: Vec<Remainder>, beneath: &Fitted| {
        remainders.into_iter().map(|r| r.confirmed(beneath, context, hold_out)).collect()
    };
    found.beyond_none = hold(found.beyond_none, &found.none);
    found.beyond_chosen = hold(found.beyond_chosen, &found.chosen);
    found
}
