//! Where the gap lies: the strata of rows that carry it, channel by channel.

use schemars::JsonSchema;
use serde::Serialize;

use super::covariates::{
    change, distance_cm, edge_in_beam, from_middle_cm, heading_deg, incidence_deg, reverses, seconds, speed, turning,
};
use crate::confirm::Confirmed;
use crate::explanation::Explanation;
use crate::fit::FitContext;
use crate::scores::Scores;
use crate::verdict::Verdict;
use mindgap_foundations::channel::Channel;
use mindgap_foundations::geometry::wrap_rad;
use mindgap_foundations::statistics::{bootstrap, rounding};
use mindgap_learning::evaluation::observations::Observation;

/// The part of a channel's gap that lies in one stratum of rows.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Stratum {
    /// The channel.
    pub channel: Channel,
    /// What all rows of the stratum have in common.
    pub context: &'static str,
    /// Mean gap of its rows, nats.
    #[serde(serialize_with = "rounding::number")]
    pub gap: f64,
    /// 95 % interval of the mean, by bootstrap over blocks.
    #[serde(serialize_with = "rounding::interval")]
    pub ci95: [f64; 2],
    /// Its share of the channel's gap.
    #[serde(serialize_with = "rounding::number")]
    pub share: f64,
    /// The range sensor concerned, where there are several.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sensor: Option<String>,
}

/// A name, and a test of the rows that it describes.
type Context = (&'static str, fn(&Observation) -> bool);

/// Borders of strata: round numbers near the quartiles of random driving with a small robot in a small room. The names of the
/// strata repeat them, which a test checks.
const EARLY_S: f64 = 8.0;
const LATE_S: f64 = 12.0;
const SLOW_COMMAND: f64 = 20.0;
const FAST_COMMAND: f64 = 50.0;
const LARGE_CHANGE: f64 = 50.0;
const MIDDLE_CM: f64 = 80.0;
const NEAR_CM: f64 = 30.0;
const MEDIUM_CM: f64 = 80.0;
const FAR_CM: f64 = 150.0;
const STEEP_DEG: f64 = 20.0;
const SHALLOW_DEG: f64 = 50.0;
/// A robot turns if its commands differ by more than this, and drives if their mean magnitude exceeds the other.
const TURNING_COMMAND: f64 = 15.0;
const DRIVING_COMMAND: f64 = 5.0;
/// A wall leans if the sensor meets it at more than this angle.
const LEANING_DEG: f64 = 10.0;
/// A robot moved fast if its two commands before add up to more than this.
const FAST_BOTH: f64 = 80.0;

const MOTION: &[Context] = &[
    ("elapsed time under 8 s", |r| seconds(r) < EARLY_S),
    ("elapsed time over 12 s", |r| seconds(r) >= LATE_S),
    ("slow commands, mean magnitude under 20", |r| speed(r) < SLOW_COMMAND),
    ("fast commands, mean magnitude over 50", |r| speed(r) > FAST_COMMAND),
    ("the first step of a new command", |r| change(r) > 0.0),
    ("a change of command over 50", |r| change(r) > LARGE_CHANGE),
    ("a held command", |r| change(r) == 0.0),
    ("just after a motor reverses", reverses),
    ("turning left", |r| turning(r) > TURNING_COMMAND),
    ("turning right", |r| turning(r) < -TURNING_COMMAND),
    ("going straight", |r| turning(r).abs() <= TURNING_COMMAND && speed(r) > DRIVING_COMMAND),
    ("heading within 45 degrees of 0 (along x)", |r| heading(r, 0.0)),
    ("heading within 45 degrees of 90 (along y)", |r| heading(r, 90.0)),
    ("heading within 45 degrees of 180 (against x)", |r| heading(r, 180.0)),
    ("heading within 45 degrees of -90 (against y)", |r| heading(r, -90.0)),
    ("over 80 cm from the scene's middle", |r| from_middle_cm(r) > MIDDLE_CM),
    ("within 80 cm of the scene's middle", |r| from_middle_cm(r) <= MIDDLE_CM),
    ("motors at rest", |r| speed(r) == 0.0),
];

const SONAR: &[Context] = &[
    ("distance under 30 cm", |r| faces(r, 0.0, NEAR_CM)),
    ("distance 30 to 80 cm", |r| faces(r, NEAR_CM, MEDIUM_CM)),
    ("distance 80 to 150 cm", |r| faces(r, MEDIUM_CM, FAR_CM)),
    ("distance over 150 cm", |r| faces(r, FAR_CM, f64::INFINITY)),
    ("incidence under 20 degrees", |r| incidence_deg(r).abs() < STEEP_DEG),
    ("incidence 20 to 50 degrees", |r| (STEEP_DEG..SHALLOW_DEG).contains(&incidence_deg(r).abs())),
    ("incidence over 50 degrees", |r| incidence_deg(r).abs() >= SHALLOW_DEG),
    ("walls that lean to the left", |r| incidence_deg(r) > LEANING_DEG),
    ("walls that lean to the right", |r| incidence_deg(r) < -LEANING_DEG),
    ("an edge within the beam", edge_in_beam),
    ("just after a missing reading", |r| r.context.echo_before == Some(false)),
    ("just after a reading", |r| r.context.echo_before == Some(true)),
    ("just after moving fast", |r| r.context.commands[1].iter().map(|c| c.abs()).sum::<f64>() > FAST_BOTH),
    ("elapsed time over 12 s", |r| seconds(r) >= LATE_S),
];

/// A stratum is reported if its share of the gap exceeds its share of the rows by this factor and is at least one fifth.
const LIFT: f64 = 1.15;
const LEAST_SHARE: f64 = 0.2;
/// A stratum of nearly all rows needs no lift.
const EVERYWHERE: f64 = 0.97;

/// Returns for each channel the stratum that carries most of its gap, the channel with the largest gap first.
pub fn strata(found: &Confirmed, verdict: Verdict, context: &FitContext) -> Vec<Stratum> {
    if verdict == Verdict::NoGap {
        return Vec::new();
    }
    let excess = excess(found, verdict);
    let of_channel = |channel: Channel| of_channel(channel, &excess.of(channel), context);
    let mut strata: Vec<(f64, Stratum)> = Channel::SIMULATED.into_iter().filter_map(of_channel).collect();
    strata.sort_by(|a, b| b.0.total_cmp(&a.0));
    strata.into_iter().map(|(_, stratum)| stratum).collect()
}

/// Returns the most informative stratum of a channel, with the channel's gap in nats.
fn of_channel(channel: Channel, excess: &[f64], context: &FitContext) -> Option<(f64, Stratum)> {
    let all: f64 = excess.iter().sum();
    if all < context.calibration.judgement.strong_nats {
        return None;
    }
    let contexts = if channel.motion_axis().is_some() { MOTION } else { SONAR };
    let ranked = |c: &Context| ranked(channel, c, excess, all, context);
    let carrying = contexts.iter().filter_map(ranked).filter(|r| r.carries);
    let best = carrying.max_by(|a, b| a.rank.total_cmp(&b.rank));
    best.or_else(|| ranked(&("all steps", |_| true))).map(|r| (all, r.stratum))
}

/// Returns how much more likely each row would be with the effects, or with the omnibus regression if no effect explains the gap,
/// wider noise included.
pub(super) fn excess(found: &Confirmed, verdict: Verdict) -> Scores {
    let remainders = if verdict.names_effects() { &found.beyond_chosen } else { &found.beyond_null };
    // Effects that explain too little to be named still show where the gap lies.
    let best = remainders.iter().filter(|r| r.counts()).fold(found.chosen.scores.clone(), |best, remainder| {
        best.with(remainder.channel(), &remainder.regression.cross_validated().of(remainder.channel()))
    });
    found.wider_noise.iter().fold(&best - &found.fits.null.scores, |sum, wider| &sum + &wider.gains)
}

/// A stratum that competes with others.
struct Ranked {
    rank: f64,
    /// Whether it carries more than its share of the rows.
    carries: bool,
    stratum: Stratum,
}

/// Returns `None` if a stratum has no rows.
fn ranked(channel: Channel, (context, holds): &Context, excess: &[f64], all: f64, fit: &FitContext) -> Option<Ranked> {
    let sample = fit.rows;
    let inside =
        |(row, _): &(&Observation, &f64)| holds(row) && (channel.motion_axis().is_none() || row.motion.is_some());
    let (mut gaps, mut counts) = (vec![0.0; sample.blocks], vec![0.0; sample.blocks]);
    for (row, e) in sample.rows.iter().zip(excess).filter(inside) {
        gaps[row.block] += e;
        counts[row.block] += 1.0;
    }
    let (gap, count): (f64, f64) = (gaps.iter().sum(), counts.iter().sum());
    // If the fit is worse in other strata, one can carry more than the total.
    let share = (gap / all).min(1.0);
    let of_rows = count / sample.rows.len() as f64;
    let ci95 = bootstrap::interval(&gaps, &counts, fit.seed, |gap, count| (count > 0.0).then(|| gap / count));
    let carries = of_rows > EVERYWHERE || (share > LIFT * of_rows && share > LEAST_SHARE && ci95[0] > 0.0);
    // Strata of few rows and strata of nearly all rows are less informative than those in between.
    let rank = (share - of_rows) * share;
    let stratum = Stratum { channel, context, gap: gap / count, ci95, share, sensor: None };
    (count > 0.0).then_some(Ranked { rank, carries, stratum })
}

fn heading(row: &Observation, deg: f64) -> bool {
    wrap_rad((heading_deg(row) - deg).to_radians()).abs() <= 45f64.to_radians()
}

fn faces(row: &Observation, from_cm: f64, to_cm: f64) -> bool {
    row.context.faced.is_some() && (from_cm..to_cm).contains(&distance_cm(row))
}

#[cfg(test)]
mod tests;
