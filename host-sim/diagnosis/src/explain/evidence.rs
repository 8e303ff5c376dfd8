//! The evidence for an effect: what it predicts against what was logged, before and after.

use serde::Serialize;

use super::profile::{Bin, FEWEST, off, table, unit, variables};
use crate::channel::Channel;
use crate::compare::Comparison;
use crate::fit::FitContext;
use mindgap_learning::evaluation::observations::Observation;
use mindgap_models::effects::applied::AppliedEffect;
use mindgap_models::effects::chain::EffectChain;

/// What one effect explains, along the covariate where that shows most.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Evidence {
    /// Its id.
    pub effect: String,
    /// The channel in which it shows most.
    pub channel: Channel,
    /// The covariate.
    pub depends_on: &'static str,
    /// The unit of the bins' `off`.
    pub unit: &'static str,
    /// Logged minus predicted without this effect, the others left in.
    pub without: Vec<Bin>,
    /// Logged minus predicted with it, in the same ranges of the covariate.
    pub with: Vec<Bin>,
}

/// The evidence for each of the chosen effects; none of one whose rows are too few for a table.
pub fn evidence(found: &Comparison, context: &FitContext) -> Vec<Evidence> {
    let applied = found.chosen.applied();
    let residuals = |channel, effects: &EffectChain| off(channel, effects, context.baseline, context.observations);
    let with = Channel::ALL.map(|channel| residuals(channel, &found.chosen.effects()));
    let of = |place: usize| {
        let others = chain_without(&applied, place, context);
        let best = Channel::ALL.into_iter().filter_map(|channel| {
            let without = residuals(channel, &others);
            let pairs = context.observations.rows.iter().zip(without).zip(&with[channel.index()]);
            let known: Vec<Known> = pairs.filter_map(|((row, a), b)| Some((row, [a?, (*b)?]))).collect();
            along_best_covariate(&applied[place].effect, channel, &known)
        });
        best.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, evidence)| evidence)
    };
    (0..applied.len()).filter_map(of).collect()
}

/// A row, and what was logged of it minus what is predicted without the effect and with it.
type Known<'r> = (&'r Observation, [f64; 2]);

/// The effects of a fit except one, behind those that the simulator has.
fn chain_without(applied: &[AppliedEffect], place: usize, context: &FitContext) -> EffectChain {
    let others = applied.iter().enumerate().filter(|(other, _)| *other != place).map(|(_, effect)| effect);
    EffectChain::of(&context.baseline.applied.iter().chain(others).cloned().collect::<Vec<_>>())
}

/// The tables along the covariate where the effect brings predictions nearest to what was logged, and by how much.
fn along_best_covariate(effect: &str, channel: Channel, known: &[Known]) -> Option<(f64, Evidence)> {
    if known.len() < FEWEST {
        return None;
    }
    let tables = variables(channel).iter().map(|(depends_on, value)| {
        let points = |of: usize| known.iter().map(|(row, offs)| (value(row), offs[of])).collect();
        let (without, with): (Vec<Bin>, Vec<Bin>) = (table(points(0)), table(points(1)));
        let nearer: f64 = without.iter().zip(&with).map(|(a, b)| brought_nearer(a, b)).sum();
        (nearer, Evidence { effect: effect.into(), channel, depends_on, unit: unit(channel), without, with })
    });
    tables.max_by(|a, b| a.0.total_cmp(&b.0))
}

/// How much nearer to zero a bin comes, in squared standard errors.
fn brought_nearer(without: &Bin, with: &Bin) -> f64 {
    (without.off * without.off - with.off * with.off) / (without.error * without.error).max(1e-12)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::*;

    /// Steps are longer by the effect's length: without it they are off by that, and with it by nothing.
    #[test]
    fn an_effect_takes_away_what_it_predicts() {
        let observations = observations(8, 20, |_, _| Made::default());
        let rows: Vec<Known> = observations.rows.iter().map(|row| (row, [1.1, 0.01])).collect();
        let (nearer, evidence) = along_best_covariate("longer", Channel::Forward, &rows).expect("rows enough");
        assert!(nearer > 0.0 && evidence.without.len() == evidence.with.len(), "{evidence:?}");
        assert!(evidence.without.iter().all(|bin| (bin.off - 1.1).abs() < 1e-9), "{evidence:?}");
        assert!(evidence.with.iter().all(|bin| (bin.off - 0.01).abs() < 1e-9), "{evidence:?}");
        assert!(along_best_covariate("longer", Channel::Forward, &rows[..FEWEST - 1]).is_none());
    }
}
