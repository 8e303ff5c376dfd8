//! Search: which effects together explain the gap best, and what could take the place of each.

pub(super) mod neighbours;

use super::calibration::Calibration;
use super::explanation::Explanation;
use super::fit::{FitContext, Fitted, best_of_each};
use super::gain::Gain;
use super::omnibus::Regression;
use super::remainder::{Remainder, remainders};
use super::slot::{FurtherGain, Slot, is_ambiguous};
use mindgap_models::effects::Candidate;
use neighbours::Neighbours;

/// The first stage: every effect fitted alone.
#[derive(Clone)]
pub struct Fits {
    /// The simulator as it is.
    pub null: Fitted,
    /// Every variant of every effect that could be alone.
    pub singles: Vec<Fitted>,
}

/// The second stage: the effects that together explain the gap best, if any does.
pub struct Search {
    /// The stage before.
    pub fits: Fits,
    /// The effects together.
    pub chosen: Fitted,
    /// The slot of each of them.
    pub slots: Vec<Slot>,
    /// The structured residual without any effect, by channel.
    pub beyond_null: Vec<Remainder>,
    /// The structured residual that the chosen effects leave, by channel.
    pub beyond_chosen: Vec<Remainder>,
    /// What was fitted on the way.
    pub(super) neighbours: Neighbours,
}

/// The rules by which effects are selected.
pub(super) struct Selection<'a> {
    pub fits: &'a Fits,
    pub neighbours: &'a Neighbours,
    pub context: &'a FitContext<'a>,
    /// Fraction of what effects explain in a channel that a better form of them could gain there; `None` for the calibrated one.
    pub form_error: Option<f64>,
    /// The first of the chosen effects are not swapped or pruned: this number of them is free under every hypothesis.
    pub always_free: usize,
}

/// Number of effects whose gains are logged.
const LOGGED: usize = 5;
/// Variants that are free under every hypothesis against a textbook, which answers at once: every robot has some dead time and
/// some lag, and what is not free is taken by the first effect that can imitate it.
const ALWAYS_FREE: [(&str, &str); 2] = [("latency", "delay"), ("inertia", "first_order_lag")];

impl Fits {
    /// Fits every variant of every effect alone. Where some of the motion is free under every hypothesis, no effect of the motion
    /// is ever alone.
    pub fn of(context: &FitContext) -> Self {
        let null = Fitted::null(context);
        let is_ever_alone = |candidate: &Candidate| !candidate.variant.moves() || always_free(context).is_empty();
        Fits { singles: null.with_each_alone(is_ever_alone, context), null }
    }

    /// Returns the largest gain of a single effect, as it would have to count alone.
    pub fn best_single(&self, context: &FitContext) -> Gain {
        let neighbours = Neighbours::default();
        let selection = Selection::new(self, &neighbours, context);
        let singles = best_of_each(self.singles.clone());
        let gains = singles.iter().map(|single| selection.gain_alone(single, &singles));
        gains.max_by(|a, b| a.winsorized_nats.total_cmp(&b.winsorized_nats)).unwrap_or(Gain::NONE)
    }

    /// Adds one effect at a time. After each addition effects are swapped for better ones, and those that the others make
    /// redundant are pruned.
    pub fn search(self, context: &FitContext) -> Search {
        let neighbours = Neighbours::default();
        let selection = Selection::new(&self, &neighbours, context);
        let chosen = selection.select();
        let slots = selection.slots_of(&chosen);
        let beyond_null = remainders(&self.null, context);
        Search { beyond_null, beyond_chosen: remainders(&chosen, context), fits: self, chosen, slots, neighbours }
    }
}

impl Search {
    /// Chooses other effects in place of those that were found.
    pub fn choosing(self, chosen: Fitted, context: &FitContext) -> Self {
        let slots = Selection::new(&self.fits, &self.neighbours, context).slots_of(&chosen);
        Search { beyond_chosen: remainders(&chosen, context), chosen, slots, ..self }
    }
}

impl<'a> Selection<'a> {
    pub fn new(fits: &'a Fits, neighbours: &'a Neighbours, context: &'a FitContext<'a>) -> Self {
        Selection { fits, neighbours, context, form_error: None, always_free: 0 }
    }

    fn select(&self) -> Fitted {
        let best_singles = best_of_each(self.fits.singles.clone());
        self.log_singles(&best_singles);
        let chosen = match (self.with_always_free(), self.first(&best_singles)) {
            (Some(free), _) => {
                let searching = Selection { always_free: free.ids().len(), ..*self };
                self.prune(searching.add_further(free))
            }
            (None, Some(first)) => self.add_further(first.clone()),
            (None, None) => self.fits.null.clone(),
        };
        self.without_false_noise(&chosen).unwrap_or(chosen)
    }

    /// Adds one effect at a time to those chosen so far, as long as one is worth it.
    fn add_further(&self, mut chosen: Fitted) -> Fitted {
        let most_effects = self.always_free + self.calibration().judgement.most_effects;
        while !chosen.ids().is_empty() && chosen.ids().len() < most_effects {
            let further = self.with_one_more(&chosen);
            for fit in further.iter().take(LOGGED) {
                log::info!("{}: {}", fit.name(), self.further_gain(fit, &chosen).in_words());
            }
            let Some(next) = further.into_iter().find(|fit| self.is_worth_adding(fit, &chosen)) else { break };
            let (swapped, slots) = self.swap_best(next);
            if !self.is_clear(&swapped, &slots, &chosen) {
                log::info!("{} is ambiguous with many others", swapped.name());
                break;
            }
            let evidence_before = chosen.log_evidence();
            chosen = self.prune(swapped);
            log::info!("{} together gain {:.1} nats", chosen.name(), chosen.gain_over(&self.fits.null).nats);
            // A swap back to what was pruned would repeat forever.
            if chosen.log_evidence() <= evidence_before {
                break;
            }
        }
        chosen
    }

    /// Returns the fit of what is free under every hypothesis; `None` where nothing is.
    fn with_always_free(&self) -> Option<Fitted> {
        let free = always_free(self.context);
        let fitted = free.iter().fold(self.fits.null.clone(), |fit, candidate| fit.with(*candidate, self.context));
        (!free.is_empty()).then_some(fitted)
    }

    /// Returns the best fit of each further effect added to these, best first, as far as it gains anything over them.
    pub fn with_one_more(&self, fit: &Fitted) -> Vec<Fitted> {
        self.neighbours.of(fit, self.fits, self.context)
    }

    fn log_singles(&self, singles: &[Fitted]) {
        for single in singles.iter().take(LOGGED) {
            let Gain { nats, winsorized_nats, .. } = single.gain_over(&self.fits.null);
            let is_ambiguous = is_ambiguous(single, singles, self.calibration());
            let ambiguity = if is_ambiguous { "; ambiguous with many others" } else { "" };
            let name = single.name();
            log::info!("{name} alone gains {nats:.1} nats ({winsorized_nats:.1} winsorized over runs{ambiguity})");
        }
    }

    fn calibration(&self) -> &Calibration {
        &self.context.calibration
    }

    /// Returns the single effect that is chosen first, if one counts.
    pub fn first<'f>(&self, singles: &'f [Fitted]) -> Option<&'f Fitted> {
        singles.iter().find(|single| self.gain_alone(single, singles).passes(self.calibration().effect_nats))
    }

    /// Returns what a single effect gains, reduced if it is ambiguous.
    fn gain_alone(&self, single: &Fitted, singles: &[Fitted]) -> Gain {
        let gain = self.further_gain(single, &self.fits.null).beyond_form_error();
        let is_ambiguous = is_ambiguous(single, singles, self.calibration());
        if is_ambiguous { gain.over(self.calibration().judgement.vague_factor) } else { gain }
    }

    fn further_gain(&self, fit: &Fitted, others: &Fitted) -> FurtherGain {
        let form_error = self.form_error.unwrap_or_else(|| calibrated_form_error(others, self.context));
        FurtherGain::of(fit, others, &self.fits.null, form_error, self.context)
    }

    /// Returns whether the effect that was added last counts. A parameter at a bound rules it out: the likelihood would rise
    /// beyond what is physically possible.
    pub fn is_worth_adding(&self, fit: &Fitted, so_far: &Fitted) -> bool {
        let is_at_bound = !fit.at_bound(fit.ids().len() - 1).is_empty();
        !is_at_bound && self.counts(&self.further_gain(fit, so_far))
    }

    fn counts(&self, gain: &FurtherGain) -> bool {
        gain.beyond_form_error().passes(self.calibration().effect_nats)
    }

    /// Returns whether no effect is ambiguous, or the gain over the effects so far is twice what is required.
    pub fn is_clear(&self, fit: &Fitted, slots: &[Slot], so_far: &Fitted) -> bool {
        let calibration = self.calibration();
        let gain = self.further_gain(fit, so_far).beyond_form_error().over(calibration.judgement.vague_factor);
        let is_ambiguous = |slot: &Slot| is_ambiguous(fit, &slot.rivals, calibration);
        gain.passes(calibration.effect_nats) || !slots.iter().any(is_ambiguous)
    }

    /// Swaps one effect for the best rival in its slot if that is better. Returns the effects with their slots.
    pub fn swap_best(&self, chosen: Fitted) -> (Fitted, Vec<Slot>) {
        let slots = self.slots_of(&chosen);
        let rivals = slots.iter().flat_map(|slot| &slot.rivals);
        let best = rivals.max_by(|a, b| a.log_evidence().total_cmp(&b.log_evidence()));
        match best.filter(|f| f.log_evidence() > chosen.log_evidence() && f.ids() != chosen.ids()) {
            Some(best) => (best.clone(), self.slots_of(best)),
            None => (chosen, slots),
        }
    }

    /// Drops effects that would no longer be added to the others.
    fn prune(&self, chosen: Fitted) -> Fitted {
        let without = |effect| chosen.without(effect, self.context);
        let fewer = (self.always_free..chosen.ids().len()).map(without);
        let redundant = fewer.filter(|fewer| !self.counts(&self.further_gain(&chosen, fewer)));
        match redundant.max_by(|a, b| a.log_evidence().total_cmp(&b.log_evidence())) {
            Some(fewer) => self.prune(fewer),
            None => chosen,
        }
    }

    /// Returns the effects without one that only widens the noise of readings, if readings that are shifted by covariates
    /// explain as much: shifts in different directions at different places look like noise on the whole.
    fn without_false_noise(&self, chosen: &Fitted) -> Option<Fitted> {
        let step = &self.context.rows.rows.first()?.context;
        let widens = chosen.hypothesis.candidates.iter().position(|c| {
            let guesses = self.context.initial_guesses(c);
            guesses.first().is_some_and(|values| c.variant.only_widens_scatter(values, step))
        });
        let others = chosen.without(widens?, self.context);
        let shifted: f64 = Regression::of_shifted_readings(&others, self.context).gains().iter().sum();
        (others.log_evidence() + shifted > chosen.log_evidence()).then_some(others)
    }

    /// Returns the slots of the effects that are not always free.
    pub fn slots_of(&self, chosen: &Fitted) -> Vec<Slot> {
        let slot = |effect: usize| {
            let without = chosen.without(effect, self.context);
            let taken = self.with_one_more(&without);
            let gain = self.further_gain(chosen, &without);
            Slot::new(without, taken, gain)
        };
        (self.always_free..chosen.ids().len()).map(slot).collect()
    }
}

/// Returns the fraction of what effects explain that a better form of them could gain: that of the effect whose form is the
/// worst. What is free under every hypothesis is no finding, and has the usual one.
fn calibrated_form_error(effects: &Fitted, context: &FitContext) -> f64 {
    let free = always_free(context);
    let found = effects.hypothesis.candidates.iter().filter(|candidate| !free.contains(candidate));
    let own = context.further_shares.largest(found.map(|candidate| candidate.effect));
    own.max(context.calibration.further_share)
}

/// Returns what is free under every hypothesis against this baseline.
fn always_free(context: &FitContext) -> Vec<Candidate> {
    let is_textbook = context.baseline().motion.as_ref().is_some_and(|motion| !motion.is_learned());
    let free = ALWAYS_FREE.iter().filter(|_| is_textbook);
    free.filter_map(|(effect, variant)| Candidate::named_in(&context.catalogue, effect, variant)).collect()
}

#[cfg(test)]
mod tests;
