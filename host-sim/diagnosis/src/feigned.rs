//! How much of what an effect explains its form feigns: what is named beside an effect that is there alone.

use super::compare::{Comparison, Place, first, is_clear, is_worth_adding, settled};
use super::confirm::borne_out;
use super::fit::{FitContext, Fitted, best_of_each};
use mindgap_learning::evaluation::observations::Observations;

/// Steps in which the share is sought: a thousandth each.
const SHARES: usize = 1000;

impl Comparison {
    /// The [`further_share`](super::calibration::Calibration::further_share) from which on no other effect is named
    /// beside the one with this id, which is there alone; none where another is found first. A search by that share would end
    /// with it.
    pub fn feigned_share(&self, id: &str, context: &FitContext, hold_out: Option<&Observations>) -> Option<f64> {
        let singles = best_of_each(self.alone.clone());
        let found = first(&singles, &self.none, context).filter(|found| found.ids() == [id])?;
        let mut further = best_of_each(found.with_each(Some(&self.alone), context));
        further.retain(|fit| is_worth_adding(fit, found, &self.none, 0.0, context));
        let mut settled_on: Vec<Option<Settled>> = further.iter().map(|_| None).collect();
        let mut is_named = |share: f64| {
            let next = further.iter().position(|fit| is_worth_adding(fit, found, &self.none, share, context));
            next.is_some_and(|next| {
                let of = || Settled::of(further[next].clone(), self, context, hold_out);
                let Settled { fit, places, holds } = settled_on[next].get_or_insert_with(of);
                *holds && is_clear(fit, places, found, &self.none, share, context)
            })
        };
        let highest = (0..SHARES).rev().find(|step| is_named(*step as f64 / SHARES as f64));
        Some(highest.map_or(0.0, |step| (step + 1) as f64 / SHARES as f64))
    }
}

/// What a search would make of an effect and a further one.
struct Settled {
    fit: Fitted,
    places: Vec<Place>,
    /// Whether the runs held out bear more than one effect out.
    holds: bool,
}

impl Settled {
    fn of(next: Fitted, found: &Comparison, context: &FitContext, hold_out: Option<&Observations>) -> Self {
        let (fit, places) = settled(next, &found.alone, context);
        let borne_out = |hold_out| borne_out(&fit, &found.none, context, hold_out).ids().len();
        let holds = hold_out.map_or(fit.ids().len(), borne_out) > 1;
        Settled { fit, places, holds }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Method;
    use crate::calibration::Calibration;
    use crate::test_support::*;

    /// Steps of two commands in turn, which go three centimetres too far, and those to the left so much more.
    fn rows(more_cm: f64, blocks: usize) -> Observations {
        observations(blocks, 12, move |_, at| {
            let (command, off_cm) = if at % 2 == 0 { ([40.0, 60.0], 3.0 + more_cm) } else { ([60.0, 40.0], 3.0) };
            let off = [off_cm + 0.9 * alternating(at / 2), 0.0, 0.0];
            Made { commands: [command; 2], off, ..Made::default() }
        })
    }

    /// What `look` makes of a search of rows that go so much farther to the left.
    fn searched<T>(more_cm: f64, calibration: Calibration, look: impl Fn(&Comparison, &FitContext) -> T) -> T {
        let (baseline, rows) = (baseline(), rows(more_cm, 8));
        let context = FitContext::new(&baseline, &rows, Method { calibration, ..METHOD });
        let none = Fitted::none(&context);
        let alone = none.with_each(None, &context);
        look(&Comparison::search(none, alone, &context), &context)
    }

    /// What `longer` feigns where steps to the left go so much farther, on the runs held out so much.
    fn feigned(more_cm: f64, held_out_cm: f64) -> Option<f64> {
        let hold_out = rows(held_out_cm, 4);
        searched(more_cm, CALIBRATION, |found, context| found.feigned_share("longer", context, Some(&hold_out)))
    }

    #[test]
    fn what_leaves_nothing_over_feigns_nothing() {
        assert_eq!(feigned(0.0, 0.0), Some(0.0));
    }

    /// Searches by a share that is less by a step name another effect beside it, and those by this one do not.
    #[test]
    fn a_search_by_the_share_that_is_feigned_ends_with_the_effect() {
        let share = feigned(1.5, 1.5).expect("the effect is found first");
        assert!(share > 0.0 && share < 1.0, "{share}");
        let found = |further_share: f64| {
            let calibration = Calibration { further_share, ..CALIBRATION };
            searched(1.5, calibration, |found, _| found.chosen.ids().len())
        };
        assert_eq!([found(share - 1.0 / SHARES as f64), found(share)], [2, 1]);
    }

    #[test]
    fn what_runs_held_out_do_not_bear_out_is_not_feigned() {
        assert_eq!(feigned(1.5, -1.5), Some(0.0));
    }

    #[test]
    fn an_effect_that_is_not_found_first_is_not_asked() {
        let other = |found: &Comparison, context: &FitContext| found.feigned_share("farther", context, None);
        assert_eq!(searched(0.0, CALIBRATION, other), None);
    }
}
