//! Confirmation: what holds on runs that nothing was sought on.

use super::compare::Comparison;
use super::fit::{FitContext, Fitted};
use super::remainder::{Remainder, remainders};
use super::scatter;
use crate::evaluation::observations::Observations;

/// Effects that gain nothing on the runs held out explain nothing, and neither does the residual model.
pub fn confirm(mut found: Comparison, context: &FitContext, hold_out: Option<&Observations>) -> Comparison {
    if let Some(hold_out) = hold_out {
        let judged = |fit: &Fitted| fit.judged_on(hold_out, context).total().iter().sum::<f64>();
        let gained = judged(&found.chosen) - judged(&found.none);
        let ids = found.chosen.ids();
        if !ids.is_empty() {
            log::info!("{} gain {gained:.1} nats on runs kept back", ids.join("+"));
        }
        if !ids.is_empty() && gained < context.calibration.judgement.strong_nats {
            found.chosen = found.none.clone();
            (found.rivals, found.own) = (Vec::new(), Vec::new());
            found.beyond_chosen = remainders(&found.none, context);
        }
        let hold = |remainders: Vec<Remainder>, beneath: &Fitted| {
            remainders.into_iter().map(|r| r.confirmed(beneath, context, hold_out)).collect()
        };
        found.beyond_none = hold(found.beyond_none, &found.none);
        found.beyond_chosen = hold(found.beyond_chosen, &found.chosen);
    }
    found.scatter = scatter::wider(&found.beyond_chosen, context, hold_out);
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gap::test_support::*;

    /// Blocks of rows that go so much too far.
    fn longer_by(off_cm: f64, blocks: usize) -> Observations {
        let off = move |at| [off_cm + 0.9 * alternating(at), 0.0, 0.0];
        observations(blocks, 10, move |_, at| Made { off: off(at), ..Made::default() })
    }

    /// What is left of an effect of one centimetre when the runs held out go so much too far.
    fn confirmed(held_out_cm: f64) -> Comparison {
        let (baseline, rows) = (baseline(), longer_by(1.0, 8));
        let context = FitContext::new(&baseline, &rows, METHOD);
        let none = Fitted::none(&context);
        let chosen = none.with(candidate(&LONGER), &context);
        let rivals = vec![vec![chosen.clone()]];
        let found = Comparison { none, chosen, rivals, ..comparison(&[], &[0.0; 8], &context) };
        confirm(found, &context, Some(&longer_by(held_out_cm, 2)))
    }

    #[test]
    fn an_effect_that_the_runs_held_out_show_stays() {
        let found = confirmed(1.0);
        assert_eq!((found.chosen.ids(), found.rivals.len()), (vec!["longer"], 1));
    }

    /// Twenty rows that are right as they are lose ten nats by a centimetre more, and rows that go half of it too far
    /// gain nothing.
    #[test]
    fn an_effect_that_gains_nothing_on_the_runs_held_out_is_dropped() {
        for held_out_cm in [0.0, 0.5] {
            let found = confirmed(held_out_cm);
            assert!(found.chosen.ids().is_empty() && found.rivals.is_empty());
            assert_eq!(found.chosen.held_out, found.none.held_out);
            // What it explained is unexplained now, and the runs held out do not show that either.
            assert!(!found.beyond_chosen.is_empty() && !found.beyond_chosen.iter().any(Remainder::counts));
        }
    }

    #[test]
    fn without_runs_held_out_all_stays() {
        let (baseline, rows) = (baseline(), longer_by(0.0, 2));
        let context = FitContext::new(&baseline, &rows, METHOD);
        let found = confirm(comparison(&[&LONGER], &[10.0; 2], &context), &context, None);
        assert_eq!(found.chosen.ids(), ["longer"]);
    }
}
