//! What the rest of a motion channel follows.

use super::basis::Circumstances;
use super::nearby::{self, Nearby, Spot};
use super::{Foretold, ResidualFit, Rows, Steps, beyond};
use crate::channel::Channel;
use crate::fit::{FitContext, Fitted};
use crate::own_error::FARTHEST;
use crate::residual_law::{fitted_scatter, log_density};
use mindgap_foundations::statistics::summary::root_mean_square;
use mindgap_learning::evaluation::observations::{Observation, Observations};
use mindgap_learning::evaluation::predictions::{increment, residual};
use mindgap_models::effects::chain::EffectChain;
use mindgap_models::effects::{PoseIncrement, StepContext};
use mindgap_models::simulator::baseline::{Baseline, MotionModel};

/// The density of a residual.
#[derive(Clone)]
pub struct Law {
    /// The place among forward, lateral and turn.
    pub axis: usize,
    /// Standard deviation where nothing is different, cm or rad.
    pub scatter: f64,
    /// By how much more than one the variance differs from that near a spot: where a floor holds a robot back now and then,
    /// steps scatter more than elsewhere, whatever is expected of them.
    further_variance: Nearby,
    /// Nowhere do steps scatter less than the simulator's: that it is sure of less than it could be is no gap.
    least_share: f64,
    /// The share of the scatter of the rows that it was fitted on, by the fit to other runs.
    own_shares: Vec<f64>,
    usual_way_cm: f64,
}

/// The rest of a motion channel.
pub fn fit(channel: Channel, axis: usize, beneath: &Fitted, context: &FitContext) -> ResidualFit {
    let effects = beneath.effects();
    let scatter = beneath.hypothesis.scatter(context.baseline, context.observations, &beneath.values)[axis];
    let (baseline, rows) = (context.baseline, context.observations);
    let residuals = residuals(axis, &effects, baseline, rows);
    let usual_way_cm = usual_way_cm(&effects, baseline, rows);
    let covariates = covariates(&effects, baseline, rows, usual_way_cm);
    let of_axis = Rows::of(&covariates, |i| residuals[i].is_some(), |i| rows.rows[i].fold);
    let (without, own, own_error) = without_own_error(channel, axis, beneath, &residuals, context);
    let residuals = beyond(&residuals, &own);
    let off = |i: usize| residuals[i].unwrap_or(0.0) / scatter;
    // Of what repeats a row says less.
    let response = |i: usize, prediction: f64, share: f64| {
        let off = (off(i) - prediction).clamp(-FARTHEST * share, FARTHEST * share);
        prediction + rows.rows[i].motion_weight[axis] * off
    };
    let (nearby, told) = of_axis.nearby(|i, prediction| response(i, prediction, 1.0));
    // Steps that scatter more say less of what steps follow.
    let (_, shares) = scatter_nearby(&of_axis, |place, i| off(i) - told[place]);
    let (surface, predictions) = of_axis.surface((nearby, told), &shares, scatter, response);
    let rest = beyond(&residuals, &predictions);
    let (further_variance, shares) = scatter_nearby(&of_axis, |_, i| rest[i].unwrap_or(0.0) / scatter);
    let shares = of_axis.of_all(&shares, 1.0);
    let least = baseline.motion.as_ref().map_or(1.0, |drive| drive.scatter()[axis]);
    let scatter = even_scatter(axis, rows, &rest, &shares, least);
    let least_share = least / scatter;
    let own_shares = shares.into_iter().map(|share| share.max(least_share)).collect();
    let law = Law { axis, scatter, further_variance, own_shares, least_share, usual_way_cm };
    ResidualFit {
        channel,
        held_out: law.terms(law.scatter, rows, &rest, &law.own_shares),
        without,
        own_error,
        surface,
        predictions: own.iter().zip(&predictions).map(|(own, p)| own + p).collect(),
        law: super::Law::Motion(law),
        effects,
    }
}

/// The log-likelihood of each row by the fit beneath once what the simulator does not know of its own motion is taken away, and
/// what that is, cm or rad; nothing where rows are no likelier without it.
fn without_own_error(
    channel: Channel,
    axis: usize,
    beneath: &Fitted,
    residuals: &[Option<f64>],
    context: &FitContext,
) -> (Vec<f64>, Vec<f64>, Option<Foretold>) {
    let rows = context.observations;
    let with = beneath.log_likelihood.channel(channel);
    let foretold = || {
        let own = context.own_errors.as_ref()?.foretold(axis, &rows.rows, residuals)?;
        let (rest, alike) = (beyond(residuals, &own), vec![1.0; rows.rows.len()]);
        let least = context.baseline.motion.as_ref()?.scatter()[axis];
        let scatter = even_scatter(axis, rows, &rest, &alike, least);
        Some((terms(axis, scatter, rows, &rest, &alike), own))
    };
    let nats = |without: &[f64]| without.iter().sum::<f64>() - with.iter().sum::<f64>();
    match foretold().map(|(without, own)| (nats(&without), without, own)) {
        Some((nats, without, own)) if nats > 0.0 => {
            let root_mean_square = root_mean_square(own.iter().copied());
            (without, own, Some(Foretold { nats, root_mean_square }))
        }
        _ => (with, vec![0.0; rows.rows.len()], None),
    }
}

/// The log-likelihood of each row where this is the scatter, of which it has a share, and the rest is what predictions leave.
fn terms(axis: usize, scatter: f64, rows: &Observations, rest: &[Option<f64>], shares: &[f64]) -> Vec<f64> {
    let term = |((row, rest), share): ((&Observation, &Option<f64>), &f64)| {
        rest.map_or(0.0, |r| row.motion_weight[axis] * log_density(axis, r, share * scatter))
    };
    rows.rows.iter().zip(rest).zip(shares).map(term).collect()
}

/// The scatter of rows of which each has its share of it, `least` or more, where the rest is what predictions leave.
fn even_scatter(axis: usize, rows: &Observations, rest: &[Option<f64>], shares: &[f64], least: f64) -> f64 {
    let even = rest.iter().zip(shares).zip(&rows.rows);
    let even = even.filter_map(|((rest, share), row)| Some([(*rest)? / share, row.motion_weight[axis]]));
    fitted_scatter(axis, &even.collect::<Vec<[f64; 2]>>(), least)
}

/// How steps scatter near a spot, by what is `left` of each place and row in units of the usual scatter: by how much more
/// than one its variance is, and each row's share of the scatter by the fit to other runs.
fn scatter_nearby(rows: &Rows, left: impl Fn(usize, usize) -> f64) -> (Nearby, Vec<f64>) {
    let spots: Vec<Option<Spot>> =
        rows.spots.iter().map(|spot| spot.map(|spot| Spot::usual(spot.position_cm))).collect();
    let further = |place: usize, _| {
        let left = left(place, rows.used[place]).clamp(-FARTHEST, FARTHEST);
        left * left - 1.0
    };
    let (nearby, told) = nearby::fit(&spots, &rows.neighbours, &rows.folds, further);
    (nearby, told.into_iter().map(share).collect())
}

/// Of a standard deviation, where the variance is so much more than one. What [`nearby`] tells of squares is more than minus
/// one, since its prior is worth some rows.
fn share(further_variance: f64) -> f64 {
    (1.0 + further_variance).sqrt()
}

/// Logged minus predicted.
fn residuals(axis: usize, effects: &EffectChain, baseline: &Baseline, rows: &Observations) -> Vec<Option<f64>> {
    let Some(drive) = &baseline.motion else { return vec![None; rows.rows.len()] };
    rows.rows.iter().map(|row| residual(effects, drive, row).map(|r| r[axis])).collect()
}

/// Root mean square of what is expected of steps; one where nothing is.
fn usual_way_cm(effects: &EffectChain, baseline: &Baseline, rows: &Observations) -> f64 {
    let Some(drive) = &baseline.motion else { return 1.0 };
    let ways_cm = rows.rows.iter().map(|row| increment(effects, drive, row).forward_cm);
    let usual_cm = root_mean_square(ways_cm);
    if usual_cm > 0.0 { usual_cm } else { 1.0 }
}

/// The covariates of every step of every row.
fn covariates(effects: &EffectChain, baseline: &Baseline, rows: &Observations, usual_way_cm: f64) -> Vec<Steps> {
    let Some(drive) = &baseline.motion else { return vec![Vec::new(); rows.rows.len()] };
    rows.rows.iter().map(|row| of_row(effects, drive, row, usual_way_cm)).collect()
}

fn of_row(effects: &EffectChain, drive: &MotionModel, row: &Observation, usual_way_cm: f64) -> Steps {
    let predicted = increment(effects, drive, row);
    let share = 1.0 / (1 + row.then.len()) as f64;
    let of_step = |step| of_step(step, &predicted, share, usual_way_cm);
    std::iter::once(&row.context).chain(&row.then).map(of_step).collect()
}

/// Commands now, before, and two back, whose products with each other make every change of command besides; heading;
/// time; place; and the motion that is predicted.
fn of_step(step: &StepContext, predicted: &PoseIncrement, share: f64, usual_way_cm: f64) -> Circumstances {
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
    // What a floor does to a step shows in proportion to its way.
    Circumstances { covariates, spot: Some(Spot { position_cm, weight: way_cm / usual_way_cm }) }
}

impl Law {
    /// The circumstances of rows, as it was fitted in them.
    pub fn covariates(&self, effects: &EffectChain, baseline: &Baseline, rows: &Observations) -> Vec<Steps> {
        covariates(effects, baseline, rows, self.usual_way_cm)
    }

    /// Logged minus predicted.
    pub fn residuals(&self, effects: &EffectChain, baseline: &Baseline, rows: &Observations) -> Vec<Option<f64>> {
        residuals(self.axis, effects, baseline, rows)
    }

    /// Each row's share of the scatter: of the rows that it was fitted on, by the fit to other runs.
    pub fn shares(&self, rows: &Observations, is_own: bool) -> Vec<f64> {
        if is_own {
            return self.own_shares.clone();
        }
        let spot = |row: &Observation| row.then.is_empty().then(|| Spot::usual(row.context.pose.position_cm));
        rows.rows.iter().map(|row| share(self.further_variance.at(spot(row))).max(self.least_share)).collect()
    }

    /// The log-likelihood of each row where this is the scatter, and the rest is what predictions leave.
    pub fn terms(&self, scatter: f64, rows: &Observations, rest: &[Option<f64>], shares: &[f64]) -> Vec<f64> {
        terms(self.axis, scatter, rows, rest, shares)
    }
}
