//! Where the gap lies: the circumstances that carry it, channel by channel.

use super::channel::Channel;
use super::circumstances::{
    change, distance_cm, edge_in_beam, heading_deg, incidence_deg, off_middle_cm, reverses, seconds, speed, turning,
};
use super::explanation::Explanation;
use super::verdict::Verdict;
use crate::evaluation::observations::{Observation, Observations};
use crate::geometry::wrap_rad;
use crate::statistics::bootstrap;

/// The part of a channel's gap that lies in one context.
#[derive(Clone, Debug)]
pub struct Part {
    /// The channel.
    pub channel: Channel,
    /// The context, in words.
    pub context: &'static str,
    /// Nats a step in it.
    pub gap: f64,
    /// 95 % interval of that, by bootstrap over runs.
    pub ci95: [f64; 2],
    /// Its share of the channel's gap.
    pub share: f64,
}

/// A circumstance and its name.
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
    ("heading east", |r| heading(r, 0.0)),
    ("heading north", |r| heading(r, 90.0)),
    ("heading west", |r| heading(r, 180.0)),
    ("heading south", |r| heading(r, -90.0)),
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

/// So many contexts of a channel are told.
const TOLD: usize = 1;
/// A context is told when it carries so much more than its share of the steps.
const LIFT: f64 = 1.15;
/// A channel's gap below this is none, nats.
const LEAST_NATS: f64 = 8.0;

/// The contexts that carry the gap, the largest gap first; none when there is no gap.
pub fn parts(explanation: &Explanation, evidence: &Observations) -> Vec<Part> {
    let mut parts: Vec<(f64, Part)> = Vec::new();
    if explanation.verdict() == Verdict::NoGap {
        return Vec::new();
    }
    for channel in Channel::ALL {
        let excess = excess(explanation, channel);
        let all: f64 = excess.iter().sum();
        if all < LEAST_NATS {
            continue;
        }
        let contexts = if channel.motion_axis().is_some() { MOTION } else { SONAR };
        let mut found: Vec<(f64, Part)> =
            contexts.iter().filter_map(|c| part(channel, c, &excess, all, evidence)).collect();
        found.sort_by(|a, b| b.0.total_cmp(&a.0));
        if found.is_empty() {
            found.extend(part(channel, &("all steps", |_| true), &excess, all, evidence));
        }
        parts.extend(found.into_iter().take(TOLD).map(|(_, part)| (all, part)));
    }
    parts.sort_by(|a, b| b.0.total_cmp(&a.0));
    parts.into_iter().map(|(_, part)| part).collect()
}

/// By how much each row of a channel would be likelier with the effects, or with anything where no effect explains it.
fn excess(explanation: &Explanation, channel: Channel) -> Vec<f64> {
    let known = explanation.verdict() == Verdict::Known;
    let leftovers = if known { &explanation.beyond_chosen } else { &explanation.beyond_none };
    let learner = leftovers.iter().find(|l| l.channel == channel && l.counts());
    let best = match learner {
        Some(learner) => &learner.fitted,
        None if known => &explanation.chosen,
        None => &explanation.none,
    };
    let none = explanation.none.terms.channel(channel);
    best.terms.channel(channel).iter().zip(none).map(|(best, none)| best - none).collect()
}

/// A context's part with its rank, if it carries more than its share.
fn part(
    channel: Channel,
    (context, holds): &Context,
    excess: &[f64],
    all: f64,
    evidence: &Observations,
) -> Option<(f64, Part)> {
    let inside =
        |(row, _): &(&Observation, &f64)| holds(row) && (channel.motion_axis().is_none() || row.motion.is_some());
    let (mut gaps, mut counts) = (vec![0.0; evidence.blocks], vec![0.0; evidence.blocks]);
    for (row, e) in evidence.rows.iter().zip(excess).filter(inside) {
        gaps[row.block] += e;
        counts[row.block] += 1.0;
    }
    let (gap, count): (f64, f64) = (gaps.iter().sum(), counts.iter().sum());
    // Where others fit better than before, one place can carry more than is left of all.
    let share = (gap / all).min(1.0);
    let of_steps = count / evidence.rows.len() as f64;
    let ci95 = bootstrap::interval(&gaps, &counts, |gap, count| (count > 0.0).then(|| gap / count));
    let everywhere = of_steps > 0.97;
    let carries = everywhere || (share > LIFT * of_steps && share > 0.2 && ci95[0] > 0.0);
    // What is rare and heavy, and what is nearly all, both say less than what is in between.
    let rank = (share - of_steps) * share;
    (carries && count > 0.0).then(|| (rank, Part { channel, context, gap: gap / count, ci95, share }))
}

fn heading(row: &Observation, deg: f64) -> bool {
    wrap_rad((heading_deg(row) - deg).to_radians()).abs() <= 45f64.to_radians()
}

fn faces(row: &Observation, from_cm: f64, to_cm: f64) -> bool {
    row.context.faced.is_some() && (from_cm..to_cm).contains(&distance_cm(row))
}
