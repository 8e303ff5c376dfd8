//! The omnibus residual model: how much of what a fit leaves over follows any circumstance at all.
//!
//! Every channel has the same neutral basis ([`basis`]) in all covariates of a row, fitted by ridge regression
//! ([`ridge`]) whose strength cross-validation over runs chooses, once for the cells of the floor and then for the response
//! surface over them. Nothing in it stands for a particular effect. What it
//! gains on runs that it was not fitted on bounds what any effect could explain.

pub mod basis;
mod motion;
pub mod ridge;
mod sonar;

use super::channel::Channel;
use super::fit::{FitContext, Fitted, Gain};
use crate::effects::chain::EffectChain;
use crate::evaluation::observations::{FEWEST_BLOCKS, Observations};
use basis::{Basis, Circumstances};

/// What the rest of a channel follows beyond a fit.
pub struct ResidualFit {
    /// The channel.
    pub channel: Channel,
    /// The log-likelihood of each row that it was fitted on, by the fit to other runs.
    pub held_out: Vec<f64>,
    surface: Surface,
    predictions: Vec<f64>,
    law: Law,
    /// The effects of the fit beneath.
    effects: EffectChain,
}

/// How likely a prediction makes a row.
enum Law {
    Motion(motion::Law),
    EchoRate,
    EchoValue(sonar::Spread),
}

/// A fitted response surface: what belongs to the cells of the floor, and over that what follows circumstances.
struct Surface {
    basis: Basis,
    on_floor: Vec<f64>,
    weights: Vec<f64>,
    /// What a prediction of one means in the channel's unit.
    unit: f64,
}

/// The circumstances of a row, step by step: several where the ways of several steps are judged as one.
type Steps = Vec<Circumstances>;

/// As many folds as there are blocks of rows at least, so that none is empty.
const FOLDS: usize = FEWEST_BLOCKS;

impl ResidualFit {
    /// What the rest of a channel follows beyond the fit `beneath`.
    pub fn of(channel: Channel, beneath: &Fitted, context: &FitContext) -> Self {
        match channel.motion_axis() {
            Some(axis) => motion::fit(channel, axis, beneath, context),
            None if channel == Channel::EchoRate => sonar::rate(beneath, context),
            None => sonar::value(beneath, context),
        }
    }

    /// Where readings lie; their scatter is left as it is.
    pub fn moved_readings(beneath: &Fitted, context: &FitContext) -> Self {
        sonar::moved(beneath, context)
    }

    /// The gain on each block over the fit beneath, by fits to other blocks.
    pub fn gains_over(&self, beneath: &Fitted, context: &FitContext) -> Vec<f64> {
        let without = beneath.log_likelihood.channel(self.channel);
        let gains: Vec<f64> = self.held_out.iter().zip(without).map(|(a, b)| a - b).collect();
        context.observations.by_block(&gains)
    }

    /// What it gains over the fit beneath, and how much that differs between runs, or for echoes between places: what
    /// belongs to a place does not tell of others. What motion follows may be a spot of the floor that few runs cross; where
    /// one crosses it as the others tell, it is no chance, so that no more than one run is left out.
    pub fn gain_over(&self, beneath: &Fitted, context: &FitContext) -> Gain {
        let without = beneath.log_likelihood.channel(self.channel);
        let gains: Vec<f64> = self.held_out.iter().zip(without).map(|(a, b)| a - b).collect();
        match &self.law {
            Law::Motion(_) => Gain::without_best(&context.observations.by_block(&gains), 1),
            Law::EchoRate | Law::EchoValue(_) => Gain::of(&context.observations.by_place(&gains)),
        }
    }

    /// The log-likelihood of each row in the channel, never by a fit to its own run.
    pub fn judged_on(&self, rows: &Observations, context: &FitContext) -> Vec<f64> {
        if is_own(rows, context) {
            self.held_out.clone()
        } else {
            self.terms(rows, context, &self.predictions(rows, context))
        }
    }

    /// The same of a motion channel with this scatter in place of the model's own.
    pub fn judged_with(&self, scatter: Option<f64>, rows: &Observations, context: &FitContext) -> Vec<f64> {
        match (&self.law, scatter) {
            (Law::Motion(law), Some(scatter)) => {
                let residuals = law.residuals(&self.effects, context.baseline, rows);
                motion::Law { scatter, ..*law }.terms(&residuals, &self.predictions(rows, context))
            }
            _ => self.judged_on(rows, context),
        }
    }

    /// The scatter of a motion channel that the model leaves, cm or rad.
    pub fn scatter(&self) -> Option<f64> {
        match &self.law {
            Law::Motion(law) => Some(law.scatter),
            Law::EchoRate | Law::EchoValue(_) => None,
        }
    }

    /// What is left of each row of a motion channel: with the model's prediction taken away, or with the effects alone.
    pub fn rest(&self, with_model: bool, rows: &Observations, context: &FitContext) -> Option<Vec<Option<f64>>> {
        let Law::Motion(law) = &self.law else { return None };
        let residuals = law.residuals(&self.effects, context.baseline, rows);
        if !with_model {
            return Some(residuals);
        }
        let rest =
            residuals.iter().zip(self.predictions(rows, context)).map(|(r, prediction)| Some((*r)? - prediction));
        Some(rest.collect())
    }

    fn terms(&self, rows: &Observations, context: &FitContext, predictions: &[f64]) -> Vec<f64> {
        match &self.law {
            Law::Motion(law) => law.terms(&law.residuals(&self.effects, context.baseline, rows), predictions),
            Law::EchoRate => sonar::Heard::of(&self.effects, context.baseline, rows).rates(predictions),
            Law::EchoValue(spread) => {
                sonar::Heard::of(&self.effects, context.baseline, rows).values(predictions, spread)
            }
        }
    }

    fn predictions(&self, rows: &Observations, context: &FitContext) -> Vec<f64> {
        if is_own(rows, context) {
            return self.predictions.clone();
        }
        let steps = match &self.law {
            Law::Motion(_) => motion::covariates(&self.effects, context.baseline, rows),
            Law::EchoRate | Law::EchoValue(_) => sonar::covariates(rows),
        };
        steps.iter().map(|steps| self.surface.at(steps)).collect()
    }
}

impl Surface {
    /// Fits `response(row, prediction)`, in units of `unit`, of the rows that have any; with the predictions of all rows
    /// from the other folds.
    fn fit(
        covariates: &[Steps],
        has_any: impl Fn(usize) -> bool,
        block: impl Fn(usize) -> usize,
        unit: f64,
        response: impl Fn(usize, f64) -> f64,
    ) -> (Self, Vec<f64>) {
        let used: Vec<usize> = (0..covariates.len()).filter(|i| has_any(*i)).collect();
        let first_steps: Vec<&Circumstances> = used.iter().filter_map(|i| covariates[*i].first()).collect();
        let basis = Basis::of(&first_steps);
        let folds: Vec<usize> = used.iter().map(|i| block(*i) % FOLDS).collect();
        let columns = |of: fn(&Basis, &Circumstances) -> Vec<f64>| -> Vec<Vec<f64>> {
            used.iter().map(|i| together(&covariates[*i], |step| of(&basis, step))).collect()
        };
        let floor = ridge::fit(&columns(Basis::on_floor), &folds, |place, p| response(used[place], p));
        let over = |place: usize, p: f64| response(used[place], floor.held_out[place] + p) - floor.held_out[place];
        let surface = ridge::fit(&columns(Basis::at), &folds, over);
        let mut predictions = vec![0.0; covariates.len()];
        for (place, i) in used.iter().enumerate() {
            predictions[*i] = unit * (floor.held_out[place] + surface.held_out[place]);
        }
        (Surface { basis, on_floor: floor.weights, weights: surface.weights, unit }, predictions)
    }

    fn at(&self, steps: &Steps) -> f64 {
        let floor = ridge::predicted(&together(steps, |step| self.basis.on_floor(step)), &self.on_floor);
        let surface = ridge::predicted(&together(steps, |step| self.basis.at(step)), &self.weights);
        self.unit * (floor + surface)
    }
}

/// What is off adds up over steps that are judged as one, and is given a step as their scatter is.
fn together(steps: &Steps, terms: impl Fn(&Circumstances) -> Vec<f64>) -> Vec<f64> {
    let terms = steps.iter().map(terms);
    let sum = terms.reduce(|sum, terms| sum.iter().zip(&terms).map(|(a, b)| a + b).collect()).unwrap_or_default();
    let share = 1.0 / (steps.len() as f64).sqrt();
    sum.into_iter().map(|term| share * term).collect()
}

fn is_own(rows: &Observations, context: &FitContext) -> bool {
    std::ptr::eq(rows, context.observations)
}
