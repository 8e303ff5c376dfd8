//! The gap in nats, block by block and channel by channel: what each named effect gains, what follows circumstances that no
//! named effect does, and scatter beyond what the simulator assumes.
//!
//! Everything is valued at the scatter that stays in the end. A squared error counts half of it in units of that scatter's
//! variance, so that the parts add up as the parts of a mean squared error do; scatter itself counts by the share of its
//! variance that the simulator does not assume. Echoes count by their log-likelihood.

use super::channel::Channel;
use super::compare::Comparison;
use super::fit::{FitContext, Fitted};
use super::hypothesis::{Hypothesis, LogLikelihood};
use mindgap_learning::evaluation::observations::Observations;
use mindgap_models::effects::Candidate;

/// The parts of a gap on some logs.
pub struct Ledger {
    /// What each of the chosen effects gains, by its id.
    pub effects: Vec<(&'static str, Entry)>,
    /// What the residual model gains beyond them.
    pub unexplained: Entry,
    /// What scatter beyond the simulator's takes.
    pub scatter: Entry,
    /// The scatter that stays once all is explained that can be, forward (cm), lateral (cm), turn (rad).
    settled: [f64; 3],
}

/// Nats of each channel, by block.
#[derive(Clone, Debug)]
pub struct Entry {
    channels: [Vec<f64>; Channel::ALL.len()],
}

impl Ledger {
    /// Of what was found, on some logs.
    pub fn of(found: &Comparison, context: &FitContext, logs: &Observations) -> Self {
        let settled = settled_scatter(found, context);
        let judged = |fit: &Fitted| fit.hypothesis.log_likelihood_with(settled, context.baseline, logs, &fit.values);
        let (none, chosen) = (judged(&found.none), judged(&found.chosen));
        let mut unexplained = Entry::nothing(logs.blocks);
        for remainder in found.beyond_chosen.iter().filter(|r| r.counts()) {
            let channel = remainder.channel();
            let within = channel.motion_axis().map(|axis| settled[axis]);
            let gains = remainder.model.judged_with(within, logs, context).into_iter().zip(chosen.channel(channel));
            unexplained.channels[channel.index()] = logs.by_block(&gains.map(|(a, b)| a - b).collect::<Vec<f64>>());
        }
        let ids = found.chosen.ids();
        let effects = shapley(ids.len(), |kept| match kept.len() {
            0 => Entry::nothing(logs.blocks),
            all if all == ids.len() => Entry::difference(&chosen, &none, logs),
            _ => {
                let (hypothesis, values) = subset(&found.chosen, kept);
                let gained = hypothesis.log_likelihood_with(settled, context.baseline, logs, &values);
                Entry::difference(&gained, &none, logs)
            }
        });
        Ledger { effects: ids.into_iter().zip(effects).collect(), unexplained, scatter: wider(found, logs), settled }
    }

    /// For tests: these parts.
    #[cfg(test)]
    pub fn made_up(effects: Vec<(&'static str, Entry)>, scatter: Entry, unexplained: Entry) -> Self {
        Ledger { effects, unexplained, scatter, settled: [1.0; 3] }
    }

    /// What could be reduced, by block: what the effects gain and what is unexplained.
    pub fn reducible(&self) -> Vec<f64> {
        let unexplained = self.unexplained.of(&Channel::ALL);
        self.gained(&Channel::ALL).iter().zip(unexplained).map(|(gained, left)| gained + left).collect()
    }

    /// What other effects than the chosen ones gain, valued at the same scatter.
    pub fn gained_by(&self, fit: &Fitted, found: &Comparison, context: &FitContext, logs: &Observations) -> Entry {
        let judged =
            |fit: &Fitted| fit.hypothesis.log_likelihood_with(self.settled, context.baseline, logs, &fit.values);
        Entry::difference(&judged(fit), &judged(&found.none), logs)
    }

    /// What the effects gain together, by block.
    pub fn gained(&self, channels: &[Channel]) -> Vec<f64> {
        let mut sum = vec![0.0; self.scatter.channels[0].len()];
        for (_, entry) in &self.effects {
            sum.iter_mut().zip(entry.of(channels)).for_each(|(s, e)| *s += e);
        }
        sum
    }
}

impl Entry {
    fn nothing(blocks: usize) -> Self {
        Entry { channels: std::array::from_fn(|_| vec![0.0; blocks]) }
    }

    /// One channel alone.
    #[cfg(test)]
    pub fn of_channel(channel: Channel, by_block: Vec<f64>) -> Self {
        let mut entry = Entry::nothing(by_block.len());
        entry.channels[channel.index()] = by_block;
        entry
    }

    /// By how much channels are likelier under `a` than under `b`.
    fn difference(a: &LogLikelihood, b: &LogLikelihood, logs: &Observations) -> Self {
        let channels = Channel::ALL.map(|channel| {
            let gains = a.channel(channel).into_iter().zip(b.channel(channel));
            logs.by_block(&gains.map(|(a, b)| a - b).collect::<Vec<f64>>())
        });
        Entry { channels }
    }

    /// Channels together, by block.
    pub fn of(&self, channels: &[Channel]) -> Vec<f64> {
        let mut sum = vec![0.0; self.channels[0].len()];
        for channel in channels {
            sum.iter_mut().zip(&self.channels[channel.index()]).for_each(|(s, e)| *s += e);
        }
        sum
    }

    fn add(&mut self, share: f64, other: &Entry) {
        for (own, other) in self.channels.iter_mut().zip(&other.channels) {
            own.iter_mut().zip(other).for_each(|(a, b)| *a += share * b);
        }
    }
}

/// See [`Ledger::settled`].
fn settled_scatter(found: &Comparison, context: &FitContext) -> [f64; 3] {
    let mut scatter = found.chosen.scatter(context);
    for remainder in found.beyond_chosen.iter().filter(|r| r.counts()) {
        if let (Some(axis), Some(own)) = (remainder.channel().motion_axis(), remainder.model.scatter()) {
            scatter[axis] = own;
        }
    }
    scatter
}

/// The share of each row's variance beyond the simulator's, halved as every squared error is.
fn wider(found: &Comparison, logs: &Observations) -> Entry {
    let mut entry = Entry::nothing(logs.blocks);
    for wider in &found.scatter {
        let nats = 0.5 * (1.0 - (wider.assumed / wider.own) * (wider.assumed / wider.own));
        let rows: Vec<f64> = logs.rows.iter().map(|row| if row.motion.is_some() { nats } else { 0.0 }).collect();
        entry.channels[wider.axis] = logs.by_block(&rows);
    }
    entry
}

/// What each effect gains on average over all orders in which the effects could be added (Shapley 1953): effects that
/// overlap share what both explain.
fn shapley(effects: usize, gained: impl Fn(&[usize]) -> Entry) -> Vec<Entry> {
    let worth = worth_of_sets(effects, gained);
    let factorial = |n: usize| (1..=n).map(|i| i as f64).product::<f64>();
    let of = |effect: usize| {
        let mut entry = Entry::nothing(worth[0].channels[0].len());
        for set in (0..worth.len()).filter(|set| set >> effect & 1 == 0) {
            let before = set.count_ones() as usize;
            let weight = factorial(before) * factorial(effects - before - 1) / factorial(effects);
            entry.add(weight, &worth[set | 1 << effect]);
            entry.add(-weight, &worth[set]);
        }
        entry
    };
    (0..effects).map(of).collect()
}

/// What each set of effects gains, a bit an effect. Fewer than all gain as much as the best of them do: a wide beam without
/// the absorption beside it loses, and nobody would add it first to lose by it.
fn worth_of_sets(effects: usize, gained: impl Fn(&[usize]) -> Entry) -> Vec<Entry> {
    let all = (1 << effects) - 1;
    let total = |entry: &Entry| entry.of(&Channel::ALL).iter().sum::<f64>();
    let mut worth: Vec<Entry> = Vec::with_capacity(1 << effects);
    for set in 0..=all {
        let members: Vec<usize> = (0..effects).filter(|i| set >> i & 1 == 1).collect();
        let own = gained(&members);
        let fewer = members.iter().map(|i| &worth[set & !(1 << i)]).max_by(|a, b| total(a).total_cmp(&total(b)));
        let best = fewer.filter(|fewer| set != all && total(fewer) > total(&own)).cloned().unwrap_or(own);
        worth.push(best);
    }
    worth
}

/// Some of the effects at the parameters that all have together.
fn subset(chosen: &Fitted, kept: &[usize]) -> (Hypothesis, Vec<f64>) {
    let candidates: Vec<Candidate> = kept.iter().map(|i| chosen.hypothesis.candidates[*i]).collect();
    let values = kept.iter().flat_map(|i| chosen.values_of(*i)).copied().collect();
    (chosen.hypothesis.of(candidates), values)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What two effects get of ten nats that both gain together, by what each gains alone.
    fn shares(alone: [f64; 2]) -> [f64; 2] {
        let gained = |kept: &[usize]| {
            let nats = match kept {
                [] => 0.0,
                [one] => alone[*one],
                _ => 10.0,
            };
            Entry::of_channel(Channel::EchoValue, vec![nats])
        };
        let entries = shapley(2, gained);
        [0, 1].map(|effect| entries[effect].of(&Channel::ALL)[0])
    }

    #[test]
    fn effects_share_what_they_gain_together() {
        assert_eq!(shares([4.0, 6.0]), [4.0, 6.0]);
        assert_eq!(shares([8.0, 10.0]), [4.0, 6.0]);
        assert_eq!(shares([4.0, 0.0]), [7.0, 3.0]);
    }

    /// Without the other one each makes things worse: neither would be added first for its own sake.
    #[test]
    fn what_loses_without_the_others_has_its_part_of_what_they_gain_together() {
        assert_eq!(shares([-50.0, 6.0]), [2.0, 8.0]);
        assert_eq!(shares([-50.0, -1.0]), [5.0, 5.0]);
    }
}
