//! What the unexplained part of a gap depends on: a small table for each channel.

use schemars::JsonSchema;
use serde::Serialize;

use super::covariates as of;
use crate::confirm::Confirmed;
use crate::fit::FitContext;
use crate::sample::Sample;
use mindgap_foundations::channel::Channel;
use mindgap_foundations::statistics::rounding;
use mindgap_learning::evaluation::observations::Observation;
use mindgap_learning::evaluation::predictions::facing;
use mindgap_models::effects::chain::EffectChain;

/// The residual of a channel by one covariate.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct ResidualProfile {
    /// The channel.
    pub channel: Channel,
    /// The covariate on which the residual depends most.
    pub depends_on: &'static str,
    /// The unit of the residual.
    pub unit: &'static str,
    /// The mean residual in ranges of the covariate, from low to high.
    #[serde(rename = "shape")]
    pub bins: Vec<Bin>,
    /// The range sensor concerned, where there are several.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sensor: Option<String>,
}

/// A range of the covariate.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Bin {
    /// Lower end.
    #[serde(serialize_with = "rounding::number")]
    pub from: f64,
    /// Upper end.
    #[serde(serialize_with = "rounding::number")]
    pub to: f64,
    /// Mean of logged minus predicted.
    #[serde(serialize_with = "rounding::number")]
    pub off: f64,
    /// Standard error of the mean.
    #[serde(serialize_with = "rounding::number")]
    pub error: f64,
}

/// The name of a covariate, and its value for a row.
pub(super) type Variable = (&'static str, fn(&Observation) -> f64);

const MOTION: &[Variable] = &[
    ("mean command", of::driving),
    ("right minus left command", of::turning),
    ("change of command", of::change),
    ("heading (deg)", of::heading_deg),
    ("elapsed time (s)", of::seconds),
    ("x (cm)", of::x_cm),
    ("y (cm)", of::y_cm),
    ("distance from the scene's middle (cm)", of::from_middle_cm),
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
/// Number of bins: enough for a bend and a wave.
const BINS: usize = 5;
/// Least number of rows for a table: ten per bin.
pub(super) const FEWEST: usize = 10 * BINS;
/// Readings with larger residuals are echoes of something else and are left out, cm.
const FAR_OFF_CM: f64 = 25.0;

/// Returns a table for each channel with a structured residual.
pub fn profiles(found: &Confirmed, context: &FitContext) -> Vec<ResidualProfile> {
    let effects = found.chosen.effects();
    let unexplained = found.beyond_chosen.iter().filter(|r| r.counts());
    unexplained.filter_map(|r| profile(r.channel(), &effects, context.rows)).collect()
}

fn profile(channel: Channel, effects: &EffectChain, sample: &Sample) -> Option<ResidualProfile> {
    let residuals = sample.rows.iter().zip(residuals(channel, effects, sample));
    let known: Vec<(&Observation, f64)> = residuals.filter_map(|(row, residual)| Some((row, residual?))).collect();
    if known.len() < FEWEST {
        return None;
    }
    let tables = variables(channel).iter().map(|(name, value)| {
        let points: Vec<(f64, f64)> = known.iter().map(|(row, residual)| (value(row), *residual)).collect();
        (*name, table(points))
    });
    let (depends_on, bins) = tables.max_by(|a, b| strength(&a.1).total_cmp(&strength(&b.1)))?;
    Some(ResidualProfile { channel, depends_on, unit: unit(channel), bins, sensor: None })
}

/// Returns the covariates on which a channel may depend.
pub(super) fn variables(channel: Channel) -> &'static [Variable] {
    if channel.motion_axis().is_some() { MOTION } else { SONAR }
}

/// Returns the unit of a channel's residuals.
pub(super) fn unit(channel: Channel) -> &'static str {
    match channel {
        Channel::Turn | Channel::Gyro => "deg",
        Channel::EchoRate => "share of rows with a reading",
        _ => "cm",
    }
}

/// Returns logged minus predicted with these effects for every row.
pub(super) fn residuals(channel: Channel, effects: &EffectChain, sample: &Sample) -> Vec<Option<f64>> {
    match (channel.motion_axis(), &sample.baseline.sonar) {
        (Some(axis), _) => {
            let scale = if channel == Channel::Turn { 180.0 / std::f64::consts::PI } else { 1.0 };
            sample.residuals(effects).into_iter().map(|r| r.map(|r| scale * r[axis])).collect()
        }
        (None, Some(_)) => {
            let one = |row: &Observation| {
                let outcomes = facing(effects, sample, row)?.outcomes();
                if channel == Channel::EchoRate {
                    return Some(f64::from(u8::from(row.echo_cm.is_some())) - 1.0 + outcomes.none);
                }
                outcomes.off_cm(row.echo_cm).filter(|cm| cm.abs() < FAR_OFF_CM)
            };
            sample.rows.iter().map(one).collect()
        }
        (None, None) => vec![None; sample.rows.len()],
    }
}

/// Divides points into bins of about equal size.
pub(super) fn table(mut points: Vec<(f64, f64)>) -> Vec<Bin> {
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut bins: Vec<Bin> = Vec::new();
    let mut remaining = points.as_slice();
    for bins_left in (1..=BINS).rev() {
        let Some((last, _)) = remaining.get((remaining.len() / bins_left).max(1) - 1) else { break };
        let (here, others) = remaining.split_at(remaining.partition_point(|(value, _)| value <= last));
        remaining = others;
        let n = here.len() as f64;
        let mean = here.iter().map(|p| p.1).sum::<f64>() / n;
        let variance = here.iter().map(|p| (p.1 - mean) * (p.1 - mean)).sum::<f64>() / (n - 1.0).max(1.0);
        bins.push(Bin { from: here[0].0, to: *last, off: mean, error: (variance / n).sqrt() });
    }
    bins
}

/// Returns how clearly a table departs from a constant: chi-squared less its expectation.
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
    fn table_follows_a_slope() {
        let points = |slope: f64| (0..500).map(|i| (f64::from(i), slope * f64::from(i) + f64::from(i % 7))).collect();
        let (steep, flat) = (table(points(0.1)), table(points(0.0)));
        assert_eq!(steep.len(), BINS);
        assert!(steep.windows(2).all(|pair| pair[0].to < pair[1].from && pair[0].off < pair[1].off));
        assert!(strength(&steep) > 100.0 && strength(&flat) < 10.0);
    }

    #[test]
    fn covariate_with_two_values_has_two_bins() {
        let points = (0..100).map(|i| (f64::from(i % 2), f64::from(i % 3))).collect();
        assert_eq!(table(points).len(), 2);
    }
}
