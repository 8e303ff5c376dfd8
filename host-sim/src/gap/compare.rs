//! Comparison: which effects together explain the gap best, and what could stand in place of each.

use super::calibration::{Calibration, Gate};
use super::fit::{FitContext, Fitted, Gain, best_of_each};
use super::omnibus::ResidualFit;
use super::remainder::{Remainder, remainders};
use crate::effects::applied::AppliedEffect;

/// The effects that explain a gap best, if any does.
pub struct Comparison {
    /// The simulator as it is.
    pub none: Fitted,
    /// The effects together.
    pub chosen: Fitted,
    /// For each of the chosen effects the fits with it or another in its place, best first.
    pub rivals: Vec<Vec<Fitted>>,
    /// What anything could explain beyond no effect, by channel.
    pub beyond_none: Vec<Remainder>,
    /// What anything could explain beyond the chosen effects, by channel.
    pub beyond_chosen: Vec<Remainder>,
}

impl Comparison {
    /// Searches forward, and exchanges after each step. `alone` is every variant of every effect on its own.
    pub fn search(none: Fitted, alone: Vec<Fitted>, context: &FitContext) -> Self {
        let calibration = &context.calibration;
        let judgement = &calibration.judgement;
        let singles = best_of_each(alone.clone(), calibration);
        let first = singles.first().filter(|_| first_gain(&singles, &none, calibration).passes(&calibration.effect));
        let mut chosen = first.unwrap_or(&none).clone();
        let mut rivals = vec![singles];
        while !chosen.ids().is_empty() && chosen.ids().len() < judgement.most_effects {
            let further = best_of_each(chosen.with_each(Some(&alone), context), calibration);
            let Some(next) = further.into_iter().find(|f| is_worth_adding(f, &chosen, &none, calibration)) else {
                break;
            };
            let (settled, in_place) = settled(next, &alone, context);
            if in_place.iter().any(|others| rivals_in_reach(&settled, others, calibration) > judgement.most_rivals) {
                break;
            }
            (chosen, rivals) = (settled, in_place);
        }
        if let Some(others) = without_feigned_scatter(&chosen, context) {
            rivals = in_place_of_each(&others, &alone, context);
            chosen = others;
        }
        let beyond_none = remainders(&none, context);
        let beyond_chosen = remainders(&chosen, context);
        Comparison { none, chosen, rivals, beyond_none, beyond_chosen }
    }

    /// Given effects, without a search.
    pub fn given(applied: &[AppliedEffect], context: &FitContext) -> Self {
        let chosen = Fitted::given(applied, context);
        let beyond_chosen = remainders(&chosen, context);
        Comparison { none: Fitted::none(context), chosen, rivals: Vec::new(), beyond_none: Vec::new(), beyond_chosen }
    }

    /// Fits with another effect in place of the one at `place`, best first.
    pub fn rivals_of(&self, place: usize) -> Vec<&Fitted> {
        let ids = self.chosen.ids();
        let in_place = |r: &&Fitted| !r.ids().contains(&ids[place]) && r.ids().len() == ids.len();
        self.rivals.iter().flatten().filter(in_place).collect()
    }

    /// The effects that could be in place of the one at `place`, each with its relative likelihood, best first.
    pub fn likelihoods_in_place_of(&self, place: usize, calibration: &Calibration) -> Vec<(&'static str, f64)> {
        let ids = self.chosen.ids();
        let mut found: Vec<(&'static str, f64)> = Vec::new();
        for rival in self.rivals_of(place) {
            let other = rival.ids().into_iter().find(|id| !ids.contains(id));
            if let Some(other) = other.filter(|id| found.iter().all(|(known, _)| known != id)) {
                found.push((other, relative_likelihood(&self.chosen, rival, calibration)));
            }
        }
        found
    }

    /// The best fit in which one of the chosen effects is missing.
    pub fn runner_up(&self, calibration: &Calibration) -> Option<&Fitted> {
        let ids = self.chosen.ids();
        let others = self.rivals.iter().flatten().filter(|r| ids.iter().any(|id| !r.ids().contains(id)));
        others.max_by(|a, b| a.score(calibration).total_cmp(&b.score(calibration)))
    }
}

/// The relative likelihood of a rival against the winner: how likely so small a lead is chance.
pub fn relative_likelihood(winner: &Fitted, rival: &Fitted, calibration: &Calibration) -> f64 {
    let lead = winner.score(calibration) - rival.score(calibration);
    let error = Gain::of(&winner.gains_over(rival)).error;
    let z = lead.max(0.0) / libm::hypot(error, calibration.judgement.strong_nats);
    libm::exp(-0.5 * z * z)
}

/// What the best single effect gains; less where many others can stand for it.
pub fn first_gain(singles: &[Fitted], none: &Fitted, calibration: &Calibration) -> Gain {
    let Some(first) = singles.first() else { return Gain::NONE };
    let Gain { nats, error } = first.gain_over(none);
    let judgement = &calibration.judgement;
    let vague = rivals_in_reach(first, singles, calibration) > judgement.most_rivals;
    let divisor = if vague { judgement.vague_factor } else { 1.0 };
    Gain { nats: nats / divisor, error: error / divisor }
}

/// A fit at a bound is no finding: the likelihood would rise beyond what is physically possible.
fn is_worth_adding(fit: &Fitted, so_far: &Fitted, none: &Fitted, calibration: &Calibration) -> bool {
    if fit.last_is_at_a_bound() {
        return false;
    }
    let (gate, judgement) = (&calibration.effect, &calibration.judgement);
    let least = judgement.further_share * so_far.gain_over(none).nats;
    let beside = Gate { nats: gate.nats.max(least), z: gate.z.max(judgement.further_z) };
    fit.gain_over(so_far).passes(if fit.shares_a_stage() { &beside } else { gate })
}

/// How many effects do nearly as well in the place of one of the chosen.
fn rivals_in_reach(chosen: &Fitted, rivals: &[Fitted], calibration: &Calibration) -> usize {
    let least = calibration.judgement.rival_likelihood();
    let in_reach = |r: &&Fitted| r.ids() != chosen.ids() && relative_likelihood(chosen, r, calibration) >= least;
    rivals.iter().filter(in_reach).count()
}

/// Exchanges one effect for what does better in its place, if there is such. Returns what stands then, and for each of its
/// effects the fits with others in its place.
fn settled(chosen: Fitted, alone: &[Fitted], context: &FitContext) -> (Fitted, Vec<Vec<Fitted>>) {
    let calibration = &context.calibration;
    let score = |f: &Fitted| f.score(calibration);
    let rivals = in_place_of_each(&chosen, alone, context);
    let better = rivals.iter().flatten().max_by(|a, b| score(a).total_cmp(&score(b)));
    let least = score(&chosen) + calibration.judgement.parameter_nats;
    match better.filter(|f| score(f) > least && f.ids() != chosen.ids()) {
        Some(better) => (better.clone(), in_place_of_each(better, alone, context)),
        None => (chosen, rivals),
    }
}

/// The other effects, where one that only widens the scatter of readings does no better than readings that are moved by
/// circumstances: what moves readings one way here and another way there looks like scatter on the whole.
fn without_feigned_scatter(chosen: &Fitted, context: &FitContext) -> Option<Fitted> {
    let step = &context.observations.rows.first()?.context;
    let widens = chosen.hypothesis.candidates.iter().position(|c| {
        context.initial_guesses(c).first().is_some_and(|values| c.variant.only_widens_scatter(values, step))
    });
    let others = chosen.without(widens?, context);
    let moved: f64 = ResidualFit::moved_readings(&others, context).gains_over(&others, context).iter().sum();
    (others.score(&context.calibration) + moved > chosen.score(&context.calibration)).then_some(others)
}

/// For each effect the fits with it or another in its place, best first.
fn in_place_of_each(chosen: &Fitted, alone: &[Fitted], context: &FitContext) -> Vec<Vec<Fitted>> {
    let places = 0..chosen.ids().len();
    let in_place = |place: usize| chosen.without(place, context).with_each(Some(alone), context);
    places.map(|place| best_of_each(in_place(place), &context.calibration)).collect()
}

#[cfg(test)]
mod tests;
