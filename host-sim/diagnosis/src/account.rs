//! Gap reduction: how much of the gap the named effects close, by channel, on held-out rows.

use schemars::JsonSchema;
use serde::Serialize;

use super::budget::{Budget, budget};
use super::confirm::Confirmed;
use super::fit::FitContext;
use super::gap_parts::GapParts;
use super::outliers::Outliers;
use super::sample::RowSet;
use mindgap_foundations::channel::Channel;
use mindgap_foundations::statistics::{bootstrap, rounding};
use mindgap_learning::evaluation::paths::PathError;

/// The size of a gap, its parts, and its reduction by the named effects.
#[derive(Clone, Debug)]
pub struct Account {
    /// Its reduction, or `None` if these rows show no reducible gap.
    pub reduction: Option<GapReduction>,
    /// Its parts.
    pub budget: Budget,
    /// The reducible gap per block, in nats.
    pub reducible: Vec<f64>,
}

/// A gap in nats per step: how much more likely the logs could be.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct GapReduction {
    /// All channels together.
    #[serde(flatten)]
    pub whole: Reduction,
    /// Always zero: gaps are measured relative to what no covariate can reduce.
    pub floor: f64,
    /// The second best explanation.
    pub runner_up: Option<RunnerUp>,
    /// The channels with a gap that can be reduced.
    pub channels: Vec<ChannelReduction>,
    /// Errors of open-loop paths from logged poses.
    pub paths: Vec<PathError>,
}

/// Reduction of a gap, in nats per step.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Reduction {
    /// The gap of the simulator as it is, nats per step.
    #[serde(serialize_with = "rounding::number")]
    pub before: f64,
    /// The gap with the effects, nats per step.
    #[serde(serialize_with = "rounding::number")]
    pub after: f64,
    /// The fraction of the reducible gap that is closed; null without effects.
    #[serde(serialize_with = "rounding::optional")]
    pub reducible_closed: Option<f64>,
    /// 95 % interval of that fraction, by bootstrap over blocks; null without effects.
    #[serde(serialize_with = "rounding::optional_interval")]
    pub ci95: Option<[f64; 2]>,
}

/// Reduction of the gap in a channel.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct ChannelReduction {
    /// The channel.
    pub channel: Channel,
    /// The reduction.
    #[serde(flatten)]
    pub reduction: Reduction,
    /// The range sensor concerned, where there are several.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sensor: Option<String>,
}

/// The second best explanation.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct RunnerUp {
    /// The ids of its effects, joined by `+`.
    pub id: String,
    /// The fraction of the reducible gap that it closes.
    #[serde(serialize_with = "rounding::number")]
    pub reducible_closed: f64,
}

/// Nats per block: the gain of the effects, and what the omnibus regression gains beyond them.
struct Tally {
    gained: Vec<f64>,
    remaining: Vec<f64>,
}

/// Accounts for a gap on some rows. Effects that are not among the `named` count as unexplained.
pub fn account(found: &Confirmed, named: &[&'static str], context: &FitContext, rows: RowSet) -> Account {
    let gap = GapParts::of(found, rows);
    let budget = budget(named, &gap, context.seed);
    Account { reduction: reduction(found, &gap, context, rows), budget, reducible: gap.reducible() }
}

/// Returns `None` if these rows show no reducible gap.
fn reduction(found: &Confirmed, gap: &GapParts, context: &FitContext, rows: RowSet) -> Option<GapReduction> {
    let seed = context.seed;
    let gained = gap.gained();
    let tally = |channels: &[Channel]| Tally {
        gained: gained.only(channels).by_block(),
        remaining: gap.unexplained.only(channels).by_block(),
    };
    let steps = rows.sample().rows.len() as f64;
    let all = tally(&Channel::ALL);
    let whole = all.reduction(steps, seed)?;
    let channel = |channel: Channel| {
        let tally = tally(&[channel]);
        let is_plain = tally.reducible() >= context.calibration.judgement.strong_nats;
        Some(ChannelReduction { channel, reduction: tally.reduction(steps, seed).filter(|_| is_plain)?, sensor: None })
    };
    let runner_up = found.runner_up().map(|fit| {
        let gained = gap.gained_by(fit, found, rows.sample());
        RunnerUp { id: fit.ids().join("+"), reducible_closed: gained / all.reducible() }
    });
    let paths = found.paths.iter().map(|paths| paths.error).collect();
    let channels = Channel::ALL.into_iter().filter_map(channel).collect();
    Some(GapReduction { whole, floor: 0.0, runner_up, channels, paths })
}

impl GapReduction {
    /// No gap that could be reduced.
    pub const NONE: GapReduction = GapReduction {
        whole: Reduction { before: 0.0, after: 0.0, reducible_closed: None, ci95: None },
        floor: 0.0,
        runner_up: None,
        channels: Vec::new(),
        paths: Vec::new(),
    };

    /// The gap of outliers alone, which no effect reduces; `None` without any.
    pub fn of_outliers(outliers: &[Outliers], rows: usize) -> Option<Self> {
        let nats: f64 = outliers.iter().map(|of| of.nats).sum();
        let per_step = nats / rows.max(1) as f64;
        let whole = Reduction { before: per_step, after: per_step, ..GapReduction::NONE.whole };
        (!outliers.is_empty()).then_some(GapReduction { whole, ..GapReduction::NONE })
    }
}

impl Tally {
    fn reducible(&self) -> f64 {
        self.gained.iter().sum::<f64>() + self.remaining.iter().sum::<f64>().max(0.0)
    }

    fn reduction(&self, steps: f64, seed: u64) -> Option<Reduction> {
        let (gained, reducible) = (self.gained.iter().sum::<f64>(), self.reducible());
        let has_effects = self.gained.iter().any(|nats| *nats != 0.0);
        (reducible > 0.0).then(|| Reduction {
            before: reducible / steps,
            after: (reducible - gained) / steps,
            reducible_closed: has_effects.then_some(gained / reducible),
            ci95: has_effects.then(|| self.interval(seed)),
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
    use crate::noise_model::log_density;
    use crate::sample::HoldOut;
    use crate::test_support::*;

    fn tally(gained: &[f64], remaining: &[f64]) -> Tally {
        Tally { gained: gained.to_vec(), remaining: remaining.to_vec() }
    }

    /// Every block gains six nats of eight: every resample of blocks closes three quarters.
    #[test]
    fn closed_fraction_is_gain_over_reducible_gap() {
        let found = tally(&[6.0; 4], &[2.0; 4]).reduction(16.0, 1).expect("a gap");
        assert_eq!(found, Reduction { before: 2.0, after: 0.5, reducible_closed: Some(0.75), ci95: Some([0.75; 2]) });
    }

    #[test]
    fn negative_remaining_gain_counts_as_zero() {
        let found = tally(&[6.0; 4], &[-2.0; 4]).reduction(24.0, 1).expect("a gap");
        assert_eq!((found.before, found.after, found.reducible_closed), (1.0, 0.0, Some(1.0)));
    }

    #[test]
    fn gap_without_effects_is_as_large_afterwards() {
        let found = tally(&[0.0; 4], &[2.0; 4]).reduction(16.0, 1).expect("a gap");
        assert_eq!(found, Reduction { before: 0.5, after: 0.5, reducible_closed: None, ci95: None });
    }

    #[test]
    fn no_reducible_gap_has_no_reduction() {
        assert_eq!(tally(&[0.0; 4], &[0.0; 4]).reduction(10.0, 1), None);
        assert_eq!(tally(&[-3.0; 4], &[2.0; 4]).reduction(10.0, 1), None);
    }

    /// Blocks gain two or six nats of eight: over a hundred blocks the mean fraction of one half has a standard error of 0.025.
    #[test]
    fn interval_is_that_of_resampled_blocks() {
        let gained: Vec<f64> = (0..100).map(|block| 4.0 + 2.0 * alternating(block)).collect();
        let remaining: Vec<f64> = gained.iter().map(|g| 8.0 - g).collect();
        let found = tally(&gained, &remaining).reduction(100.0, 1).expect("a gap");
        assert_eq!(found.reducible_closed, Some(0.5));
        let [low, high] = found.ci95.expect("an interval");
        assert!((low - 0.451).abs() < 0.008 && (high - 0.549).abs() < 0.008, "{low} {high}");
    }

    /// All rows go 0.9 cm too far with noise of 1 cm, and the effect is known exactly.
    #[test]
    fn effect_that_explains_everything_leaves_nothing_of_its_channel() {
        let rows = || observations(8, 10, |_, _| Made { off: [0.9, 0.0, 0.0], ..Made::default() });
        let baseline = baseline();
        let (found_on, held_out) = (identification(&baseline, rows()), HoldOut::new(&baseline, rows()));
        let context = FitContext::new(&found_on, METHOD);
        let mut found = confirmed(&[&LONGER], &[10.0; 8], &context);
        found.chosen.values = vec![0.9];
        found.fits.null = Fitted::null(&context);
        let rows = RowSet::HeldOut(&held_out);
        let gap = GapParts::of(&found, rows);
        let reduction = reduction(&found, &gap, &context, rows).expect("a gap");
        let nats = log_density(0, 0.0, 1.0) - log_density(0, 0.9, 1.0);
        let Reduction { before, after, reducible_closed, .. } = reduction.whole;
        assert!(
            (before - nats).abs() < 1e-9
                && after.abs() < 1e-9
                && reducible_closed.is_some_and(|closed| (closed - 1.0).abs() < 1e-9)
        );
        let channels: Vec<Channel> = reduction.channels.iter().map(|c| c.channel).collect();
        assert_eq!((channels, reduction.runner_up), (vec![Channel::Forward], None));
    }
}
