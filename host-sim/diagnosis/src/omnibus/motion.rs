//! The regression of a motion channel's residual.

use super::basis::Covariates;
use super::kernel::{self, KernelRegression, Spot};
use super::{Design, Likelihood, Regression, Steps};
use crate::epistemic_error::EpistemicError;
use crate::fit::{FitContext, Fitted};
use crate::motion_uncertainty::FARTHEST;
use crate::residuals::{log_likelihoods, subtract, usual_noise};
use crate::sample::{RowSet, Sample};
use mindgap_foundations::channel::Channel;
use mindgap_foundations::motion::Motion;
use mindgap_foundations::statistics::summary::root_mean_square;
use mindgap_learning::evaluation::observations::Observation;
use mindgap_learning::evaluation::predictions::increment;
use mindgap_models::effects::StepContext;
use mindgap_models::effects::chain::EffectChain;
use mindgap_models::simulator::baseline::MotionModel;

/// Noise of a motion channel that varies over the room.
pub struct LocalNoise {
    /// Index among forward, lateral and turn.
    pub axis: usize,
    /// Usual standard deviation, cm or rad.
    pub noise: f64,
    /// Root mean square of the forward motion that is expected per step.
    pub typical_step_cm: f64,
    /// Relative variance minus one by place: where a floor holds a robot back now and then, steps have more noise than
    /// elsewhere, whatever is expected of them.
    excess_variance: KernelRegression,
    /// The simulator's noise over the usual one. No place has less: a simulator that is less certain than it could be is no gap.
    least_ratio: f64,
    /// Relative standard deviation of each identification row by the other folds.
    fitted_ratios: Vec<f64>,
}

/// Fits the residual of `underneath` in a motion channel.
pub fn regression(channel: Channel, axis: usize, underneath: Fitted, context: &FitContext) -> Regression {
    let (effects, rows, noise) = (underneath.effects(), context.rows, underneath.noise[axis]);
    let residuals = residuals(axis, &effects, rows);
    let typical_step_cm = typical_step_cm(&effects, rows);
    let covariates = covariates(&effects, rows, typical_step_cm);
    let design = Design::of(&covariates, |i| residuals[i].is_some(), |i| rows.rows[i].fold);
    let epistemic_error = EpistemicError::of(channel, axis, &underneath, &residuals, context);
    let known = epistemic_error.as_ref().map_or_else(|| vec![0.0; residuals.len()], |error| error.predictions.clone());
    let residuals = subtract(&residuals, &known);
    let relative = |i: usize| residuals[i].unwrap_or(0.0) / noise;
    let response = |i: usize, prediction: f64, ratio: f64| {
        let off = (relative(i) - prediction).clamp(-FARTHEST * ratio, FARTHEST * ratio);
        prediction + rows.rows[i].motion_weight[axis] * off
    };
    let (by_place, placed) = design.by_place(|i, prediction| response(i, prediction, 1.0));
    // Steps with more noise carry less weight in the regression.
    let (_, ratios) = noise_by_place(&design, |index, i| relative(i) - placed[index]);
    let (surface, predictions) = design.surface((by_place, placed), &ratios, noise, response);
    let residuals = subtract(&residuals, &predictions);
    let (excess_variance, ratios) = noise_by_place(&design, |_, i| residuals[i].unwrap_or(0.0) / noise);
    let ratios = design.among_all(&ratios, 1.0);
    let least = rows.baseline.motion.as_ref().map_or(1.0, |drive| drive.scatter().into_array()[axis]);
    let noise = usual_noise(axis, rows, &residuals, &ratios, least);
    let least_ratio = least / noise;
    let fitted_ratios: Vec<f64> = ratios.into_iter().map(|ratio| ratio.max(least_ratio)).collect();
    let column = log_likelihoods(axis, noise, rows, &residuals, &fitted_ratios);
    Regression {
        channel,
        epistemic_error,
        cross_validated: underneath.scores.clone().with(channel, &column),
        underneath,
        surface,
        predictions: known.iter().zip(&predictions).map(|(known, p)| known + p).collect(),
        likelihood: Likelihood::Motion(LocalNoise {
            axis,
            noise,
            typical_step_cm,
            excess_variance,
            least_ratio,
            fitted_ratios,
        }),
    }
}

/// Fits the relative variance by place to `relative(index, row)`, the residuals over the usual noise. Also returns each used row's
/// relative standard deviation by the other folds.
fn noise_by_place(design: &Design, relative: impl Fn(usize, usize) -> f64) -> (KernelRegression, Vec<f64>) {
    let spots: Vec<Option<Spot>> =
        design.spots.iter().map(|spot| spot.map(|spot| Spot::unweighted(spot.position_cm))).collect();
    let excess = |index: usize, _| {
        let relative = relative(index, design.used[index]).clamp(-FARTHEST, FARTHEST);
        relative * relative - 1.0
    };
    let (regression, excess) = kernel::fit(&spots, &design.neighbours, &design.folds, excess);
    (regression, excess.into_iter().map(noise_ratio).collect())
}

/// Returns the relative standard deviation. A kernel regression of squares exceeds minus one since its prior has weight.
fn noise_ratio(excess_variance: f64) -> f64 {
    (1.0 + excess_variance).sqrt()
}

/// Returns logged minus predicted motion along an axis.
pub fn residuals(axis: usize, effects: &EffectChain, sample: &Sample) -> Vec<Option<f64>> {
    sample.residuals(effects).into_iter().map(|r| r.map(|r| r[axis])).collect()
}

/// Returns the root mean square of the expected forward motion, or one if none is expected.
fn typical_step_cm(effects: &EffectChain, sample: &Sample) -> f64 {
    let Some(drive) = &sample.baseline.motion else { return 1.0 };
    let forward_cm = sample.rows.iter().map(|row| increment(effects, drive, row).forward);
    let typical_cm = root_mean_square(forward_cm);
    if typical_cm > 0.0 { typical_cm } else { 1.0 }
}

/// Returns the covariates of every step of every row.
pub fn covariates(effects: &EffectChain, sample: &Sample, typical_step_cm: f64) -> Vec<Steps> {
    let Some(drive) = &sample.baseline.motion else { return vec![Vec::new(); sample.rows.len()] };
    sample.rows.iter().map(|row| row_covariates(effects, drive, row, typical_step_cm)).collect()
}

fn row_covariates(effects: &EffectChain, drive: &MotionModel, row: &Observation, typical_step_cm: f64) -> Steps {
    let predicted = increment(effects, drive, row);
    let share = 1.0 / row.steps() as f64;
    let of_step = |step| step_covariates(step, &predicted, share, typical_step_cm);
    std::iter::once(&row.context).chain(&row.following_steps).map(of_step).collect()
}

/// Returns the commands now, before, and two steps back, whose products include every change of command; heading; time; place;
/// and the predicted motion.
fn step_covariates(step: &StepContext, predicted: &Motion<f64>, share: f64, typical_step_cm: f64) -> Covariates {
    let [[left, right], [left_1, right_1], [left_2, right_2], ..] = step.commands;
    let direction = step.pose.direction();
    let position_cm = step.pose.position_cm;
    let forward_cm = share * predicted.forward;
    let values = vec![
        left,
        right,
        left_1,
        right_1,
        left_2,
        right_2,
        direction.x,
        direction.y,
        step.elapsed_min,
        position_cm.x,
        position_cm.y,
        forward_cm,
        share * predicted.turn,
    ];
    // What a floor does to a step is proportional to its length.
    Covariates { values, spot: Some(Spot { position_cm, weight: forward_cm / typical_step_cm }) }
}

impl LocalNoise {
    /// Returns each row's noise over the usual noise.
    pub fn ratios(&self, rows: RowSet) -> Vec<f64> {
        let RowSet::HeldOut(rows) = rows else { return self.fitted_ratios.clone() };
        let spot =
            |row: &Observation| row.following_steps.is_empty().then(|| Spot::unweighted(row.context.pose.position_cm));
        rows.rows.iter().map(|row| noise_ratio(self.excess_variance.at(spot(row))).max(self.least_ratio)).collect()
    }
}
