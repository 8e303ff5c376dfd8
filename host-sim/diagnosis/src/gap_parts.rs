//! The gap in nats: what each named effect gains, what remains structured beyond them, and noise beyond the simulator's.
//!
//! Everything is scored with the noise that remains in the end. A squared error then counts half in units of that variance, so
//! that the parts add up as the parts of a mean squared error do. Noise itself counts by the fraction of its variance that the
//! simulator does not assume. Echoes count by their log-likelihood.

use super::confirm::Confirmed;
use super::fit::Fitted;
use super::sample::{RowSet, Sample};
use super::scores::Scores;
use mindgap_foundations::channel::Channel;
use mindgap_models::effects::Candidate;

/// The parts of a gap.
pub struct GapParts {
    /// Gain of each chosen effect, by its id.
    pub effects: Vec<(&'static str, Scores)>,
    /// Gain of the structured residual beyond them.
    pub unexplained: Scores,
    /// What noise beyond the simulator's costs.
    pub noise: Scores,
    /// The noise that remains, as standard deviations of forward (cm), lateral (cm) and turn (rad).
    remaining_noise: [f64; 3],
}

impl GapParts {
    /// Accounts for a gap on some rows.
    pub fn of(found: &Confirmed, rows: RowSet) -> Self {
        let (sample, remaining_noise) = (rows.sample(), remaining_noise(found));
        let scores = |fit: &Fitted| accounted(fit, remaining_noise, found, sample);
        let (null, chosen) = (scores(&found.fits.null), scores(&found.chosen));
        let mut unexplained = Scores::zero(sample.row_blocks());
        for remainder in found.beyond_chosen.iter().filter(|r| r.counts()) {
            let channel = remainder.channel();
            let noise = channel.motion_axis().map(|axis| remaining_noise[axis]);
            let gains = remainder.regression.column(noise, rows).into_iter().zip(chosen.of(channel));
            unexplained = unexplained.with(channel, &gains.map(|(a, b)| a - b).collect::<Vec<f64>>());
        }
        let ids = found.chosen.ids();
        let effects = shapley(ids.len(), |kept| match kept.len() {
            0 => Scores::zero(sample.row_blocks()),
            all if all == ids.len() => &chosen - &null,
            _ => &accounted(&subset(&found.chosen, kept), remaining_noise, found, sample) - &null,
        });
        let effects = ids.into_iter().zip(effects).collect();
        GapParts { effects, unexplained, noise: excess_noise(found, sample), remaining_noise }
    }

    /// Makes a gap of these parts for tests.
    #[cfg(test)]
    pub fn made_up(effects: Vec<(&'static str, Scores)>, noise: Scores, unexplained: Scores) -> Self {
        GapParts { effects, unexplained, noise, remaining_noise: [1.0; 3] }
    }

    /// Returns what the effects gain together.
    pub fn gained(&self) -> Scores {
        self.effects.iter().fold(self.noise.scaled(0.0), |sum, (_, gain)| &sum + gain)
    }

    /// Returns what could be reduced, per block: the gain of the effects and the unexplained structure.
    pub fn reducible(&self) -> Vec<f64> {
        (&self.gained() + &self.unexplained).by_block()
    }

    /// Returns the total gain of other effects than the chosen ones, with the same noise.
    pub fn gained_by(&self, fit: &Fitted, found: &Confirmed, sample: &Sample) -> f64 {
        let scores = |fit: &Fitted| accounted(fit, self.remaining_noise, found, sample);
        (&scores(fit) - &scores(&found.fits.null)).total()
    }
}

/// See [`GapParts::remaining_noise`].
fn remaining_noise(found: &Confirmed) -> [f64; 3] {
    let mut noise = found.chosen.noise;
    for remainder in found.beyond_chosen.iter().filter(|r| r.counts()) {
        if let (Some(axis), Some(beyond)) = (remainder.channel().motion_axis(), remainder.regression.noise()) {
            noise[axis] = beyond;
        }
    }
    noise
}

/// Returns the fraction of each row's variance beyond the simulator's, halved as every squared error is.
fn excess_noise(found: &Confirmed, sample: &Sample) -> Scores {
    let mut scores = Scores::zero(sample.row_blocks());
    for wider in &found.wider_noise {
        let nats = 0.5 * (1.0 - (wider.assumed / wider.fitted) * (wider.assumed / wider.fitted));
        let rows: Vec<f64> = sample.rows.iter().map(|row| if row.motion.is_some() { nats } else { 0.0 }).collect();
        scores = scores.with(Channel::MOTION[wider.axis], &rows);
    }
    scores
}

/// Returns the gain of each effect, averaged over all orders in which the effects could be added (Shapley 1953), so that effects
/// that overlap share what both explain.
fn shapley(effects: usize, gained: impl Fn(&[usize]) -> Scores) -> Vec<Scores> {
    let worth = worth_of_sets(effects, gained);
    let factorial = |n: usize| (1..=n).map(|i| i as f64).product::<f64>();
    let of = |effect: usize| {
        let without = (0..worth.len()).filter(|set| set >> effect & 1 == 0);
        without.fold(worth[0].scaled(0.0), |sum, set| {
            let before = set.count_ones() as usize;
            let weight = factorial(before) * factorial(effects - before - 1) / factorial(effects);
            &sum + &(&worth[set | 1 << effect] - &worth[set]).scaled(weight)
        })
    };
    (0..effects).map(of).collect()
}

/// Returns the gain of each set of effects, one bit per effect. A proper subset gains as much as its best subset: a wide beam
/// without the absorption that comes with it loses, and would never be added first.
fn worth_of_sets(effects: usize, gained: impl Fn(&[usize]) -> Scores) -> Vec<Scores> {
    let all = (1 << effects) - 1;
    let mut worth: Vec<Scores> = Vec::with_capacity(1 << effects);
    for set in 0..=all {
        let members: Vec<usize> = (0..effects).filter(|i| set >> i & 1 == 1).collect();
        let own = gained(&members);
        let fewer = members.iter().map(|i| &worth[set & !(1 << i)]);
        let fewer = fewer.max_by(|a, b| a.total().total_cmp(&b.total()));
        let best = fewer.filter(|fewer| set != all && fewer.total() > own.total()).cloned().unwrap_or(own);
        worth.push(best);
    }
    worth
}

/// Returns some of the effects, at the parameters that they have together with the others.
fn subset(chosen: &Fitted, kept: &[usize]) -> Fitted {
    let candidates: Vec<Candidate> = kept.iter().map(|i| chosen.hypothesis.candidates[*i]).collect();
    let values = kept.iter().flat_map(|i| chosen.values_of(*i)).copied().collect();
    let (hypothesis, witnesses) = (chosen.hypothesis.of(candidates), chosen.witnesses.of(kept));
    Fitted { hypothesis, values, witnesses, ..chosen.clone() }
}

/// Scores rows with the noise that remains in the end. Simulated runs have no witnesses, which are left out; but of a robot that
/// nobody tracked they are all that shows its motion.
fn accounted(fit: &Fitted, noise: [f64; 3], found: &Confirmed, sample: &Sample) -> Scores {
    let scores = fit.scores_within(noise, sample);
    if sample.rows.iter().any(|row| row.motion.is_some()) {
        return scores;
    }
    let witnesses = fit.witnesses.within(&found.chosen.witnesses);
    scores.with_witnesses(&fit.hypothesis.witnessed(&witnesses, sample, &fit.values))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::block_scores;

    /// Returns the shares of two effects that gain ten nats together, given what each gains alone.
    fn shares(alone: [f64; 2]) -> [f64; 2] {
        let gained = |kept: &[usize]| {
            let nats = match kept {
                [] => 0.0,
                [one] => alone[*one],
                _ => 10.0,
            };
            block_scores(Channel::EchoValue, &[nats])
        };
        let shares = shapley(2, gained);
        [0, 1].map(|effect| shares[effect].total())
    }

    #[test]
    fn effects_share_what_they_gain_together() {
        assert_eq!(shares([4.0, 6.0]), [4.0, 6.0]);
        assert_eq!(shares([8.0, 10.0]), [4.0, 6.0]);
        assert_eq!(shares([4.0, 0.0]), [7.0, 3.0]);
    }

    /// An effect that hurts alone would not be added first.
    #[test]
    fn shapley_share_of_an_effect_that_hurts_alone() {
        assert_eq!(shares([-50.0, 6.0]), [2.0, 8.0]);
        assert_eq!(shares([-50.0, -1.0]), [5.0, 5.0]);
    }
}
