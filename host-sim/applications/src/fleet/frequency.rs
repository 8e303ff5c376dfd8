//! Prevalence and strength of effects in a fleet.

use schemars::JsonSchema;
use serde::Serialize;

use super::spread::{RoundedSpread, Spread};
use super::tally::{Sightings, Tally};
use mindgap_foundations::statistics::rounding;
use mindgap_models::effects::Parameter;

/// The statistics of an effect in a fleet.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Frequency {
    /// Its id.
    pub id: &'static str,
    /// Number of robots in which the effect is named.
    pub named: usize,
    /// Number of robots in whose logs the effect is testable.
    pub testable: usize,
    /// Prevalence among the testable robots, each weighted by the probability of the effect.
    #[serde(serialize_with = "rounding::number")]
    pub frequency: f64,
    /// 95 % interval of the prevalence (Wilson 1927).
    #[serde(serialize_with = "rounding::interval")]
    pub ci95: [f64; 2],
    /// Most common variant.
    pub variant: Option<&'static str>,
    /// Distributions of the parameters of that variant.
    pub strengths: Vec<Strength>,
}

/// The distribution of a parameter over robots.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Strength {
    /// Its name.
    pub parameter: &'static str,
    /// Its unit; empty for a share, a factor or a probability.
    pub unit: &'static str,
    /// Number of robots.
    pub robots: usize,
    /// Distribution over these robots.
    #[serde(flatten)]
    pub spread: RoundedSpread,
}

/// Half-width of the 95 % interval of a normal distribution, in standard deviations.
const WITHIN: f64 = 1.96;

/// Returns every named effect, most frequent first.
pub fn frequencies(tally: &Tally) -> Vec<Frequency> {
    let all = tally.parts.iter().zip(&tally.sightings).enumerate();
    let mut frequencies: Vec<Frequency> =
        all.filter(|(_, (_, seen))| seen.named > 0).map(|(part, (id, seen))| of(id, seen, part, tally)).collect();
    frequencies.sort_by(|a, b| b.frequency.total_cmp(&a.frequency).then(a.id.cmp(b.id)));
    frequencies
}

fn of(id: &'static str, seen: &Sightings, part: usize, tally: &Tally) -> Frequency {
    let main = seen.main_form();
    let strengths = main.zip(tally.catalogue.get(part)).and_then(|((form, robots), effect)| {
        let variant = effect.variants.iter().find(|variant| variant.id == form)?;
        let strength = |(place, parameter): (usize, &Parameter)| {
            let spread = Spread::of(robots.iter().map(|(_, values)| values[place]).collect())?;
            Some(Strength {
                parameter: parameter.name,
                unit: parameter.unit,
                robots: spread.n,
                spread: spread.rounded(),
            })
        };
        Some(variant.parameters.iter().enumerate().filter_map(strength).collect())
    });
    // An effect may be named although it is listed as untestable: such robots count as testable.
    let testable = seen.testable.max(seen.named);
    Frequency {
        id,
        named: seen.named,
        testable,
        frequency: seen.expected / testable as f64,
        ci95: wilson(seen.expected, testable as f64),
        variant: main.map(|(form, _)| form),
        strengths: strengths.unwrap_or_default(),
    }
}

/// Returns Wilson's 95 % interval of a proportion of which `k` of `n` were observed.
fn wilson(k: f64, n: f64) -> [f64; 2] {
    let (share, square) = (k / n, WITHIN * WITHIN);
    let middle = (share + 0.5 * square / n) / (1.0 + square / n);
    let half = WITHIN / (1.0 + square / n) * (share * (1.0 - share) / n + 0.25 * square / (n * n)).sqrt();
    [(middle - half).max(0.0), (middle + half).min(1.0)]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Newcombe 1998, Statistics in Medicine 17, table I, method 3.
    #[test]
    fn wilson_intervals_match_published_table() {
        for (k, n, expected) in
            [(81.0, 263.0, [0.2553, 0.3662]), (15.0, 148.0, [0.0624, 0.1605]), (0.0, 20.0, [0.0, 0.1611])]
        {
            let found = wilson(k, n);
            assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-4), "{k} of {n}: {found:?}");
        }
    }
}
