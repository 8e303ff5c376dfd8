//! What the unexplained part of a gap depends on, and how: a small table for each channel.

use serde::Serialize;

use super::covariates as of;
use crate::channel::Channel;
use crate::compare::Comparison;
use crate::fit::FitContext;
use mindgap_foundations::statistics::rounding;
use mindgap_learning::evaluation::observations::{Observation, Observations};
use mindgap_learning::evaluation::predictions::{facing, residual};
use mindgap_models::effects::chain::EffectChain;
use mindgap_models::simulator::baseline::Baseline;

/// How the unexplained part of a channel follows one covariate.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ResidualProfile {
    /// The channel.
    pub channel: Channel,
    /// The covariate on which it depends most.
    pub depends_on: &'static str,
    /// The unit of [`Bin::off`].
    pub unit: &'static str,
    /// From low to high.
    #[serde(rename = "shape")]
    pub bins: Vec<Bin>,
}

/// A range of the covariate.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Bin {
    /// Least value.
    #[serde(serialize_with = "rounding::number")]
    pub from: f64,
    /// Largest value.
    #[serde(serialize_with = "rounding::number")]
    pub to: f64,
    /// Logged minus predicted, mean.
    #[serde(serialize_with = "rounding::number")]
    pub off: f64,
    /// Standard error of that.
    #[serde(serialize_with = "rounding::number")]
    pub error: f64,
}

/// A covariate and its name.
pub(super) type Variable = (&'static str, fn(&Observation) -> f64);

const MOTION: &[Variable] = &[
    ("mean command", of::driving),
    ("right minus left command", of::turning),
    ("change of command", of::change),
    ("heading (deg)", of::heading_deg),
    ("elapsed time (s)", of::seconds),
    ("x (cm)", of::x_cm),
    ("y (cm)", of::y_cm),
    ("distance from the scene's middle (cm)", of::off_middle_cm),
];
const SONAR: &[Variable] = &[
    ("distance D (cm)", of::distance_cm),
    ("signed incidence (deg)", of::incidence_deg),
    ("reading before (0 none, 1 some)", of::echo_before),
    ("elapsed time (s)", of::seconds),
    ("heading (deg)", of::heading_deg),
    ("x (cm)", of::x_cm),
    ("y (cm)", of::y_cm),
    ("mean command", of::driving),
];
/// Bins of a table: enough for a bend and a wave.
const BINS: usize = 5;
/// Fewer rows make no table: ten a bin.
pub(super) const FEWEST: usize = 10 * BINS;
/// A reading that is farther off is of something else, and says nothing about readings.
const FAR_OFF_CM: f64 = 25.0;

/// A table for each channel in which something is unexplained.
pub fn profiles(found: &Comparison, context: &FitContext) -> Vec<ResidualProfile> {
    let left = found.beyond_chosen.iter().filter(|r| r.counts());
    let effects = found.chosen.effects();
    left.filter_map(|r| profile(r.channel(), &effects, context.baseline, context.observations)).collect()
}

fn profile(
    channel: Channel,
    effects: &EffectChain,
    baseline: &Baseline,
    observations: &Observations,
) -> Option<ResidualProfile> {
    let off = off(channel, effects, baseline, observations);
    let known: Vec<(&Observation, f64)> =
        observations.rows.iter().zip(off).filter_map(|(row, off)| Some((row, off?))).collect();
    if known.len() < FEWEST {
        return None;
    }
    let tables = variables(channel).iter().map(|(name, value)| {
        let points: Vec<(f64, f64)> = known.iter().map(|(row, off)| (value(row), *off)).collect();
        (*name, table(points))
    });
    let (depends_on, bins) = tables.max_by(|a, b| strength(&a.1).total_cmp(&strength(&b.1)))?;
    Some(ResidualProfile { channel, depends_on, unit: unit(channel), bins })
}

/// The covariates that a channel may follow.
pub(super) fn variables(channel: Channel) -> &'static [Variable] {
    if channel.motion_axis().is_some() { MOTION } else { SONAR }
}

/// The unit of a channel's residuals.
pub(super) fn unit(channel: Channel) -> &'static str {
    match channel {
        Channel::Forward | Channel::Lateral | Channel::EchoValue => "cm",
        Channel::Turn => "deg",
        Channel::EchoRate => "share of rows with a reading",
    }
}

/// Logged minus predicted with these effects for every row that says something.
pub(super) fn off(
    channel: Channel,
    effects: &EffectChain,
    baseline: &Baseline,
    observations: &Observations,
) -> Vec<Option<f64>> {
    let rows = &observations.rows;
    match (channel.motion_axis(), &baseline.motion, &baseline.sonar) {
        (Some(axis), Some(drive), _) => {
            let residuals: Vec<_> = rows.iter().map(|row| residual(effects, drive, row)).collect();
            let scale = if channel == Channel::Turn { 180.0 / std::f64::consts::PI } else { 1.0 };
            residuals.into_iter().map(|r| r.map(|r| scale * r[axis])).collect()
        }
        (None, _, Some(_)) => {
            let one = |row: &Observation| {
                let outcomes = facing(effects, observations, row)?.outcomes();
                if channel == Channel::EchoRate {
                    return Some(f64::from(u8::from(row.echo_cm.is_some())) - 1.0 + outcomes.none);
                }
                outcomes.off_cm(row.echo_cm).filter(|off| off.abs() < FAR_OFF_CM)
            };
            rows.iter().map(one).collect()
        }
        _ => vec![None; rows.len()],
    }
}

/// Bins of about equally many points.
pub(super) fn table(mut points: Vec<(f64, f64)>) -> Vec<Bin> {
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut bins: Vec<Bin> = Vec::new();
    let mut rest = points.as_slice();
    for left in (1..=BINS).rev() {
        let Some((last, _)) = rest.get((rest.len() / left).max(1) - 1) else { break };
        let (here, others) = rest.split_at(rest.partition_point(|(value, _)| value <= last));
        rest = others;
        let n = here.len() as f64;
        let mean = here.iter().map(|p| p.1).sum::<f64>() / n;
        let variance = here.iter().map(|p| (p.1 - mean) * (p.1 - mean)).sum::<f64>() / (n - 1.0).max(1.0);
        bins.push(Bin { from: here[0].0, to: *last, off: mean, error: (variance / n).sqrt() });
    }
    bins
}

/// How plainly a table departs from one value: chi-squared beyond what as many bins show by chance.
fn strength(bins: &[Bin]) -> f64 {
    let weight = |b: &Bin| 1.0 / (b.error * b.error).max(1e-12);
    let total: f64 = bins.iter().map(weight).sum();
    let mean = bins.iter().map(|b| weight(b) * b.off).sum::<f64>() / total;
    bins.iter().map(|b| weight(b) * (b.off - mean) * (b.off - mean)).sum::<f64>() - (bins.len() as f64 - 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_follows_what_it_depends_on() {
        let points = |slope: f64| (0..500).map(|i| (f64::from(i), slope * f64::from(i) + f64::from(i % 7))).collect();
        let (steep, flat) = (table(points(0.1)), table(points(0.0)));
        assert_eq!(steep.len(), BINS);
        assert!(steep.windows(2).all(|pair| pair[0].to < pair[1].from && pair[0].off < pair[1].off));
        assert!(strength(&steep) > 100.0 && strength(&flat) < 10.0);
    }

    #[test]
    fn what_has_two_values_gets_two_bins() {
        let points = (0..100).map(|i| (f64::from(i % 2), f64::from(i % 3))).collect();
        assert_eq!(table(points).len(), 2);
    }
}
