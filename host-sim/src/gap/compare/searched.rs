//! What can be added to effects, sought once for each set of them: without one of its effects, a set is often one that the
//! search came by before.

use std::cell::RefCell;
use std::rc::Rc;

use super::super::fit::{FitContext, Fitted, TOLERANCE_NATS, best_of_each};

/// The sets of effects to which others were added.
pub struct Searched<'a> {
    alone: &'a [Fitted],
    context: &'a FitContext<'a>,
    known: RefCell<Vec<Rc<Extended>>>,
}

/// Effects, and what can be added to them.
pub struct Extended {
    /// The effects.
    pub fit: Fitted,
    /// The same with one more, the best fit of each, best first.
    pub further: Vec<Fitted>,
}

impl<'a> Searched<'a> {
    /// None yet; `alone` is every variant of every effect on its own.
    pub fn new(alone: &'a [Fitted], context: &'a FitContext<'a>) -> Self {
        Searched { alone, context, known: RefCell::default() }
    }

    /// What can be added to effects. Where they were fitted before, and no worse than here, it is what was found then.
    pub fn extended(&self, fit: Fitted) -> Rc<Extended> {
        let is_same = |known: &Extended| known.fit.hypothesis.candidates == fit.hypothesis.candidates;
        let mut known = self.known.borrow_mut();
        let place = known.iter().position(|known| is_same(known));
        if let Some(as_good) = place.map(|place| &known[place])
            && as_good.fit.log_evidence() + TOLERANCE_NATS >= fit.log_evidence()
        {
            return Rc::clone(as_good);
        }
        let further = best_of_each(fit.with_each(Some(self.alone), self.context));
        let extended = Rc::new(Extended { fit, further });
        place.map(|place| known.remove(place));
        known.push(Rc::clone(&extended));
        extended
    }

    /// Effects without the one at `place`, and what can be added to the others.
    pub fn without(&self, fit: &Fitted, place: usize) -> Rc<Extended> {
        self.extended(fit.without(place, self.context))
    }
}
