//! Confirmation: what holds on rows that nothing was fitted to.

pub mod unconfirmed;

use unconfirmed::{Evidence, Unconfirmed};

use super::calibration::Calibration;
use super::explanation::Explanation;
use super::fit::{FitContext, Fitted};
use super::outliers::{Outliers, outliers};
use super::remainder::{Remainder, remainders};
use super::sample::{HoldOut, Sample};
use super::search::{Fits, Search};
use super::slot::{Slot, relative_likelihood};
use super::wider_noise::{WiderNoise, wider_noise};
use mindgap_learning::evaluation::paths::{Paths, Rollouts};
use mindgap_models::effects::applied::AppliedEffect;

/// The third stage: the effects, structured residuals and wider noise that held-out rows confirm.
pub struct Confirmed {
    /// Every effect fitted alone.
    pub fits: Fits,
    /// The confirmed effects together.
    pub chosen: Fitted,
    /// The slot of each of them.
    pub slots: Vec<Slot>,
    /// The effects that were found and that held-out rows do not confirm.
    pub unconfirmed: Vec<Unconfirmed>,
    /// The structured residual without any effect, by channel.
    pub beyond_null: Vec<Remainder>,
    /// The structured residual that the confirmed effects leave, by channel.
    pub beyond_chosen: Vec<Remainder>,
    /// The motion channels whose noise exceeds the simulator's.
    pub wider_noise: Vec<WiderNoise>,
    /// The rows that lie farther off than the noise model expects, by channel.
    pub outliers: Vec<Outliers>,
    /// Open-loop paths without and with the effects, on held-out rows if there are any.
    pub paths: Vec<Paths>,
}

impl Search {
    /// Drops effects and structured residuals that gain nothing on held-out rows.
    pub fn confirm(mut self, context: &FitContext, hold_out: Option<&HoldOut>) -> Confirmed {
        let mut unconfirmed = Vec::new();
        if let Some(rows) = hold_out {
            let weighed = weigh(&self.chosen, &self.fits.null, context, rows);
            let chosen = weighed.chosen;
            unconfirmed = weighed.unconfirmed;
            if chosen.ids() != self.chosen.ids() {
                self = self.choosing(chosen, context);
            }
            for remainder in self.beyond_null.iter_mut().chain(&mut self.beyond_chosen) {
                remainder.confirm(context, rows);
            }
        }
        let Search { fits, chosen, slots, beyond_null, beyond_chosen, .. } = self;
        let wider_noise = wider_noise(&beyond_chosen, context, hold_out);
        let sample: &Sample = match hold_out {
            Some(rows) => rows,
            None => context.rows,
        };
        let paths = paths(&fits.null, &chosen, context, sample);
        log::info!("confirmed: {}", if chosen.ids().is_empty() { "no effect".into() } else { chosen.name() });
        let outliers = outliers(&chosen, context, hold_out);
        Confirmed { fits, chosen, slots, unconfirmed, beyond_null, beyond_chosen, wider_noise, outliers, paths }
    }
}

impl Confirmed {
    /// Takes effects as confirmed that are given, without a search.
    pub fn given(applied: &[AppliedEffect], context: &FitContext) -> Self {
        let chosen = Fitted::given(applied, context);
        let beyond_chosen = remainders(&chosen, context);
        Confirmed { beyond_chosen, ..Confirmed::unexamined(Fitted::null(context), chosen) }
    }

    /// Two fits, and nothing that was found next to them.
    pub(super) fn unexamined(null: Fitted, chosen: Fitted) -> Self {
        Confirmed {
            fits: Fits { null, singles: Vec::new() },
            chosen,
            slots: Vec::new(),
            unconfirmed: Vec::new(),
            beyond_null: Vec::new(),
            beyond_chosen: Vec::new(),
            wider_noise: Vec::new(),
            outliers: Vec::new(),
            paths: Vec::new(),
        }
    }

    /// Returns the fits with another effect in the slot of this one, best first.
    pub fn rivals_of(&self, effect: usize) -> Vec<&Fitted> {
        let ids = self.chosen.ids();
        let is_rival = |r: &&Fitted| !r.ids().contains(&ids[effect]) && r.ids().len() == ids.len();
        self.slots.iter().flat_map(|slot| &slot.rivals).filter(is_rival).collect()
    }

    /// Returns the ids of the effects that could take the slot of this one, each with its relative likelihood, best first.
    pub fn rival_likelihoods(&self, effect: usize, calibration: &Calibration) -> Vec<(&'static str, f64)> {
        let ids = self.chosen.ids();
        let mut found: Vec<(&'static str, f64)> = Vec::new();
        for rival in self.rivals_of(effect) {
            let other = rival.ids().into_iter().find(|id| !ids.contains(id));
            if let Some(other) = other.filter(|id| found.iter().all(|(known, _)| known != id)) {
                found.push((other, relative_likelihood(&self.chosen, rival, calibration)));
            }
        }
        found
    }

    /// Returns the probability that an effect is there next to the others, and does not only correct their form: its odds are
    /// those of its gain to the gain that is required to add it.
    pub fn probability_next_to_others(&self, effect: usize, calibration: &Calibration) -> f64 {
        let Some(slot) = self.slots.get(effect).filter(|_| self.slots.len() > 1) else { return 1.0 };
        let gained = slot.gain.gain.nats.max(0.0);
        gained / (gained + calibration.effect_nats + slot.gain.form_error_nats)
    }

    /// Returns the best fit without one of the chosen effects.
    pub fn runner_up(&self) -> Option<&Fitted> {
        let ids = self.chosen.ids();
        let rivals = self.slots.iter().flat_map(|slot| &slot.rivals);
        let others = rivals.filter(|r| ids.iter().any(|id| !r.ids().contains(id)));
        others.max_by(|a, b| a.log_evidence().total_cmp(&b.log_evidence()))
    }
}

/// Returns nothing where motion is not compared.
fn paths(null: &Fitted, chosen: &Fitted, context: &FitContext, rows: &Sample) -> Vec<Paths> {
    let Some(drive) = &context.baseline().motion else { return Vec::new() };
    let [before, after] = [null, chosen].map(Fitted::effects);
    Rollouts { drive, before: &before, after: &after, noise: chosen.noise }.paths(rows, context.seed)
}

/// What held-out rows leave of effects.
pub(super) struct Weighed {
    /// The effects that are confirmed.
    pub chosen: Fitted,
    /// The others, where all rows together still speak for them.
    pub unconfirmed: Vec<Unconfirmed>,
}

/// Weighs effects on held-out rows, each next to the others and all together. Where these rows do not excite the effects enough
/// to confirm or refute them, what was found by cross-validation stands.
pub(super) fn weigh(chosen: &Fitted, null: &Fitted, context: &FitContext, rows: &HoldOut) -> Weighed {
    let mut unconfirmed = Vec::new();
    if chosen.ids().is_empty() {
        return Weighed { chosen: null.clone(), unconfirmed };
    }
    let chosen = drop_unconfirmed(chosen.clone(), context, rows, &mut unconfirmed);
    let gained = chosen.held_out_gain_over(null, rows);
    log::info!("{} gain {gained:.1} nats on held-out runs", chosen.name());
    let evidence = Evidence { with: &chosen, without: null, hold_out: rows };
    if gained >= context.calibration.judgement.strong_nats || !evidence.can_confirm(context) {
        return Weighed { chosen, unconfirmed };
    }
    if evidence.stands_over_all(context) {
        let found_nats = chosen.gain_over(null).nats;
        let entry = |id| Unconfirmed { id, found_nats, confirmed_nats: gained, sensor: None };
        unconfirmed.extend(chosen.ids().into_iter().map(entry));
    }
    Weighed { chosen: null.clone(), unconfirmed }
}

/// Drops effects that gain nothing next to the others on held-out rows. Any gain suffices: few rows are held out, and each effect
/// had strong evidence on the rows where it was found. Two effects that can stand for each other both gain nothing, and few
/// held-out rows do not show which of them it is: the one is dropped first whose removal leaves the highest likelihood over all
/// rows.
fn drop_unconfirmed(
    chosen: Fitted,
    context: &FitContext,
    rows: &HoldOut,
    unconfirmed: &mut Vec<Unconfirmed>,
) -> Fitted {
    if chosen.ids().len() < 2 {
        return chosen;
    }
    let nats = |fit: &Fitted| fit.predict(rows).total();
    let all = nats(&chosen);
    let without = |effect| {
        let fit = chosen.without(effect, context);
        let fewer = nats(&fit);
        log::info!("{} gains {:.1} nats next to the others on held-out runs", chosen.ids()[effect], all - fewer);
        (effect, fewer, fit)
    };
    let refuted = (0..chosen.ids().len()).map(without).filter(|(_, fewer, _)| *fewer >= all);
    let on_all_rows = |(_, fewer, fit): &(usize, f64, Fitted)| fewer + fit.log_evidence();
    match refuted.max_by(|a, b| on_all_rows(a).total_cmp(&on_all_rows(b))) {
        Some((effect, nats, fewer)) => {
            log::info!("of {} only {} gain on held-out runs", chosen.name(), fewer.name());
            if (Evidence { with: &chosen, without: &fewer, hold_out: rows }).stands_over_all(context) {
                let found_nats = chosen.gain_over(&fewer).nats;
                unconfirmed.push(Unconfirmed {
                    id: chosen.ids()[effect],
                    found_nats,
                    confirmed_nats: all - nats,
                    sensor: None,
                });
            }
            drop_unconfirmed(fewer, context, rows, unconfirmed)
        }
        None => chosen,
    }
}

#[cfg(test)]
mod tests;
