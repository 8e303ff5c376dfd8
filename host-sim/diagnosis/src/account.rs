//! Accounting: how far the gap shrinks with the named effects, channel by channel, on runs that nothing was sought on.

use serde::Serialize;

use super::budget::{Part, budget};
use super::channel::Channel;
use super::compare::Comparison;
use super::fit::FitContext;
use super::ledger::Ledger;
use mindgap_foundations::statistics::{bootstrap, rounding};
use mindgap_learning::evaluation::observations::Observations;
use mindgap_learning::evaluation::paths::PathError;

/// What a gap is made of, and how far it shrinks.
#[derive(Clone, Debug)]
pub struct Account {
    /// How far it shrinks; none where the confirming runs show none that could be reduced.
    pub reduction: Option<GapReduction>,
    /// Its parts.
    pub budget: Vec<Part>,
    /// What could be reduced, nats by block.
    pub reducible: Vec<f64>,
}

/// A gap in nats a step: how much likelier the logs could be.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GapReduction {
    /// All channels together.
    #[serde(flatten)]
    pub whole: Reduction,
    /// Gaps are measured from what cannot be reduced by anything that follows circumstances, so that this is zero.
    pub floor: f64,
    /// The next best explanation.
    pub runner_up: Option<RunnerUp>,
    /// The same channel by channel, where there is something to close.
    pub channels: Vec<ChannelReduction>,
    /// Paths that the simulator drives open-loop from a logged pose.
    pub paths: Vec<PathError>,
}

/// How far a gap shrinks, nats a step.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Reduction {
    /// The gap of the simulator as it is.
    #[serde(serialize_with = "rounding::number")]
    pub before: f64,
    /// With the effects.
    #[serde(serialize_with = "rounding::number")]
    pub after: f64,
    /// The share of the reducible gap that is closed.
    #[serde(serialize_with = "rounding::number")]
    pub reducible_closed: f64,
    /// 95 % interval of that share, by bootstrap over blocks of runs.
    #[serde(serialize_with = "rounding::interval")]
    pub ci95: [f64; 2],
}

/// How far the gap of a channel shrinks.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ChannelReduction {
    /// The channel.
    pub channel: Channel,
    /// Its gap.
    #[serde(flatten)]
    pub reduction: Reduction,
}

/// The next best explanation.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RunnerUp {
    /// Its effect, or effects joined by `+`.
    pub id: String,
    /// The share of the reducible gap that it closes.
    #[serde(serialize_with = "rounding::number")]
    pub reducible_closed: f64,
}

/// Nats by block: what the effects gained, and what remains that a learner of anything can gain beyond them.
struct Tally {
    gained: Vec<f64>,
    remaining: Vec<f64>,
}

/// The account of a gap on some logs, among the effects that are named.
pub fn account(found: &Comparison, named: &[&'static str], context: &FitContext, logs: &Observations) -> Account {
    let ledger = Ledger::of(found, context, logs);
    let budget = budget(named, &ledger, context.seed);
    Account { reduction: reduction(found, &ledger, context, logs), budget, reducible: ledger.reducible() }
}

/// None where these logs show no reducible gap.
fn reduction(found: &Comparison, ledger: &Ledger, context: &FitContext, logs: &Observations) -> Option<GapReduction> {
    let seed = context.seed;
    let tally =
        |channels: &[Channel]| Tally { gained: ledger.gained(channels), remaining: ledger.unexplained.of(channels) };
    let steps = logs.rows.len() as f64;
    let all = tally(&Channel::ALL);
    let whole = all.reduction(steps, seed)?;
    let channel = |channel: Channel| {
        let tally = tally(&[channel]);
        let told = tally.reducible() >= context.calibration.judgement.strong_nats;
        Some(ChannelReduction { channel, reduction: tally.reduction(steps, seed).filter(|_| told)? })
    };
    let runner_up = found.runner_up().map(|fit| {
        let gained: f64 = ledger.gained_by(fit, found, context, logs).of(&Channel::ALL).iter().sum();
        RunnerUp { id: fit.ids().join("+"), reducible_closed: gained / all.reducible() }
    });
    let paths = found.paths.iter().map(|paths| paths.error).collect();
    let channels = Channel::ALL.into_iter().filter_map(channel).collect();
    Some(GapReduction { whole, floor: 0.0, runner_up, channels, paths })
}

impl Tally {
    fn reducible(&self) -> f64 {
        self.gained.iter().sum::<f64>() + self.remaining.iter().sum::<f64>().max(0.0)
    }

    fn reduction(&self, steps: f64, seed: u64) -> Option<Reduction> {
        let (gained, reducible) = (self.gained.iter().sum::<f64>(), self.reducible());
        (reducible > 0.0).then(|| Reduction {
            before: reducible / steps,
            after: (reducible - gained) / steps,
            reducible_closed: gained / reducible,
            ci95: self.interval(seed),
        })
    }

    fn interval(&self, seed: u64) -> [f64; 2] {
        bootstrap::interval(&self.gained, &self.remaining, seed, |gained, remaining| {
            let reducible = gained + remaining.max(0.0);
            (reducible > 0.0).then(|| gained / reducible)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::Fitted;
    use crate::residual_law::log_density;
    use crate::test_support::*;

    fn tally(gained: &[f64], remaining: &[f64]) -> Tally {
        Tally { gained: gained.to_vec(), remaining: remaining.to_vec() }
    }

    /// Every block gains six nats of eight: the share is three quarters however blocks are drawn.
    #[test]
    fn the_closed_share_is_what_is_gained_of_what_could_be() {
        let found = tally(&[6.0; 4], &[2.0; 4]).reduction(16.0, 1).expect("a gap");
        assert_eq!(found, Reduction { before: 2.0, after: 0.5, reducible_closed: 0.75, ci95: [0.75; 2] });
    }

    #[test]
    fn nothing_remains_where_less_than_nothing_does() {
        let found = tally(&[6.0; 4], &[-2.0; 4]).reduction(24.0, 1).expect("a gap");
        assert_eq!((found.before, found.after, found.reducible_closed), (1.0, 0.0, 1.0));
    }

    #[test]
    fn without_anything_to_reduce_there_is_no_share() {
        assert_eq!(tally(&[0.0; 4], &[0.0; 4]).reduction(10.0, 1), None);
        assert_eq!(tally(&[-3.0; 4], &[2.0; 4]).reduction(10.0, 1), None);
    }

    /// Blocks gain two or six nats of eight: over a hundred of them the mean share of a half has a standard error of
    /// 0.025.
    #[test]
    fn the_interval_is_that_of_resampled_blocks() {
        let gained: Vec<f64> = (0..100).map(|block| 4.0 + 2.0 * alternating(block)).collect();
        let remaining: Vec<f64> = gained.iter().map(|g| 8.0 - g).collect();
        let found = tally(&gained, &remaining).reduction(100.0, 1).expect("a gap");
        assert_eq!(found.reducible_closed, 0.5);
        let [low, high] = found.ci95;
        assert!((low - 0.451).abs() < 0.008 && (high - 0.549).abs() < 0.008, "{low} {high}");
    }

    /// All rows go 0.9 cm too far and may scatter by 1 cm; the effect is known exactly.
    #[test]
    fn an_effect_that_explains_all_leaves_nothing_of_its_channel() {
        let rows = || observations(8, 10, |_, _| Made { off: [0.9, 0.0, 0.0], ..Made::default() });
        let (baseline, rows, confirming) = (baseline(), rows(), rows());
        let context = FitContext::new(&baseline, &rows, METHOD);
        let mut found = comparison(&[&LONGER], &[10.0; 8], &context);
        found.chosen.values = vec![0.9];
        found.none = Fitted::none(&context);
        let ledger = Ledger::of(&found, &context, &confirming);
        let reduction = reduction(&found, &ledger, &context, &confirming).expect("a gap");
        let nats = log_density(0, 0.0, 1.0) - log_density(0, 0.9, 1.0);
        let Reduction { before, after, reducible_closed, .. } = reduction.whole;
        assert!((before - nats).abs() < 1e-9 && after.abs() < 1e-9 && (reducible_closed - 1.0).abs() < 1e-9);
        let channels: Vec<Channel> = reduction.channels.iter().map(|c| c.channel).collect();
        assert_eq!((channels, reduction.runner_up), (vec![Channel::Forward], None));
    }
}
