//! Comparison: which effects together explain the gap best, and what could stand in place of each.

use super::calibration::Calibration;
use super::channel::Channel;
use super::fit::{FitContext, Fitted, TOLERANCE_NATS, best_of_each};
use super::gain::Gain;
use super::omnibus::ResidualFit;
use super::remainder::{Remainder, remainders};
use super::scatter::WiderScatter;
use mindgap_learning::evaluation::paths::Paths;
use mindgap_models::effects::applied::AppliedEffect;

/// The effects that explain a gap best, if any does.
pub struct Comparison {
    /// The simulator as it is.
    pub none: Fitted,
    /// The effects together.
    pub chosen: Fitted,
    /// For each of the chosen effects the fits with it or another in its place that show in these logs, best first.
    pub rivals: Vec<Vec<Fitted>>,
    /// What each of the chosen effects gains beside the others.
    pub own: Vec<OwnGain>,
    /// Every variant of every effect on its own.
    pub alone: Vec<Fitted>,
    /// What anything could explain beyond no effect, by channel.
    pub beyond_none: Vec<Remainder>,
    /// What anything could explain beyond the chosen effects, by channel.
    pub beyond_chosen: Vec<Remainder>,
    /// The motion channels that scatter more than the simulator assumes, once confirmed.
    pub scatter: Vec<WiderScatter>,
    /// Rollouts without and with the chosen effects on the confirming runs, once confirmed.
    pub paths: Vec<Paths>,
}

/// What one effect gains beside others.
#[derive(Clone, Copy, Debug)]
pub struct OwnGain {
    /// All of it, nats.
    pub nats: f64,
    /// How much of it is no more than what forms of the others that are not quite right could leave over, nats.
    pub feigned_nats: f64,
}

/// The place of one of several effects.
pub(super) struct Place {
    /// The others alone.
    without: Fitted,
    /// The others with the effect or another one in its place, as far as it shows in these logs, best first.
    taken: Vec<Fitted>,
}

/// Effects whose gains are told to whoever asks.
const TOLD: usize = 5;

impl Comparison {
    /// Searches by adding one effect at a time; after each step effects are exchanged, and those that the others have made
    /// needless are dropped. `alone` is every variant of every effect on its own.
    pub fn search(none: Fitted, alone: Vec<Fitted>, context: &FitContext) -> Self {
        let calibration = &context.calibration;
        let share = calibration.further_share;
        let singles = best_of_each(alone.clone());
        for single in singles.iter().take(TOLD) {
            let Gain { nats, broad_nats, .. } = single.gain_over(&none);
            let vague = if is_vague(single, &singles, calibration) { "; many others could stand for it" } else { "" };
            let name = single.ids().join("+");
            log::info!(
                "{name} alone gains {nats:.1} nats ({broad_nats:.1} with less of the runs that gain most{vague})"
            );
        }
        let mut chosen = first(&singles, &none, context).unwrap_or(&none).clone();
        let mut places: Vec<Place> = chosen.ids().iter().map(|_| Place::new(none.clone(), singles.clone())).collect();
        while !chosen.ids().is_empty() && chosen.ids().len() < calibration.judgement.most_effects {
            let further = best_of_each(chosen.with_each(Some(&alone), context));
            for fit in further.iter().take(TOLD) {
                // `info!` works out what it tells only if somebody listens.
                log::info!(
                    "{} gain {}",
                    fit.ids().join("+"),
                    OwnGain::of(fit, &chosen, &none, share, context).in_words()
                );
            }
            let Some(next) = further.into_iter().find(|f| is_worth_adding(f, &chosen, &none, share, context)) else {
                break;
            };
            let (settled, places_of_it) = settled(next, &alone, context);
            if !is_clear(&settled, &places_of_it, &chosen, &none, share, context) {
                log::info!("too many others could stand for {}", settled.ids().join("+"));
                break;
            }
            let before = chosen.log_evidence();
            (chosen, places) = without_needless(settled, places_of_it, &alone, &none, context);
            log::info!("{} together gain {:.1} nats", chosen.ids().join("+"), chosen.gain_over(&none).nats);
            // An exchange that led to what was dropped again would lead round in a circle.
            if chosen.log_evidence() <= before {
                break;
            }
        }
        if let Some(others) = without_feigned_scatter(&chosen, context) {
            places = places_of(&others, &alone, context);
            chosen = others;
        }
        let beyond_none = remainders(&none, context);
        Comparison { alone, beyond_none, ..Comparison::of(none.clone(), none) }.settled_on(chosen, places, context)
    }

    /// Given effects, without a search.
    pub fn given(applied: &[AppliedEffect], context: &FitContext) -> Self {
        let chosen = Fitted::given(applied, context);
        let beyond_chosen = remainders(&chosen, context);
        Comparison { beyond_chosen, ..Comparison::of(Fitted::none(context), chosen) }
    }

    /// The same with other effects chosen.
    pub fn choosing(self, chosen: Fitted, context: &FitContext) -> Self {
        let places = places_of(&chosen, &self.alone, context);
        self.settled_on(chosen, places, context)
    }

    fn settled_on(self, chosen: Fitted, places: Vec<Place>, context: &FitContext) -> Self {
        let share = context.calibration.further_share;
        let own = places.iter().map(|place| OwnGain::of(&chosen, &place.without, &self.none, share, context)).collect();
        let rivals = places.into_iter().map(|place| place.taken).collect();
        Comparison { beyond_chosen: remainders(&chosen, context), chosen, rivals, own, ..self }
    }

    /// Two fits, with nothing beside them.
    pub(super) fn of(none: Fitted, chosen: Fitted) -> Self {
        Comparison {
            none,
            chosen,
            rivals: Vec::new(),
            own: Vec::new(),
            alone: Vec::new(),
            beyond_none: Vec::new(),
            beyond_chosen: Vec::new(),
            scatter: Vec::new(),
            paths: Vec::new(),
        }
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

    /// How probable it is that an effect is there beside the others, and does not just mend what is not quite right with their
    /// forms: its odds are those of what it gains to what it has to gain to be added at all.
    pub fn probability_beside_others(&self, place: usize, calibration: &Calibration) -> f64 {
        let Some(own) = self.own.get(place).filter(|_| self.own.len() > 1) else { return 1.0 };
        let gained = own.nats.max(0.0);
        gained / (gained + calibration.effect_nats + own.feigned_nats)
    }

    /// The best fit in which one of the chosen effects is missing.
    pub fn runner_up(&self) -> Option<&Fitted> {
        let ids = self.chosen.ids();
        let others = self.rivals.iter().flatten().filter(|r| ids.iter().any(|id| !r.ids().contains(id)));
        others.max_by(|a, b| a.log_evidence().total_cmp(&b.log_evidence()))
    }
}

/// The relative likelihood of a rival against the winner: how likely so small a lead is chance.
pub fn relative_likelihood(winner: &Fitted, rival: &Fitted, calibration: &Calibration) -> f64 {
    let lead = winner.log_evidence() - rival.log_evidence();
    let error = Gain::of(&winner.gains_over(rival)).error;
    let z = lead.max(0.0) / libm::hypot(error, calibration.judgement.strong_nats);
    libm::exp(-0.5 * z * z)
}

/// The single effect that is found first; none where none counts.
pub(super) fn first<'a>(singles: &'a [Fitted], none: &Fitted, context: &FitContext) -> Option<&'a Fitted> {
    singles.iter().find(|single| gain_alone(single, singles, none, context).passes(context.calibration.effect_nats))
}

/// What the single effect gains that gains most, if it is to count alone.
pub fn most_alone(singles: &[Fitted], none: &Fitted, context: &FitContext) -> Gain {
    let gains = singles.iter().map(|single| gain_alone(single, singles, none, context));
    gains.max_by(|a, b| a.broad_nats.total_cmp(&b.broad_nats)).unwrap_or(Gain::NONE)
}

/// What a single effect gains; less where many others can stand for it.
fn gain_alone(single: &Fitted, singles: &[Fitted], none: &Fitted, context: &FitContext) -> Gain {
    let calibration = &context.calibration;
    let gain = further_gain(single, none, none, calibration.further_share, context);
    if is_vague(single, singles, calibration) { gain.over(calibration.judgement.vague_factor) } else { gain }
}

impl OwnGain {
    /// What `fit` gains over the same effects without one of them. In each channel this share of what those and the
    /// simulator's effects explain there could be had by a better form of theirs; where they explain nothing, nothing could.
    fn of(fit: &Fitted, others: &Fitted, none: &Fitted, share: f64, context: &FitContext) -> Self {
        let feigned = Channel::ALL.map(|channel| {
            let explained = others.gained_in(channel, none).max(0.0) + context.explained_already[channel.index()];
            fit.gained_in(channel, others).clamp(0.0, share * explained)
        });
        OwnGain { nats: fit.gain_over(others).nats, feigned_nats: feigned.iter().sum() }
    }

    fn in_words(&self) -> String {
        format!("{:.1} nats more, {:.1} would mend a form", self.nats, self.feigned_nats)
    }
}

/// A fit at a bound is no finding: the likelihood would rise beyond what is physically possible.
pub(super) fn is_worth_adding(fit: &Fitted, so_far: &Fitted, none: &Fitted, share: f64, context: &FitContext) -> bool {
    let at_bound = !fit.at_bound(fit.ids().len() - 1).is_empty();
    !at_bound && further_gain(fit, so_far, none, share, context).passes(context.calibration.effect_nats)
}

/// What one more effect gains beyond what forms of the others that are not quite right could leave over.
fn further_gain(fit: &Fitted, so_far: &Fitted, none: &Fitted, share: f64, context: &FitContext) -> Gain {
    fit.gain_over(so_far).less(OwnGain::of(fit, so_far, none, share, context).feigned_nats)
}

/// Whether not too many others could stand for any of the effects, or what they gain over those so far is twice as much as
/// has to be.
pub(super) fn is_clear(
    fit: &Fitted,
    places: &[Place],
    so_far: &Fitted,
    none: &Fitted,
    share: f64,
    context: &FitContext,
) -> bool {
    let calibration = &context.calibration;
    let gain = further_gain(fit, so_far, none, share, context).over(calibration.judgement.vague_factor);
    let vague = |place: &Place| is_vague(fit, &place.taken, calibration);
    gain.passes(calibration.effect_nats) || !places.iter().any(vague)
}

/// Whether too many other effects could stand for one.
fn is_vague(chosen: &Fitted, rivals: &[Fitted], calibration: &Calibration) -> bool {
    rivals_in_reach(chosen, rivals, calibration) > calibration.judgement.most_rivals
}

/// How many effects do nearly as well in the place of one of the chosen.
fn rivals_in_reach(chosen: &Fitted, rivals: &[Fitted], calibration: &Calibration) -> usize {
    let least = calibration.judgement.rival_likelihood();
    let in_reach = |r: &&Fitted| r.ids() != chosen.ids() && relative_likelihood(chosen, r, calibration) >= least;
    rivals.iter().filter(in_reach).count()
}

/// Exchanges one effect for what does better in its place, if there is such. Returns what stands then, and the places of its
/// effects.
pub(super) fn settled(chosen: Fitted, alone: &[Fitted], context: &FitContext) -> (Fitted, Vec<Place>) {
    let places = places_of(&chosen, alone, context);
    let taken = places.iter().flat_map(|place| &place.taken);
    let better = taken.max_by(|a, b| a.log_evidence().total_cmp(&b.log_evidence()));
    match better.filter(|f| f.log_evidence() > chosen.log_evidence() && f.ids() != chosen.ids()) {
        Some(better) => (better.clone(), places_of(better, alone, context)),
        None => (chosen, places),
    }
}

/// Drops effects that would not be added any more beside the others as they are now.
fn without_needless(
    chosen: Fitted,
    places: Vec<Place>,
    alone: &[Fitted],
    none: &Fitted,
    context: &FitContext,
) -> (Fitted, Vec<Place>) {
    let Calibration { effect_nats, further_share, .. } = context.calibration;
    let needless = |others: &&Fitted| !further_gain(&chosen, others, none, further_share, context).passes(effect_nats);
    let fewer = places.iter().map(|place| &place.without).filter(needless);
    match fewer.max_by(|a, b| a.log_evidence().total_cmp(&b.log_evidence())).cloned() {
        Some(fewer) => {
            let places = places_of(&fewer, alone, context);
            without_needless(fewer, places, alone, none, context)
        }
        None => (chosen, places),
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
    let moved: f64 = ResidualFit::moved_readings(&others, context).gains(context).iter().sum();
    (others.log_evidence() + moved > chosen.log_evidence()).then_some(others)
}

fn places_of(chosen: &Fitted, alone: &[Fitted], context: &FitContext) -> Vec<Place> {
    let place = |place: usize| {
        let without = chosen.without(place, context);
        let taken = best_of_each(without.with_each(Some(alone), context));
        Place::new(without, taken)
    };
    (0..chosen.ids().len()).map(place).collect()
}

impl Place {
    /// Of these only those count that do better on blocks held out than the others alone: what these logs do not show stands
    /// for nothing. A dozen effects of motion are no rivals to a beam where the robot stands still.
    fn new(without: Fitted, mut taken: Vec<Fitted>) -> Self {
        taken.retain(|fit| fit.gains_over(&without).iter().sum::<f64>() > TOLERANCE_NATS);
        Place { without, taken }
    }
}

#[cfg(test)]
mod tests;
