//! Fits the thresholds of the diagnosis to cases with known effects.
//!
//! Cases without effects show how much gain arises from chance and from the simulator's own misfit. The others, diagnosed
//! with the resulting thresholds, show how much of a gap its cause explains, how far wrong effects fall behind, and how
//! often an answer is right.

mod fitting;

use serde::{Deserialize, Serialize};

use super::bench::Bench;
use super::cases::{Case, Size};
use mindgap_diagnosis::Method;
use mindgap_diagnosis::calibration::Calibration;
use mindgap_diagnosis::diagnose::{confirmed, statistics};
use mindgap_diagnosis::explanation::Explanation;
use mindgap_diagnosis::further_shares::FurtherShares;
use mindgap_diagnosis::gain::Gain;
use mindgap_diagnosis::verdict::Explained;
use mindgap_foundations::counter::Counter;
use mindgap_foundations::error::{Error, Result};
use mindgap_foundations::executor::{self, Executor};

/// The measurements of one case.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Measured {
    /// Injected effects, separated by spaces.
    pub truth: String,
    /// Whether all of them are known to the diagnosis.
    pub in_table: bool,
    /// Number of rows over which gains are summed.
    pub rows: usize,
    /// Winsorised gain of the best effect, or of all effects together, nats.
    pub effect_nats: f64,
    /// Largest winsorised gain of the omnibus residual model in a channel, nats; empty if effects are searched for.
    pub remainder_nats: f64,
    /// For a single effect that is found first: the model-form error, as a share of its gain, at which no second effect
    /// would be named.
    pub form_error_fraction: Option<f64>,
    /// The effect named first; empty if there is none.
    pub first: String,
    /// Share of the explainable gap that the effects explain.
    pub explained_fraction: f64,
    /// Standard error of that share.
    pub explained_error: f64,
    /// Relative likelihood of a true effect: one if it is named first, zero if it is not among the rivals.
    pub likelihood_of_truth: f64,
    /// Relative likelihoods of the rivals of the first effect.
    #[serde(skip)]
    pub rivals: Vec<f64>,
}

/// Minimum number of cases.
const FEWEST: usize = 40;

/// Returns the thresholds fitted to `count` cases, the model-form error by effect, and the measurements of each case. `watch` is
/// called with the number of finished cases and the total.
///
/// # Errors
/// If there are too few cases.
pub fn calibrate(
    executor: &dyn Executor,
    count: usize,
    seed: u64,
    size: Size,
    watch: impl Fn(usize, usize) + Sync,
) -> Result<(Calibration, FurtherShares, Vec<Measured>)> {
    if count < FEWEST {
        return Err(Error::new(format!("{count} cases are too few: give at least {FEWEST}")));
    }
    let bench = Bench::new(executor, count, seed, size)?;
    let (nulls, others): (Vec<usize>, Vec<usize>) = (0..count).partition(|case| bench.effects[*case].is_empty());
    let counter = Counter::new(count, watch);
    let counted = |measured: Result<Measured>| measured.inspect(|_| counter.increment());
    let nulls = executor::map(executor, nulls.len(), |null| counted(without_effect(&bench, nulls[null])))?;
    let open = fitting::open(&nulls);
    // Rivals are not part of the written table, so they are returned separately.
    let with_rivals = |measured: Measured| (measured.rivals.clone(), measured);
    let others = executor::map(executor, others.len(), |other| {
        counted(with_effects(&bench, others[other], open)).map(with_rivals)
    })?;
    let others: Vec<Measured> = others.into_iter().map(|(rivals, measured)| Measured { rivals, ..measured }).collect();
    let calibration = fitting::weighed(open, &others);
    let further_shares = fitting::further_shares(&others, calibration.further_share);
    Ok((calibration, further_shares, nulls.into_iter().chain(others).collect()))
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
    let (found, form_error_fraction) = confirmed(baseline, &case.logs, &[calibration], |found, context, hold_out| {
        let form_error_fraction = match &case.effects[..] {
            [one] => found.fits.form_error_fraction(one.effect.id(), context, hold_out),
            _ => None,
        };
        (found, form_error_fraction)
    })?
    .swap_remove(0);
    let measured = Measured {
        form_error_fraction,
        ..Measured::of(&case, found.chosen.scores.rows().len(), found.chosen.gain_over(&found.fits.null))
    };
    let ids = found.chosen.ids();
    // The most probable effect is the one named first.
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
            form_error_fraction: None,
            first: String::new(),
            explained_fraction: 0.0,
            explained_error: 0.0,
            likelihood_of_truth: 0.0,
            rivals: Vec::new(),
        }
    }
}
