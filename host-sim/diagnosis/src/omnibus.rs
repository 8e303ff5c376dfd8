//! The omnibus residual model: how much of what a fit leaves over follows any circumstance at all.
//!
//! First comes what other rows say near the same spot of the room (`nearby`). Over that every channel has the same neutral
//! basis ([`basis`]) in all covariates of a row, fitted by ridge regression ([`ridge`]) whose strength cross-validation over
//! runs chooses. Nothing in it stands for a particular effect. What it gains on runs that it was not fitted on bounds what
//! any effect could explain.

pub mod basis;
mod motion;
mod nearby;
mod sonar;

use super::channel::Channel;
use super::fit::{FitContext, Fitted};
use super::gain::Gain;
use basis::{Basis, Circumstances};
use mindgap_foundations::statistics::ridge;
use mindgap_learning::evaluation::observations::{FEWEST_BLOCKS, Observations};
use mindgap_models::effects::chain::EffectChain;
use nearby::{Nearby, Neighbours, Spot};

/// What the rest of a channel follows beyond a fit.
pub struct ResidualFit {
    /// The channel.
    pub channel: Channel,
    /// The log-likelihood of each row that it was fitted on, by the fit to other runs.
    pub held_out: Vec<f64>,
    /// The same by the fit beneath and what the simulator does not know of its own motion.
    without: Vec<f64>,
    /// What that is; none where it foretells nothing.
    pub own_error: Option<Foretold>,
    surface: Surface,
    predictions: Vec<f64>,
    law: Law,
    /// The effects of the fit beneath.
    effects: EffectChain,
}

/// What the simulator does not know of its own motion, as rows of other runs tell it.
pub struct Foretold {
    /// By how much likelier rows are with it, nats.
    pub nats: f64,
    /// Root mean square of it, cm or rad a step.
    pub root_mean_square: f64,
}

/// How likely a prediction makes a row.
enum Law {
    Motion(motion::Law),
    EchoRate,
    EchoValue(sonar::Spread),
}

/// A fitted response surface: what belongs to spots of the room, and over that what follows circumstances.
struct Surface {
    nearby: Nearby,
    basis: Basis,
    weights: Vec<f64>,
    /// What a prediction of one means in the channel's unit.
    unit: f64,
}

/// The circumstances of a row, step by step: several where the ways of several steps are judged as one.
type Steps = Vec<Circumstances>;

/// From this share of their chance on, echoes count as bound to places. Training logs of 24 runs show at most 0.03 where
/// there is none (the fixed challenge's robots) and at least 0.09 where most of it is (the same with `--place-bound`): halfway
/// between the two, by factors.
const PLACE_BOUND: f64 = 0.05;

/// Ratios of noise variance to prior variance that are tried. At the first, a thousand rows hold half a nat; at the last, the
/// prior is wider than the noise and the penalty has no say. The error is flat between neighbours.
const STRENGTHS: [f64; 7] = [1000.0, 215.0, 46.0, 10.0, 2.15, 0.46, 0.1];

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
    pub fn gains(&self, context: &FitContext) -> Vec<f64> {
        context.observations.by_block(&self.gain_of_rows())
    }

    /// What it gains over the fit beneath. What a channel follows may be at one spot of the room, which few runs meet: where
    /// one meets it as the others tell, it is no chance, so that no more than one run is left out. Where the chance of echoes
    /// belongs to places, every room has such spots, and what a few places show is no property of the robot.
    pub fn gain(&self, context: &FitContext) -> Gain {
        if self.channel.motion_axis().is_some() || context.baseline.place_bound[0] < PLACE_BOUND {
            return Gain::without_best(&self.gains(context), 1);
        }
        Gain::of_free_form(&context.observations.by_place(&self.gain_of_rows()))
    }

    fn gain_of_rows(&self) -> Vec<f64> {
        self.held_out.iter().zip(&self.without).map(|(a, b)| a - b).collect()
    }

    /// The log-likelihood of each row in the channel, never by a fit to its own run.
    pub fn judged_on(&self, rows: &Observations, context: &FitContext) -> Vec<f64> {
        if is_own(rows, context) { self.held_out.clone() } else { self.terms(rows, context) }
    }

    /// The same of a motion channel with this scatter in place of the model's own.
    pub fn judged_with(&self, scatter: Option<f64>, rows: &Observations, context: &FitContext) -> Vec<f64> {
        match (&self.law, scatter) {
            (Law::Motion(law), Some(scatter)) => self.steps(law, scatter, rows, context),
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

    /// What is left of each row of a motion channel: with the effects alone, or with the model's prediction taken away
    /// too and as it would be where steps scatter as usual.
    pub fn rest(&self, with_model: bool, rows: &Observations, context: &FitContext) -> Option<Vec<Option<f64>>> {
        let Law::Motion(law) = &self.law else { return None };
        if !with_model {
            return Some(law.residuals(&self.effects, context.baseline, rows));
        }
        let shares = law.shares(rows, is_own(rows, context));
        let rest = self.beyond_prediction(law, rows, context);
        Some(rest.iter().zip(shares).map(|(rest, share)| Some((*rest)? / share)).collect())
    }

    fn terms(&self, rows: &Observations, context: &FitContext) -> Vec<f64> {
        let heard = || sonar::Heard::of(&self.effects, context.baseline, rows);
        match &self.law {
            Law::Motion(law) => self.steps(law, law.scatter, rows, context),
            Law::EchoRate => heard().rates(&self.predictions(rows, context)),
            Law::EchoValue(spread) => heard().values(&self.predictions(rows, context), spread),
        }
    }

    fn steps(&self, law: &motion::Law, scatter: f64, rows: &Observations, context: &FitContext) -> Vec<f64> {
        let rest = self.beyond_prediction(law, rows, context);
        law.terms(scatter, rows, &rest, &law.shares(rows, is_own(rows, context)))
    }

    fn beyond_prediction(&self, law: &motion::Law, rows: &Observations, context: &FitContext) -> Vec<Option<f64>> {
        let residuals = law.residuals(&self.effects, context.baseline, rows);
        beyond(&residuals, &self.predictions(rows, context))
    }

    fn predictions(&self, rows: &Observations, context: &FitContext) -> Vec<f64> {
        if is_own(rows, context) {
            return self.predictions.clone();
        }
        let steps = match &self.law {
            Law::Motion(law) => law.covariates(&self.effects, context.baseline, rows),
            Law::EchoRate | Law::EchoValue(_) => sonar::covariates(rows),
        };
        steps.iter().map(|steps| self.surface.at(steps)).collect()
    }
}

/// The rows of a channel that there is something to fit to.
struct Rows<'a> {
    covariates: &'a [Steps],
    used: Vec<usize>,
    folds: Vec<usize>,
    spots: Vec<Option<Spot>>,
    neighbours: Neighbours,
}

impl<'a> Rows<'a> {
    /// Those that have any, in blocks that are never told of themselves.
    fn of(covariates: &'a [Steps], has_any: impl Fn(usize) -> bool, block: impl Fn(usize) -> usize) -> Self {
        let used: Vec<usize> = (0..covariates.len()).filter(|i| has_any(*i)).collect();
        let folds = used.iter().map(|i| block(*i) % FOLDS).collect();
        let spots: Vec<Option<Spot>> = used.iter().map(|i| spot(&covariates[*i])).collect();
        Rows { covariates, used, folds, neighbours: Neighbours::of(&spots), spots }
    }

    /// What is told near each row's spot of `response(row, prediction)`.
    fn nearby(&self, response: impl Fn(usize, f64) -> f64) -> (Nearby, Vec<f64>) {
        nearby::fit(&self.spots, &self.neighbours, &self.folds, |place, p| response(self.used[place], p))
    }

    /// Fits a surface of `response(row, prediction, share)`, in units of `unit`, over what is told near each row's spot;
    /// with the predictions of all rows from the other folds. `shares` are those of the noise, one for a usual row.
    fn surface(
        &self,
        (nearby, told): (Nearby, Vec<f64>),
        shares: &[f64],
        unit: f64,
        response: impl Fn(usize, f64, f64) -> f64,
    ) -> (Surface, Vec<f64>) {
        let first_steps: Vec<&Circumstances> = self.used.iter().filter_map(|i| self.covariates[*i].first()).collect();
        let basis = Basis::of(&first_steps);
        let evenly = |(i, share): (&usize, &f64)| {
            let terms = together(&self.covariates[*i], |step| basis.at(step));
            terms.into_iter().map(|term| term / share).collect()
        };
        let columns: Vec<Vec<f64>> = self.used.iter().zip(shares).map(evenly).collect();
        let over = |place: usize, p: f64| {
            let share = shares[place];
            (response(self.used[place], told[place] + share * p, share) - told[place]) / share
        };
        let surface = ridge::fit(&columns, &self.folds, &STRENGTHS, over);
        let predictions: Vec<f64> =
            (0..told.len()).map(|place| unit * (told[place] + shares[place] * surface.held_out[place])).collect();
        (Surface { nearby, basis, weights: surface.weights, unit }, self.of_all(&predictions, 0.0))
    }

    /// The same where all rows scatter alike.
    fn evenly(&self, unit: f64, response: impl Fn(usize, f64) -> f64) -> (Surface, Vec<f64>) {
        let told = self.nearby(&response);
        self.surface(told, &vec![1.0; self.used.len()], unit, |i, prediction, _| response(i, prediction))
    }

    /// Values of these rows among those of all.
    fn of_all(&self, values: &[f64], otherwise: f64) -> Vec<f64> {
        let mut all = vec![otherwise; self.covariates.len()];
        self.used.iter().zip(values).for_each(|(i, value)| all[*i] = *value);
        all
    }
}

impl Surface {
    fn at(&self, steps: &Steps) -> f64 {
        let surface = ridge::predicted(&together(steps, |step| self.basis.at(step)), &self.weights);
        self.unit * (self.nearby.at(spot(steps)) + surface)
    }
}

/// Where a row is; steps that are judged as one are at many places.
fn spot(steps: &Steps) -> Option<Spot> {
    let [step] = steps.as_slice() else { return None };
    step.spot
}

/// What is off adds up over steps that are judged as one, and is given a step as their scatter is.
fn together(steps: &Steps, terms: impl Fn(&Circumstances) -> Vec<f64>) -> Vec<f64> {
    let terms = steps.iter().map(terms);
    let sum = terms.reduce(|sum, terms| sum.iter().zip(&terms).map(|(a, b)| a + b).collect()).unwrap_or_default();
    let share = 1.0 / (steps.len() as f64).sqrt();
    sum.into_iter().map(|term| share * term).collect()
}

/// What predictions leave of residuals.
fn beyond(residuals: &[Option<f64>], predictions: &[f64]) -> Vec<Option<f64>> {
    residuals.iter().zip(predictions).map(|(residual, prediction)| Some((*residual)? - prediction)).collect()
}

fn is_own(rows: &Observations, context: &FitContext) -> bool {
    std::ptr::eq(rows, context.observations)
}
