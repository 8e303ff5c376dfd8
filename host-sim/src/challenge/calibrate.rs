//! Settles the thresholds of a diagnosis on cases whose answers are known.
//!
//! Cases without any effect show how large a gain chance and the simulator's own misfit feign; the others, diagnosed
//! with the thresholds that follow from that, show how much of a gap its cause explains, how far wrong effects lag, and
//! how often an answer is right.

mod fitting;

use serde::{Deserialize, Serialize};

use super::bench::Bench;
use super::cases::{Case, Size};
use crate::error::{Error, Result};
use crate::gap::Method;
use crate::gap::calibration::Calibration;
use crate::gap::diagnose::{confirmed, statistics};
use crate::gap::explanation::Explanation;
use crate::gap::gain::Gain;
use crate::gap::verdict::Explained;
use crate::workers;
use crate::workers::counter::Counter;

/// What is measured in one case.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Measured {
    /// What was different, separated by blanks.
    pub truth: String,
    /// Whether all of it is in the table of effects.
    pub in_table: bool,
    /// Rows that the gains are summed over.
    pub rows: usize,
    /// What the best effect gains, or the effects together, with less of the blocks that gain most, nats.
    pub effect_nats: f64,
    /// The most that the omnibus residual model gains in a channel, likewise; nothing where effects are sought.
    pub remainder_nats: f64,
    /// Where there is one effect, and it is found first: the share of what it explains that its form would have to feign for
    /// no other to be named beside it.
    pub feigned_share: Option<f64>,
    /// The effect that was named first; empty when none was.
    pub first: String,
    /// The share of what could be explained that the effects explain,
    pub explained_fraction: f64,
    /// and its standard error.
    pub explained_error: f64,
    /// Relative likelihood of an effect that is there: one when it is the first, zero when it is none of the rivals.
    pub likelihood_of_truth: f64,
    /// Relative likelihoods of the effects that could be in the first one's place.
    #[serde(skip)]
    pub rivals: Vec<f64>,
}

/// Fewer cases settle nothing.
const FEWEST: usize = 40;

/// The thresholds that `count` cases call for, and what was measured in each; `watch` is told how many are done,
/// and of how many.
///
/// # Errors
/// When there are too few cases.
pub fn calibrate(
    count: usize,
    seed: u64,
    size: Size,
    watch: impl Fn(usize, usize) + Sync,
) -> Result<(Calibration, Vec<Measured>)> {
    if count < FEWEST {
        return Err(Error::new(format!("{count} cases settle nothing: give at least {FEWEST}")));
    }
    let bench = Bench::new(count, seed, size)?;
    let (nulls, others): (Vec<usize>, Vec<usize>) = (0..count).partition(|case| bench.effects[*case].is_empty());
    let counter = Counter::new(count, watch);
    let counted = |measured: Result<Measured>| measured.inspect(|_| counter.one_more());
    let nulls = workers::map(nulls.len(), |null| counted(without_effect(&bench, nulls[null])))?;
    let open = fitting::open(&nulls);
    // The rivals are in no table, and go beside the rest of what was measured.
    let with_rivals = |measured: Measured| (measured.rivals.clone(), measured);
    let others =
        workers::map(others.len(), |other| counted(with_effects(&bench, others[other], open)).map(with_rivals))?;
    let others: Vec<Measured> = others.into_iter().map(|(rivals, measured)| Measured { rivals, ..measured }).collect();
    Ok((fitting::weighed(open, &others), nulls.into_iter().chain(others).collect()))
}

fn without_effect(bench: &Bench, number: usize) -> Result<Measured> {
    let (case, baseline) = bench.case(number)?;
    let statistics = statistics(baseline, &case.logs, Method::default())?;
    Ok(Measured {
        remainder_nats: statistics.remainder.winsorized_nats,
        ..Measured::of(&case, statistics.rows, statistics.effect)
    })
}

fn with_effects(bench: &Bench, number: usize, calibration: Calibration) -> Result<Measured> {
    let (case, baseline) = bench.case(number)?;
    let (found, feigned_share) = confirmed(baseline, &case.logs, &[calibration], |found, context, hold_out| {
        let feigned_share = match &case.effects[..] {
            [one] => found.fits.form_error_fraction(one.effect.id(), context, hold_out),
            _ => None,
        };
        (found, feigned_share)
    })?
    .swap_remove(0);
    let measured = Measured {
        feigned_share,
        ..Measured::of(&case, found.chosen.scores.rows().len(), found.chosen.gain_over(&found.fits.null))
    };
    let ids = found.chosen.ids();
    // The effect with the least doubt is the one that is named first.
    let rivals = (0..ids.len()).map(|place| (place, found.rival_likelihoods(place, &calibration)));
    let doubt = |rivals: &[(&str, f64)]| rivals.iter().map(|(_, likelihood)| likelihood).sum::<f64>();
    let Some((place, rivals)) = rivals.min_by(|a, b| doubt(&a.1).total_cmp(&doubt(&b.1))) else {
        return Ok(measured);
    };
    let explained = Explained::at_least(&found);
    let is_there = |id: &str| case.effects.iter().any(|active| active.effect.id() == id);
    let among_rivals = rivals.iter().find(|(id, _)| is_there(id)).map_or(0.0, |(_, likelihood)| *likelihood);
    Ok(Measured {
        first: ids[place].into(),
        explained_fraction: explained.fraction,
        explained_error: explained.error,
        likelihood_of_truth: if is_there(ids[place]) { 1.0 } else { among_rivals },
        rivals: rivals.iter().map(|(_, likelihood)| *likelihood).collect(),
        ..measured
    })
}

impl Measured {
    fn of(case: &Case, rows: usize, effect: Gain) -> Self {
        let names: Vec<&str> = case.effects.iter().map(|active| active.effect.id()).collect();
        Measured {
            truth: names.join(" "),
            in_table: case.effects.iter().all(|active| active.effect.in_table()),
            rows,
            effect_nats: effect.winsorized_nats,
            remainder_nats: 0.0,
            feigned_share: None,
            first: String::new(),
            explained_fraction: 0.0,
            explained_error: 0.0,
            likelihood_of_truth: 0.0,
            rivals: Vec::new(),
        }
    }
}
