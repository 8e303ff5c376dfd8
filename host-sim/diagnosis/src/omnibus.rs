//! The omnibus test for unmodelled structure: how much of a fit's residual any covariate predicts.
//!
//! Kernel regression over the room comes first (`kernel`). On top of it every channel has the same neutral [`basis`] in all
//! covariates of a row, fitted by [ridge] regression whose strength is chosen by cross-validation over runs. Nothing in it
//! stands for a particular effect. Its cross-validated gain bounds what any effect could explain.

pub mod basis;
mod kernel;
mod motion;
mod sonar;

use super::epistemic_error::EpistemicError;
use super::explanation::Explanation;
use super::fit::{FitContext, Fitted};
use super::gain::Gain;
use super::residuals::{log_likelihoods, subtract};
use super::sample::{HoldOut, RowSet};
use super::scores::Scores;
use basis::{Basis, Covariates};
use kernel::{KernelRegression, Neighbours, Spot};
use mindgap_foundations::channel::Channel;
use mindgap_foundations::statistics::ridge;
use mindgap_learning::evaluation::observations::FEWEST_BLOCKS;

/// A regression of one channel's residual on covariates, on top of a fit.
pub struct Regression {
    /// The channel.
    pub channel: Channel,
    /// The simulator's epistemic error in that channel, if it predicts anything.
    pub epistemic_error: Option<EpistemicError>,
    /// The fit underneath, its parameters taken as given.
    underneath: Fitted,
    cross_validated: Scores,
    surface: Surface,
    /// Prediction of each identification row by the other folds.
    predictions: Vec<f64>,
    likelihood: Likelihood,
}

/// The likelihood of a row given a prediction.
enum Likelihood {
    Motion(motion::LocalNoise),
    EchoRate,
    EchoValue(sonar::Spread),
}

/// A fitted response surface: one part by place, and one by covariates on top of it.
struct Surface {
    by_place: KernelRegression,
    basis: Basis,
    weights: Vec<f64>,
    /// A prediction of one in the channel's unit.
    unit: f64,
}

/// The covariates of a row, step by step if several steps are compared as one.
type Steps = Vec<Covariates>;

/// From this fraction of their variance on, echoes count as place-bound. Training logs of 24 runs show at most 0.03 where
/// nothing is place-bound (robots of the fixed challenge) and at least 0.09 where most of the variance is (the same robots with
/// `--place-bound`); this is the geometric middle.
const PLACE_BOUND: f64 = 0.05;

/// Ratios of noise variance to prior variance that are tried. With the first, a thousand rows outweigh the prior by half a nat;
/// with the last, the prior is wider than the noise and has no influence. The error is flat between neighbours.
const STRENGTHS: [f64; 7] = [1000.0, 215.0, 46.0, 10.0, 2.15, 0.46, 0.1];

/// Number of folds: no more than the number of blocks, so that none is empty.
const FOLDS: usize = FEWEST_BLOCKS;

impl Explanation for Regression {
    fn cross_validated(&self) -> &Scores {
        &self.cross_validated
    }

    fn predict(&self, rows: &HoldOut) -> Scores {
        self.underneath.predict(rows).with(self.channel, &self.column(None, RowSet::HeldOut(rows)))
    }

    /// The strength of the ridge is chosen by nested cross-validation, which already pays for complexity.
    fn complexity_penalty(&self) -> f64 {
        0.0
    }
}

impl Regression {
    /// Fits the residual of `underneath` in a channel.
    pub fn of(channel: Channel, underneath: &Fitted, context: &FitContext) -> Self {
        let underneath = underneath.taken_as_given();
        match channel.motion_axis() {
            Some(axis) => motion::regression(channel, axis, underneath, context),
            None if channel == Channel::EchoRate => sonar::rate(underneath, context),
            None => sonar::value(underneath, context),
        }
    }

    /// Fits a shift of the readings and leaves their noise as it is.
    pub fn of_shifted_readings(underneath: &Fitted, context: &FitContext) -> Self {
        sonar::shift(underneath.taken_as_given(), context)
    }

    /// Returns what the regression is compared with: the fit underneath, together with the simulator's epistemic error.
    pub fn reference(&self) -> &dyn Explanation {
        match &self.epistemic_error {
            Some(error) => error,
            None => &self.underneath,
        }
    }

    /// Returns the gain over the reference per block.
    pub fn gains(&self) -> Vec<f64> {
        self.gains_over(self.reference())
    }

    /// Returns the gain over the reference. A residual can belong to one spot of the room that few runs meet; a run that meets
    /// it as the others predict is no coincidence, so only the best run is trimmed. If echoes are place-bound, every room has
    /// such spots, and what a few places show is not a property of the robot.
    pub fn gain(&self, context: &FitContext) -> Gain {
        if self.channel.motion_axis().is_some() || context.baseline().place_bound[0] < PLACE_BOUND {
            return Gain::trimmed(&self.gains(), 1);
        }
        let gains = (&self.cross_validated - self.reference().cross_validated()).of(self.channel);
        Gain::of_free_form(&context.rows.by_place(&gains))
    }

    /// Returns the gain over the fit underneath on held-out rows.
    pub fn held_out_gain(&self, rows: &HoldOut) -> f64 {
        self.held_out_gain_over(&self.underneath, rows)
    }

    /// Returns the log-likelihood of each row in the channel, for a motion channel with the given standard deviation if there is
    /// one.
    pub fn column(&self, noise: Option<f64>, rows: RowSet) -> Vec<f64> {
        let sample = rows.sample();
        match &self.likelihood {
            Likelihood::Motion(local) => {
                let residuals = self.beyond_prediction(local.axis, rows);
                let noise = noise.unwrap_or(local.noise);
                log_likelihoods(local.axis, noise, sample, &residuals, &local.ratios(rows))
            }
            _ if matches!(rows, RowSet::Fitted(_)) => self.cross_validated.of(self.channel),
            Likelihood::EchoRate => self.readings(rows).rates(&self.predictions(rows)),
            Likelihood::EchoValue(spread) => self.readings(rows).values(&self.predictions(rows), spread),
        }
    }

    /// Returns the standard deviation that the regression leaves in a motion channel, cm or rad.
    pub fn noise(&self) -> Option<f64> {
        match &self.likelihood {
            Likelihood::Motion(local) => Some(local.noise),
            Likelihood::EchoRate | Likelihood::EchoValue(_) => None,
        }
    }

    /// Returns the residuals of a motion channel: of the fit underneath, or with the prediction subtracted as well and scaled to
    /// the usual noise. Returns `None` for a sonar channel.
    pub fn residuals(&self, subtract_prediction: bool, rows: RowSet) -> Option<Vec<Option<f64>>> {
        let Likelihood::Motion(local) = &self.likelihood else { return None };
        if !subtract_prediction {
            return Some(motion::residuals(local.axis, &self.underneath.effects(), rows.sample()));
        }
        let residuals = self.beyond_prediction(local.axis, rows);
        Some(residuals.iter().zip(local.ratios(rows)).map(|(residual, ratio)| Some((*residual)? / ratio)).collect())
    }

    fn readings<'r>(&self, rows: RowSet<'r>) -> sonar::Readings<'r> {
        sonar::Readings::of(&self.underneath.effects(), rows.sample())
    }

    fn beyond_prediction(&self, axis: usize, rows: RowSet) -> Vec<Option<f64>> {
        let residuals = motion::residuals(axis, &self.underneath.effects(), rows.sample());
        subtract(&residuals, &self.predictions(rows))
    }

    fn predictions(&self, rows: RowSet) -> Vec<f64> {
        let RowSet::HeldOut(rows) = rows else { return self.predictions.clone() };
        let steps = match &self.likelihood {
            Likelihood::Motion(local) => motion::covariates(&self.underneath.effects(), rows, local.typical_step_cm),
            Likelihood::EchoRate | Likelihood::EchoValue(_) => sonar::covariates(rows),
        };
        steps.iter().map(|steps| self.surface.at(steps)).collect()
    }
}

/// The rows of a channel on which a regression is fitted.
struct Design<'a> {
    covariates: &'a [Steps],
    /// Indices of the rows among all.
    used: Vec<usize>,
    folds: Vec<usize>,
    spots: Vec<Option<Spot>>,
    neighbours: Neighbours,
}

impl<'a> Design<'a> {
    /// Selects the rows for which a test holds. Rows of the same `group` never predict each other.
    fn of(covariates: &'a [Steps], is_used: impl Fn(usize) -> bool, group: impl Fn(usize) -> usize) -> Self {
        let used: Vec<usize> = (0..covariates.len()).filter(|i| is_used(*i)).collect();
        let folds = used.iter().map(|i| group(*i) % FOLDS).collect();
        let spots: Vec<Option<Spot>> = used.iter().map(|i| spot(&covariates[*i])).collect();
        Design { covariates, used, folds, neighbours: Neighbours::of(&spots), spots }
    }

    /// Fits `response(row, prediction)` by place. Also returns the cross-validated prediction of each used row.
    fn by_place(&self, response: impl Fn(usize, f64) -> f64) -> (KernelRegression, Vec<f64>) {
        kernel::fit(&self.spots, &self.neighbours, &self.folds, |index, p| response(self.used[index], p))
    }

    /// Fits a surface of `response(row, prediction, ratio)`, in units of `unit`, on top of a kernel regression and its
    /// predictions. `ratios` are the rows' noise over the usual noise. Also returns the cross-validated predictions of all rows.
    fn surface(
        &self,
        (by_place, placed): (KernelRegression, Vec<f64>),
        ratios: &[f64],
        unit: f64,
        response: impl Fn(usize, f64, f64) -> f64,
    ) -> (Surface, Vec<f64>) {
        let first_steps: Vec<&Covariates> = self.used.iter().filter_map(|i| self.covariates[*i].first()).collect();
        let basis = Basis::of(&first_steps);
        let scaled = |(i, ratio): (&usize, &f64)| {
            let terms = sum_over_steps(&self.covariates[*i], |step| basis.at(step));
            terms.into_iter().map(|term| term / ratio).collect()
        };
        let columns: Vec<Vec<f64>> = self.used.iter().zip(ratios).map(scaled).collect();
        let beyond_place = |index: usize, p: f64| {
            let (ratio, placed) = (ratios[index], placed[index]);
            (response(self.used[index], placed + ratio * p, ratio) - placed) / ratio
        };
        let ridge = ridge::fit(&columns, &self.folds, &STRENGTHS, beyond_place);
        let prediction = |index: usize| unit * (placed[index] + ratios[index] * ridge.held_out[index]);
        let predictions: Vec<f64> = (0..placed.len()).map(prediction).collect();
        (Surface { by_place, basis, weights: ridge.weights, unit }, self.among_all(&predictions, 0.0))
    }

    /// Fits both parts where all rows have the same noise.
    fn uniform_surface(&self, unit: f64, response: impl Fn(usize, f64) -> f64) -> (Surface, Vec<f64>) {
        let by_place = self.by_place(&response);
        self.surface(by_place, &vec![1.0; self.used.len()], unit, |i, prediction, _| response(i, prediction))
    }

    /// Spreads values of the used rows over all rows.
    fn among_all(&self, values: &[f64], otherwise: f64) -> Vec<f64> {
        let mut all = vec![otherwise; self.covariates.len()];
        self.used.iter().zip(values).for_each(|(i, value)| all[*i] = *value);
        all
    }
}

impl Surface {
    fn at(&self, steps: &Steps) -> f64 {
        let by_covariates = ridge::predicted(&sum_over_steps(steps, |step| self.basis.at(step)), &self.weights);
        self.unit * (self.by_place.at(spot(steps)) + by_covariates)
    }
}

/// Returns where a row is; steps that are compared as one have no single place.
fn spot(steps: &Steps) -> Option<Spot> {
    let [step] = steps.as_slice() else { return None };
    step.spot
}

/// Sums terms over n steps that are compared as one and divides by √n, as [residuals](mindgap_learning::evaluation::predictions::residual) are.
fn sum_over_steps(steps: &Steps, terms: impl Fn(&Covariates) -> Vec<f64>) -> Vec<f64> {
    let terms = steps.iter().map(terms);
    let sum = terms.reduce(|sum, terms| sum.iter().zip(&terms).map(|(a, b)| a + b).collect()).unwrap_or_default();
    let share = 1.0 / (steps.len() as f64).sqrt();
    sum.into_iter().map(|term| share * term).collect()
}
