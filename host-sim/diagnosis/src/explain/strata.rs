//! Where the gap lies: the strata of rows that carry it, channel by channel.

use serde::Serialize;

use super::Judged;
use super::covariates::{
    change, distance_cm, edge_in_beam, heading_deg, incidence_deg, off_middle_cm, reverses, seconds, speed, turning,
};
use crate::channel::Channel;
use crate::compare::Comparison;
use crate::fit::FitContext;
use mindgap_foundations::geometry::wrap_rad;
use mindgap_foundations::statistics::{bootstrap, rounding};
use mindgap_learning::evaluation::observations::Observation;

/// The part of a channel's gap that lies in one stratum of rows.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Stratum {
    /// The channel.
    pub channel: Channel,
    /// The circumstances that all rows of the stratum share.
    pub context: &'static str,
    /// Nats a row of it.
    #[serde(serialize_with = "rounding::number")]
    pub gap: f64,
    /// 95 % interval of that, by bootstrap over blocks of runs.
    #[serde(serialize_with = "rounding::interval")]
    pub ci95: [f64; 2],
    /// Its share of the channel's gap.
    #[serde(serialize_with = "rounding::number")]
    pub share: f64,
}

/// A name, and the rows that it holds for. Borders are round numbers near the quartiles of random driving.
type Context = (&'static str, fn(&Observation) -> bool);

const MOTION: &[Context] = &[
    ("elapsed time under 8 s", |r| seconds(r) < 8.0),
    ("elapsed time over 12 s", |r| seconds(r) >= 12.0),
    ("slow commands, mean magnitude under 20", |r| speed(r) < 20.0),
    ("fast commands, mean magnitude over 50", |r| speed(r) > 50.0),
    ("the first step of a new command", |r| change(r) > 0.0),
    ("a change of command over 50", |r| change(r) > 50.0),
    ("a held command", |r| change(r) == 0.0),
    ("just after a motor reverses", reverses),
    ("turning left", |r| turning(r) > 15.0),
    ("turning right", |r| turning(r) < -15.0),
    ("going straight", |r| turning(r).abs() <= 15.0 && speed(r) > 5.0),
    ("heading within 45 degrees of 0 (along x)", |r| heading(r, 0.0)),
    ("heading within 45 degrees of 90 (along y)", |r| heading(r, 90.0)),
    ("heading within 45 degrees of 180 (against x)", |r| heading(r, 180.0)),
    ("heading within 45 degrees of -90 (against y)", |r| heading(r, -90.0)),
    ("over 80 cm from the scene's middle", |r| off_middle_cm(r) > 80.0),
    ("within 80 cm of the scene's middle", |r| off_middle_cm(r) <= 80.0),
    ("motors at rest", |r| speed(r) == 0.0),
];

const SONAR: &[Context] = &[
    ("distance under 30 cm", |r| faces(r, 0.0, 30.0)),
    ("distance 30 to 80 cm", |r| faces(r, 30.0, 80.0)),
    ("distance 80 to 150 cm", |r| faces(r, 80.0, 150.0)),
    ("distance over 150 cm", |r| faces(r, 150.0, f64::INFINITY)),
    ("incidence under 20 degrees", |r| incidence_deg(r).abs() < 20.0),
    ("incidence 20 to 50 degrees", |r| (20.0..50.0).contains(&incidence_deg(r).abs())),
    ("incidence over 50 degrees", |r| incidence_deg(r).abs() >= 50.0),
    ("walls that lean to the left", |r| incidence_deg(r) > 10.0),
    ("walls that lean to the right", |r| incidence_deg(r) < -10.0),
    ("an edge within the beam", edge_in_beam),
    ("just after a missing reading", |r| r.context.echo_before == Some(false)),
    ("just after a reading", |r| r.context.echo_before == Some(true)),
    ("just after moving fast", |r| r.context.commands[1].iter().map(|c| c.abs()).sum::<f64>() > 80.0),
    ("elapsed time over 12 s", |r| seconds(r) >= 12.0),
];

/// A stratum is told when it carries a seventh more than its share of the rows, and a fifth of the gap at least.
const LIFT: f64 = 1.15;
const LEAST_SHARE: f64 = 0.2;
/// A stratum that holds for nearly all rows needs no lift.
const EVERYWHERE: f64 = 0.97;

/// The stratum of each channel that carries most of its gap, the channel with the largest gap first; none when there is
/// no gap.
pub fn strata(found: &Comparison, judged: &Judged, context: &FitContext) -> Vec<Stratum> {
    if matches!(judged, Judged::NoGap) {
        return Vec::new();
    }
    let known = matches!(judged, Judged::Known { .. } | Judged::PartlyKnown { .. });
    let mut told: Vec<(f64, Stratum)> =
        Channel::ALL.into_iter().filter_map(|channel| of_channel(channel, found, known, context)).collect();
    told.sort_by(|a, b| b.0.total_cmp(&a.0));
    told.into_iter().map(|(_, stratum)| stratum).collect()
}

/// The stratum that says most of a channel, with the channel's gap in nats.
fn of_channel(channel: Channel, found: &Comparison, known: bool, context: &FitContext) -> Option<(f64, Stratum)> {
    let excess = excess(found, known, channel, context);
    let all: f64 = excess.iter().sum();
    if all < context.calibration.judgement.strong_nats {
        return None;
    }
    let contexts = if channel.motion_axis().is_some() { MOTION } else { SONAR };
    let ranked = |c: &Context| ranked(channel, c, &excess, all, context);
    let carrying = contexts.iter().filter_map(ranked).filter(|r| r.carries);
    let best = carrying.max_by(|a, b| a.rank.total_cmp(&b.rank));
    best.or_else(|| ranked(&("all steps", |_| true))).map(|r| (all, r.stratum))
}

/// By how much each row of a channel would be likelier with the effects, or with anything where no effect explains it,
/// wider scatter included.
pub(super) fn excess(found: &Comparison, known: bool, channel: Channel, context: &FitContext) -> Vec<f64> {
    let remainders = if known { &found.beyond_chosen } else { &found.beyond_none };
    let remainder = remainders.iter().find(|r| r.channel() == channel && r.counts());
    let none = found.none.log_likelihood.channel(channel);
    // Effects that explain too little to be named still show where the gap lies.
    let best = remainder.map_or_else(|| found.chosen.log_likelihood.channel(channel), |r| r.model.held_out.clone());
    let mut excess: Vec<f64> = best.iter().zip(&none).map(|(best, none)| best - none).collect();
    let scatter = found.scatter.iter().find(|wider| channel.motion_axis() == Some(wider.axis));
    let rest = found.beyond_chosen.iter().find(|r| r.channel() == channel);
    if let (Some(wider), Some(rest)) = (scatter, rest.and_then(|r| r.rest(context.observations, context))) {
        excess.iter_mut().zip(wider.gains(&rest, context.observations)).for_each(|(e, gain)| *e += gain);
    }
    excess
}

/// A stratum among others.
struct Ranked {
    rank: f64,
    /// Whether it carries more than its share.
    carries: bool,
    stratum: Stratum,
}

/// None where a stratum has no rows.
fn ranked(channel: Channel, (context, holds): &Context, excess: &[f64], all: f64, fit: &FitContext) -> Option<Ranked> {
    let observations = fit.observations;
    let inside =
        |(row, _): &(&Observation, &f64)| holds(row) && (channel.motion_axis().is_none() || row.motion.is_some());
    let (mut gaps, mut counts) = (vec![0.0; observations.blocks], vec![0.0; observations.blocks]);
    for (row, e) in observations.rows.iter().zip(excess).filter(inside) {
        gaps[row.block] += e;
        counts[row.block] += 1.0;
    }
    let (gap, count): (f64, f64) = (gaps.iter().sum(), counts.iter().sum());
    // Where others fit better than before, one stratum can carry more than is left of all.
    let share = (gap / all).min(1.0);
    let of_rows = count / observations.rows.len() as f64;
    let ci95 = bootstrap::interval(&gaps, &counts, fit.seed, |gap, count| (count > 0.0).then(|| gap / count));
    let carries = of_rows > EVERYWHERE || (share > LIFT * of_rows && share > LEAST_SHARE && ci95[0] > 0.0);
    // What is rare and heavy, and what is nearly all, both say less than what is in between.
    let rank = (share - of_rows) * share;
    let stratum = Stratum { channel, context, gap: gap / count, ci95, share };
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
