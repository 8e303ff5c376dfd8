//! What the rest of a motion channel follows.

use super::basis::{Circumstances, OnFloor};
use super::{ResidualFit, Steps, Surface};
use crate::effects::chain::EffectChain;
use crate::effects::{PoseIncrement, StepContext};
use crate::evaluation::observations::{Observation, Observations};
use crate::evaluation::predictions::{increment, residual};
use crate::gap::channel::Channel;
use crate::gap::fit::{FitContext, Fitted};
use crate::gap::residual_law::{fitted_scatter, log_density};
use crate::simulator::baseline::{Baseline, MotionModel};

/// The density of a residual.
#[derive(Clone, Copy)]
pub struct Law {
    /// The place among forward, lateral and turn.
    pub axis: usize,
    /// Standard deviation, cm or rad.
    pub scatter: f64,
}

/// A residual that lies farther from its prediction pulls no more than this, in standard deviations: a jump of the
/// tracker says nothing about steps.
const FARTHEST: f64 = 4.0;

/// The rest of a motion channel.
pub fn fit(channel: Channel, axis: usize, beneath: &Fitted, context: &FitContext) -> ResidualFit {
    let effects = beneath.effects();
    let scatter = beneath.hypothesis.scatter(context.baseline, context.observations, &beneath.values)[axis];
    let law = Law { axis, scatter };
    let residuals = law.residuals(&effects, context.baseline, context.observations);
    let covariates = covariates(&effects, context.baseline, context.observations);
    let known = |i: usize| residuals[i].is_some();
    let response = |i: usize, prediction: f64| {
        prediction + (residuals[i].unwrap_or(0.0) / scatter - prediction).clamp(-FARTHEST, FARTHEST)
    };
    let run = |i: usize| context.observations.rows[i].block;
    let (surface, predictions) = Surface::fit(&covariates, known, run, scatter, response);
    let rest = residuals.iter().zip(&predictions).filter_map(|(r, prediction)| Some((*r)? - prediction));
    let rest: Vec<f64> = rest.collect();
    let law = Law { scatter: fitted_scatter(axis, &rest, law.least(context.baseline)), ..law };
    ResidualFit {
        channel,
        held_out: law.terms(&residuals, &predictions),
        surface,
        predictions,
        law: super::Law::Motion(law),
        effects,
    }
}

/// The covariates of every step of every row.
pub fn covariates(effects: &EffectChain, baseline: &Baseline, rows: &Observations) -> Vec<Steps> {
    let Some(drive) = &baseline.motion else { return vec![Vec::new(); rows.rows.len()] };
    rows.rows.iter().map(|row| of_row(effects, drive, row)).collect()
}

fn of_row(effects: &EffectChain, drive: &MotionModel, row: &Observation) -> Steps {
    let predicted = increment(effects, drive, row);
    let share = 1.0 / (1 + row.then.len()) as f64;
    std::iter::once(&row.context).chain(&row.then).map(|step| of_step(step, &predicted, share)).collect()
}

/// Commands now, before, and two back, whose products with each other make every change of command besides; heading;
/// time; place; and the motion that is predicted.
fn of_step(step: &StepContext, predicted: &PoseIncrement, share: f64) -> Circumstances {
    let [[left, right], [left_1, right_1], [left_2, right_2], ..] = step.commands;
    let direction = step.pose.direction();
    let position_cm = step.pose.position_cm;
    let way_cm = share * predicted.forward_cm;
    let covariates = vec![
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
        way_cm,
        share * predicted.turn_rad,
    ];
    Circumstances { covariates, floor: Some(OnFloor::new(position_cm, way_cm)) }
}

impl Law {
    /// Logged minus predicted.
    pub fn residuals(&self, effects: &EffectChain, baseline: &Baseline, rows: &Observations) -> Vec<Option<f64>> {
        let Some(drive) = &baseline.motion else { return vec![None; rows.rows.len()] };
        rows.rows.iter().map(|row| residual(effects, drive, row).map(|r| r[self.axis])).collect()
    }

    /// The simulator's own scatter.
    pub fn least(&self, baseline: &Baseline) -> f64 {
        baseline.motion.as_ref().map_or(1.0, |drive| drive.scatter()[self.axis])
    }

    /// The log-likelihood of each row where these predictions are right.
    pub fn terms(&self, residuals: &[Option<f64>], predictions: &[f64]) -> Vec<f64> {
        let term = |(r, prediction): (&Option<f64>, &f64)| {
            r.map_or(0.0, |r| log_density(self.axis, r - prediction, self.scatter))
        };
        residuals.iter().zip(predictions).map(term).collect()
    }
}
