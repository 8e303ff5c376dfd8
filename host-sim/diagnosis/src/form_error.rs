//! Model-form error: what a better form of an effect could gain, as a fraction of what the effect explains. It is measured on
//! robots with one known effect.

use super::confirm::weigh;
use super::fit::{FitContext, Fitted, best_of_each};
use super::sample::HoldOut;
use super::search::neighbours::Neighbours;
use super::search::{Fits, Selection};
use super::slot::Slot;

/// Resolution of the fraction that is measured.
const STEPS: usize = 1000;

impl Fits {
    /// Returns the [`further_share`](super::calibration::Calibration::further_share) from which on a search names no other
    /// effect next to the one with this id, which is the only one there. Returns `None` if another effect is found first.
    pub fn form_error_fraction(&self, id: &str, context: &FitContext, hold_out: Option<&HoldOut>) -> Option<f64> {
        let neighbours = Neighbours::default();
        let usual = Selection::new(self, &neighbours, context);
        let selection = |form_error: f64| Selection { form_error: Some(form_error), ..usual };
        let singles = best_of_each(self.singles.clone());
        let found = usual.first(&singles).filter(|found| found.ids() == [id])?;
        let mut further = usual.with_one_more(found);
        further.retain(|fit| selection(0.0).is_worth_adding(fit, found));
        let mut swapped: Vec<Option<Swapped>> = further.iter().map(|_| None).collect();
        let mut names_another = |form_error: f64| {
            let selection = selection(form_error);
            let next = further.iter().position(|fit| selection.is_worth_adding(fit, found));
            next.is_some_and(|next| {
                let swap = || Swapped::of(further[next].clone(), &usual, hold_out);
                let Swapped { fit, slots, is_confirmed } = swapped[next].get_or_insert_with(swap);
                *is_confirmed && selection.is_clear(fit, slots, found)
            })
        };
        let highest = (0..STEPS).rev().find(|step| names_another(*step as f64 / STEPS as f64));
        Some(highest.map_or(0.0, |step| (step + 1) as f64 / STEPS as f64))
    }
}

/// What a search makes of one effect and a further one.
struct Swapped {
    fit: Fitted,
    slots: Vec<Slot>,
    /// Whether held-out rows confirm more than one effect.
    is_confirmed: bool,
}

impl Swapped {
    fn of(next: Fitted, selection: &Selection, hold_out: Option<&HoldOut>) -> Self {
        let (fit, slots) = selection.swap_best(next);
        let null = &selection.fits.null;
        let confirmed = |rows| weigh(&fit, null, selection.context, rows).chosen.ids().len();
        let is_confirmed = hold_out.map_or(fit.ids().len(), confirmed) > 1;
        Swapped { fit, slots, is_confirmed }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Method;
    use crate::calibration::Calibration;
    use crate::test_support::*;
    use mindgap_learning::evaluation::observations::Observations;

    /// Steps of two alternating commands go three centimetres too far; those to the left go `more_cm` further.
    fn rows(more_cm: f64, blocks: usize) -> Observations {
        observations(blocks, 12, move |_, at| {
            let (command, off_cm) = if at % 2 == 0 { ([40.0, 60.0], 3.0 + more_cm) } else { ([60.0, 40.0], 3.0) };
            let off = [off_cm + 0.9 * alternating(at / 2), 0.0, 0.0];
            Made { commands: [command; 2], off, ..Made::default() }
        })
    }

    /// Measures the form error of an effect on rows that go `more_cm` further to the left, on held-out rows `held_out_cm`.
    fn measured(id: &str, more_cm: f64, held_out_cm: f64) -> Option<f64> {
        let baseline = baseline();
        let rows_found = identification(&baseline, rows(more_cm, 8));
        let hold_out = HoldOut::new(&baseline, rows(held_out_cm, 4));
        let context = FitContext::new(&rows_found, METHOD);
        Fits::of(&context).form_error_fraction(id, &context, Some(&hold_out))
    }

    #[test]
    fn perfect_form_has_no_form_error() {
        assert_eq!(measured("longer", 0.0, 0.0), Some(0.0));
    }

    /// A search by a fraction that is smaller by one step names another effect; a search by this fraction does not.
    #[test]
    fn search_by_the_measured_fraction_names_no_other_effect() {
        let fraction = measured("longer", 1.5, 1.5).expect("the effect is found first");
        assert!(fraction > 0.0 && fraction < 1.0, "{fraction}");
        let baseline = baseline();
        let rows = identification(&baseline, rows(1.5, 8));
        let found = |further_share: f64| {
            let calibration = Calibration { further_share, ..CALIBRATION };
            let context = FitContext::new(&rows, Method { calibration, ..METHOD });
            Fits::of(&context).search(&context).chosen.ids().len()
        };
        assert_eq!([found(fraction - 1.0 / STEPS as f64), found(fraction)], [2, 1]);
    }

    #[test]
    fn what_held_out_runs_refute_is_no_form_error() {
        assert_eq!(measured("longer", 1.5, -1.5), Some(0.0));
    }

    #[test]
    fn effect_that_is_not_found_first_has_no_measured_form_error() {
        assert_eq!(measured("farther", 0.0, 0.0), None);
    }
}
