//! Fits with one more effect, each computed once.

use std::cell::RefCell;

use crate::explanation::Explanation;
use crate::fit::parts::Part;
use crate::fit::{FitContext, Fitted, TOLERANCE_NATS, best_of_each};
use crate::search::Fits;

/// What one more effect adds to effects that a search has met. It meets the same ones again when it adds, swaps and prunes, and
/// the same effects of the motion next to others of the sensor.
#[derive(Default)]
pub struct Neighbours {
    known: RefCell<Vec<Neighbourhood>>,
}

struct Neighbourhood {
    of: Fitted,
    part: Part,
    with_one_more: Vec<Fitted>,
}

impl Neighbours {
    /// Returns the best fit of each further effect added to these, best first. What gains nothing on blocks that it was not
    /// fitted to is left out: most effects do not, and each fit holds a score per row and channel.
    pub fn of(&self, fit: &Fitted, fits: &Fits, context: &FitContext) -> Vec<Fitted> {
        let of_part = |part: Part| match fit.split(part, &fits.null) {
            Some([own, other]) => {
                let further = self.within(&own, part, fits, context);
                further.iter().map(|further| fit.joined(part, further, &other)).collect()
            }
            None => self.within(fit, part, fits, context),
        };
        best_of_each(Part::ALL.into_iter().flat_map(of_part).collect())
    }

    fn within(&self, fit: &Fitted, part: Part, fits: &Fits, context: &FitContext) -> Vec<Fitted> {
        let known = self.known.borrow().iter().find(|known| known.serves(fit, part)).map(|k| k.with_one_more.clone());
        known.unwrap_or_else(|| {
            let mut with_one_more = best_of_each(added(fit, part, fits, context));
            with_one_more.retain(|further| further.gains_over(fit).iter().sum::<f64>() > TOLERANCE_NATS);
            let neighbourhood = Neighbourhood { of: fit.clone(), part, with_one_more: with_one_more.clone() };
            self.known.borrow_mut().push(neighbourhood);
            with_one_more
        })
    }
}

/// Single effects are fitted already, if any of this part could be alone.
fn added(fit: &Fitted, part: Part, fits: &Fits, context: &FitContext) -> Vec<Fitted> {
    let is_of_part = |single: &&Fitted| Part::of(&single.hypothesis.candidates[0]) == part;
    let singles: Vec<Fitted> = fits.singles.iter().filter(is_of_part).cloned().collect();
    if fit.ids().is_empty() && !singles.is_empty() { singles } else { fit.with_each(part, context) }
}

impl Neighbourhood {
    /// Returns whether it is that of the same effects, fitted as well as here. A better maximum has other neighbours.
    fn serves(&self, fit: &Fitted, part: Part) -> bool {
        self.part == part
            && self.of.hypothesis.candidates == fit.hypothesis.candidates
            && fit.log_evidence() <= self.of.log_evidence() + TOLERANCE_NATS
    }
}
