//! Evidence for an effect: residuals without and with it, by a covariate.

use serde::Serialize;

use super::profile::{Bin, FEWEST, residuals, table, unit, variables};
use crate::confirm::Confirmed;
use crate::fit::FitContext;
use mindgap_foundations::channel::Channel;
use mindgap_learning::evaluation::observations::Observation;
use mindgap_models::effects::applied::AppliedEffect;
use mindgap_models::effects::chain::EffectChain;

/// The residuals that one effect explains, by the covariate along which that shows most.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Evidence {
    /// The id of the effect.
    pub effect: String,
    /// The channel in which it shows most.
    pub channel: Channel,
    /// The covariate.
    pub depends_on: &'static str,
    /// The unit of the bins' residuals.
    pub unit: &'static str,
    /// Logged minus predicted with all other effects.
    pub without: Vec<Bin>,
    /// Logged minus predicted with all effects, in the same ranges of the covariate.
    pub with: Vec<Bin>,
    /// The range sensor concerned, where there are several.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sensor: Option<String>,
}

/// Returns the evidence for each of the chosen effects, if there are enough rows for a table.
pub fn evidence(found: &Confirmed, context: &FitContext) -> Vec<Evidence> {
    let applied = found.chosen.applied(&context.baseline().robot);
    let with = Channel::SIMULATED.map(|channel| residuals(channel, &found.chosen.effects(), context.rows));
    let of = |effect: usize| {
        let others = chain_without(&applied, effect, context);
        let best = Channel::SIMULATED.into_iter().filter_map(|channel| {
            let without = residuals(channel, &others, context.rows);
            let pairs = context.rows.rows.iter().zip(without).zip(&with[channel.index()]);
            let known: Vec<Known> = pairs.filter_map(|((row, a), b)| Some((row, [a?, (*b)?]))).collect();
            along_best_covariate(&applied[effect].effect, channel, &known)
        });
        best.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, evidence)| evidence)
    };
    (0..applied.len()).filter_map(of).collect()
}

/// A row with its residuals without and with the effect.
type Known<'r> = (&'r Observation, [f64; 2]);

/// Returns all effects but one, after those that the simulator has already.
fn chain_without(applied: &[AppliedEffect], left_out: usize, context: &FitContext) -> EffectChain {
    let mut others = applied.to_vec();
    others.remove(left_out);
    context.baseline().chain_with(&others)
}

/// Returns the tables along the covariate by which the effect reduces residuals most, with that reduction.
fn along_best_covariate(effect: &str, channel: Channel, known: &[Known]) -> Option<(f64, Evidence)> {
    if known.len() < FEWEST {
        return None;
    }
    let tables = variables(channel).iter().map(|(depends_on, value)| {
        let points = |of: usize| known.iter().map(|(row, residuals)| (value(row), residuals[of])).collect();
        let (without, with): (Vec<Bin>, Vec<Bin>) = (table(points(0)), table(points(1)));
        let reduction: f64 = without.iter().zip(&with).map(|(a, b)| reduction(a, b)).sum();
        (
            reduction,
            Evidence { effect: effect.into(), channel, depends_on, unit: unit(channel), without, with, sensor: None },
        )
    });
    tables.max_by(|a, b| a.0.total_cmp(&b.0))
}

/// Returns the reduction of a bin's squared residual, in squared standard errors.
fn reduction(without: &Bin, with: &Bin) -> f64 {
    (without.off * without.off - with.off * with.off) / (without.error * without.error).max(1e-12)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::*;

    /// The effect reduces all residuals from 1.1 to 0.01 cm.
    #[test]
    fn effect_reduces_the_residuals_that_it_predicts() {
        let observations = observations(8, 20, |_, _| Made::default());
        let rows: Vec<Known> = observations.rows.iter().map(|row| (row, [1.1, 0.01])).collect();
        let (reduction, evidence) = along_best_covariate("longer", Channel::Forward, &rows).expect("enough rows");
        assert!(reduction > 0.0 && evidence.without.len() == evidence.with.len(), "{evidence:?}");
        assert!(evidence.without.iter().all(|bin| (bin.off - 1.1).abs() < 1e-9), "{evidence:?}");
        assert!(evidence.with.iter().all(|bin| (bin.off - 0.01).abs() < 1e-9), "{evidence:?}");
        assert!(along_best_covariate("longer", Channel::Forward, &rows[..FEWEST - 1]).is_none());
    }
}
