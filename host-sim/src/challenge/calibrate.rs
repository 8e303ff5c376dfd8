//! Fits the thresholds of the diagnosis on cases whose truth is known.
//!
//! Cases without effects give the distribution of gains under the null hypothesis (chance and the simulator's own misfit)
//! and so the gates. The others, diagnosed with these gates, show how much of a gap its true cause explains, how far wrong
//! effects lag behind, and how often an answer is right.

mod fitting;

use rayon::prelude::*;
use serde::Serialize;

use super::answer::learn;
use super::cases::{self, Case};
use crate::built_in_robot::Effect;
use crate::gap::baseline::Baseline;
use crate::gap::calibration::Calibration;
use crate::gap::diagnosis::{explained, first_signs};
use crate::gap::explanation::Signs;
use crate::gap::search::Gain;
use crate::logs::Logs;
use crate::problem::{Problem, Result};
use crate::simulator::Simulator;

/// Measurements of one case.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Measured {
    /// Ids of its effects, separated by blanks.
    pub truth: String,
    /// Whether all of them are in the table of effects.
    pub in_table: bool,
    /// Number of rows that gains are summed over.
    pub rows: usize,
    /// Gain of the best effect, or of the effects together, nats.
    pub effect_nats: f64,
    /// The same in standard errors.
    pub effect_z: f64,
    /// Largest gain of the generic learner in a channel, nats; zero for cases with effects.
    pub learner_nats: f64,
    /// The same in standard errors.
    pub learner_z: f64,
    /// Id of the effect named first; empty if none was.
    pub first: String,
    /// Share of the explicable gap that the effects explain.
    pub adequacy: f64,
    /// Relative likelihood of the true effect: one if it is named first, zero if it is not among the rivals.
    pub weight_of_truth: f64,
    /// Relative likelihoods of the rivals of the first effect.
    #[serde(skip)]
    pub rivals: Vec<f64>,
}

/// Least number of cases for a calibration.
const FEWEST: usize = 40;

/// The thresholds fitted to `count` cases, and the measurements of each; `watch` receives the number completed.
///
/// # Errors
/// When there are too few cases.
pub fn calibrate(count: usize, seed: u64, watch: impl Fn(usize)) -> Result<(Calibration, Vec<Measured>)> {
    if count < FEWEST {
        return Err(Problem::new(format!("{count} cases settle nothing: give at least {FEWEST}")));
    }
    let bench = Bench::new(count, seed)?;
    let (nulls, others): (Vec<usize>, Vec<usize>) = (0..count).partition(|case| bench.effects[*case].is_empty());
    let nulls = nulls.par_iter().map(|case| bench.without_effect(*case)).collect::<Result<Vec<Measured>>>()?;
    watch(nulls.len());
    let open = fitting::open(&nulls);
    let others = others.par_iter().map(|case| bench.with_effects(*case, open)).collect::<Result<Vec<Measured>>>()?;
    watch(count);
    Ok((fitting::weighed(open, &others), nulls.into_iter().chain(others).collect()))
}

/// The cases and the simulators of their robots.
struct Bench {
    seed: u64,
    robots: Vec<Logs>,
    simulators: Vec<Simulator>,
    effects: Vec<Vec<Effect>>,
}

impl Bench {
    fn new(count: usize, seed: u64) -> Result<Self> {
        let robots = cases::robots(seed)?;
        let simulators = robots.iter().map(learn).collect::<Result<_>>()?;
        Ok(Bench { seed, robots, simulators, effects: cases::effects(count, seed) })
    }

    fn case(&self, number: usize) -> Result<(Case, Baseline<'_>)> {
        let case = cases::case(number, &self.effects[number], &self.robots, self.seed)?;
        let baseline = Baseline::learned(&self.simulators[case.robot])?;
        Ok((case, baseline))
    }

    fn without_effect(&self, number: usize) -> Result<Measured> {
        let (case, baseline) = self.case(number)?;
        let Signs { effect, learner, rows } = first_signs(baseline, &case.logs)?;
        Ok(Measured { learner_nats: learner.nats, learner_z: learner.z(), ..Measured::of(&case, rows, effect) })
    }

    fn with_effects(&self, number: usize, calibration: Calibration) -> Result<Measured> {
        let (case, baseline) = self.case(number)?;
        let explanation = explained(baseline, &case.logs, calibration)?;
        let rows = explanation.none.terms.total().len();
        let measured = Measured::of(&case, rows, explanation.chosen.gain_over(&explanation.none));
        let Some(first) = explanation.named().into_iter().next() else { return Ok(measured) };
        let place = explanation.chosen.ids().iter().position(|id| *id == first.id).unwrap_or(0);
        let rivals = explanation.weights_in_place_of(place);
        let is_there = |id: &str| case.effects.iter().any(|active| active.effect.id() == id);
        let among_rivals = rivals.iter().find(|(id, _)| is_there(id)).map_or(0.0, |(_, weight)| *weight);
        Ok(Measured {
            first: first.id.into(),
            adequacy: explanation.adequacy(),
            weight_of_truth: if is_there(first.id) { 1.0 } else { among_rivals },
            rivals: rivals.iter().map(|(_, weight)| *weight).collect(),
            ..measured
        })
    }
}

impl Measured {
    fn of(case: &Case, rows: usize, effect: Gain) -> Self {
        let names: Vec<&str> = case.effects.iter().map(|active| active.effect.id()).collect();
        Measured {
            truth: names.join(" "),
            in_table: case.effects.iter().all(|active| active.effect.in_table()),
            rows,
            effect_nats: effect.nats,
            effect_z: effect.z(),
            learner_nats: 0.0,
            learner_z: 0.0,
            first: String::new(),
            adequacy: 0.0,
            weight_of_truth: 0.0,
            rivals: Vec::new(),
        }
    }
}
