//! One effect among several: what it gains next to the others, and what could take its place.

use super::calibration::Calibration;
use super::explanation::Explanation;
use super::fit::{FitContext, Fitted, TOLERANCE_NATS};
use super::gain::Gain;
use mindgap_foundations::channel::Channel;

/// The slot of one of several effects.
pub struct Slot {
    /// The other effects alone.
    pub without: Fitted,
    /// The others with the effect or a rival in its slot, best first. Only what shows in these logs is listed.
    pub rivals: Vec<Fitted>,
    /// The gain of the effect over the others alone.
    pub gain: FurtherGain,
}

/// The gain of one more effect over others.
#[derive(Clone, Copy, Debug)]
pub struct FurtherGain {
    /// The whole gain.
    pub gain: Gain,
    /// The part of it that model-form error of the others could account for, nats.
    pub form_error_nats: f64,
}

impl Slot {
    /// `taken` are the others with each effect in the slot, best first. Only those that beat the others alone on blocks that
    /// they were not fitted to are rivals: a dozen effects of motion are no rivals of a beam if the robot stands still.
    pub fn new(without: Fitted, taken: Vec<Fitted>, gain: FurtherGain) -> Self {
        let mut rivals = taken;
        rivals.retain(|fit| fit.gains_over(&without).iter().sum::<f64>() > TOLERANCE_NATS);
        Slot { without, rivals, gain }
    }
}

impl FurtherGain {
    /// Compares `fit` with the same effects without one of them. In each channel a better form of those others, or of the
    /// simulator's effects, could gain the fraction `form_error` of what they explain there; if they explain nothing, nothing.
    pub fn of(fit: &Fitted, others: &Fitted, null: &Fitted, form_error: f64, context: &FitContext) -> Self {
        let form_error_nats = Channel::ALL.map(|channel| {
            let explained = others.gained_in(channel, null).max(0.0) + context.already_explained[channel.index()];
            fit.gained_in(channel, others).clamp(0.0, form_error * explained)
        });
        FurtherGain { gain: fit.gain_over(others), form_error_nats: form_error_nats.iter().sum() }
    }

    /// Returns the gain beyond model-form error.
    pub fn beyond_form_error(&self) -> Gain {
        self.gain.less(self.form_error_nats)
    }

    /// Describes it for the log.
    pub fn in_words(&self) -> String {
        format!("{:.1} nats gained, {:.1} of it could be model-form error", self.gain.nats, self.form_error_nats)
    }
}

/// Returns the likelihood of a rival relative to the winner: the probability of so small a lead by chance.
pub fn relative_likelihood(winner: &Fitted, rival: &Fitted, calibration: &Calibration) -> f64 {
    let lead = winner.log_evidence() - rival.log_evidence();
    let error = Gain::of(&winner.gains_over(rival)).error;
    let z = lead.max(0.0) / libm::hypot(error, calibration.judgement.strong_nats);
    libm::exp(-0.5 * z * z)
}

/// Returns whether too many rivals could stand for an effect.
pub fn is_ambiguous(chosen: &Fitted, rivals: &[Fitted], calibration: &Calibration) -> bool {
    rivals_in_reach(chosen, rivals, calibration) > calibration.judgement.most_rivals
}

/// Returns the number of other effects that do nearly as well.
fn rivals_in_reach(chosen: &Fitted, rivals: &[Fitted], calibration: &Calibration) -> usize {
    let least = calibration.judgement.rival_likelihood();
    let is_in_reach = |r: &&Fitted| r.ids() != chosen.ids() && relative_likelihood(chosen, r, calibration) >= least;
    rivals.iter().filter(is_in_reach).count()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::*;
    use mindgap_models::effects::Effect;

    /// A lead of z times √(error² + 3²) nats has the relative likelihood exp(−z²/2).
    #[test]
    fn relative_likelihood_falls_with_the_lead_in_standard_errors() {
        with_two_rows(|context| {
            let fit = |effect: &'static Effect, gains: [f64; 2]| made_up(&[effect], &[0.0], &gains, context);
            let winner = fit(&LONGER, [10.0, 10.0]);
            let against = |gains| relative_likelihood(&winner, &fit(&FARTHER, gains), &CALIBRATION);
            assert_eq!(against([10.0, 10.0]), 1.0);
            assert_eq!(against([12.0, 12.0]), 1.0, "a rival is never more likely than the winner");
            assert!((against([8.5, 8.5]) - libm::exp(-0.5)).abs() < 1e-12);
            assert!((against([7.0, 7.0]) - libm::exp(-2.0)).abs() < 1e-12);
            // Leads of 7 and −1 differ from their mean by 4: an error of 8 nats, added to the 3 of strong evidence.
            let z_squared = 6.0 * 6.0 / (8.0 * 8.0 + 3.0 * 3.0);
            assert!((against([3.0, 11.0]) - libm::exp(-0.5 * z_squared)).abs() < 1e-12);
            let more_complex = Fitted { complexity_penalties: [1.0, 0.0], ..fit(&FARTHER, [10.0, 10.0]) };
            let z = 1.0 / 3.0;
            assert!(
                (relative_likelihood(&winner, &more_complex, &CALIBRATION) - libm::exp(-0.5 * z * z)).abs() < 1e-12
            );
        });
    }

    /// A rival is in reach if it lags by two standard errors at most: six nats if all blocks agree.
    #[test]
    fn rivals_in_reach_are_counted() {
        with_two_rows(|context| {
            let fit = |effect: &'static Effect, each: f64| made_up(&[effect], &[0.0], &[each; 2], context);
            let chosen = fit(&LONGER, 10.0);
            let count = |rivals: &[Fitted]| rivals_in_reach(&chosen, rivals, &CALIBRATION);
            assert_eq!(count(&[]), 0);
            assert_eq!(count(&[fit(&LONGER, 10.0)]), 0, "an effect is not its own rival");
            assert_eq!(count(&[fit(&FARTHER, 7.1), fit(&LONGER_TO_THE_LEFT, 6.9)]), 1);
        });
    }
}
