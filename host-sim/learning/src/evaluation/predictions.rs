//! What a simulator with effects predicts of logs, next to what was logged.

use std::borrow::Cow;

use super::observations::{Observation, Observations};
use mindgap_foundations::error::Result;
use mindgap_foundations::geometry::{Pose, wrap_rad};
use mindgap_foundations::motion::Motion;
use mindgap_logs::Logs;
use mindgap_models::effects::chain::EffectChain;
use mindgap_models::effects::{SensorState, StepContext};
use mindgap_models::simulator::Simulator;
use mindgap_models::simulator::baseline::{Baseline, MotionModel};
use mindgap_models::sonar::familiar::{self, Familiarity};
use mindgap_models::sonar::{Outcomes, Perturbation, SensorLaw, View};

/// Pairs of logged and predicted values, sample by sample.
#[derive(Clone, Debug, Default)]
pub struct Predictions {
    /// Forward motion, cm.
    pub forward: Vec<[f64; 2]>,
    /// Motion to the left, cm.
    pub lateral: Vec<[f64; 2]>,
    /// Turn, degrees.
    pub turn: Vec<[f64; 2]>,
    /// Echo (one) or none (zero), and the probability of an echo.
    pub echo_probability: Vec<[f64; 2]>,
    /// Reading, cm.
    pub echo_value: Vec<[f64; 2]>,
}

/// Predicts every row of logs by a simulator with the effects that were applied to it.
///
/// # Errors
/// If the simulator file lacks the noise of its training logs.
pub fn predict(simulator: &Simulator, logs: &Logs) -> Result<Predictions> {
    let baseline = Baseline::learned(simulator)?;
    let observations = Observations::of(logs, baseline.motion.as_ref(), baseline.sonar.as_ref());
    let effects = baseline.chain();
    let mut all = Predictions::default();
    for row in &observations.rows {
        if let (Some(drive), Some(logged)) = (&baseline.motion, &row.motion) {
            let predicted = increment(&effects, drive, row);
            all.forward.push([logged.forward, predicted.forward]);
            all.lateral.push([logged.lateral, predicted.lateral]);
            all.turn.push([logged.turn, predicted.turn].map(f64::to_degrees));
        }
        if row.context.faced.is_some()
            && let Some(faced) = facing(&effects, &observations, row)
        {
            let outcomes = faced.outcomes();
            all.echo_probability.push([f64::from(u8::from(row.echo_cm.is_some())), 1.0 - outcomes.none]);
            if let (Some(echo_cm), Some(expected_cm)) = (row.echo_cm, outcomes.mean_hit_cm()) {
                all.echo_value.push([echo_cm, expected_cm]);
            }
        }
    }
    Ok(all)
}

/// Returns the predicted motion of one step.
pub fn step(effects: &EffectChain, drive: &MotionModel, context: &StepContext) -> Motion<f64> {
    if drive.is_learned() {
        effects.wrap(context, |now, before| drive.step(now, before))
    } else {
        effects.wrap_pieces(context, |held| drive.step(held, held))
    }
}

/// Returns the predicted motion of a row's step, or of the steps that are compared as one.
pub fn increment(effects: &EffectChain, drive: &MotionModel, row: &Observation) -> Motion<f64> {
    let is_in_pieces = !drive.is_learned() && !row.context.pieces.is_empty();
    let first = if is_in_pieces {
        step(effects, drive, &row.context)
    } else {
        effects.wrap(&row.context, |now, before| match row.expected {
            Some(expected) if [row.speeds.now, row.speeds.before] == [now, before] => expected,
            _ => drive.step(now, before),
        })
    };
    if row.following_steps.is_empty() {
        return first;
    }
    let start = &row.context.pose;
    let next = |pose: Pose, context: &StepContext| step(effects, drive, &StepContext { pose, ..*context }).end(&pose);
    let end = row.following_steps.iter().fold(first.end(start), next);
    Motion::between(start, &end)
}

/// Returns logged minus predicted motion of a row: forward (cm), lateral (cm), turn (rad). The sum over n steps that are
/// compared as one is divided by √n, since independent noise adds up in squares.
pub fn residual(effects: &EffectChain, drive: &MotionModel, row: &Observation) -> Option<[f64; 3]> {
    let logged = row.motion?;
    let predicted = increment(effects, drive, row);
    let residual = [
        logged.forward - predicted.forward,
        logged.lateral - predicted.lateral,
        wrap_rad(logged.turn - predicted.turn),
    ];
    let steps = row.steps() as f64;
    Some(residual.map(|sum| sum / steps.sqrt()))
}

/// What the sensor faces at a row.
pub struct Faced<'o> {
    law: &'o SensorLaw,
    view: Cow<'o, View>,
    /// How effects perturb its readings.
    pub perturbation: Perturbation,
    /// What earlier readings showed at this pose.
    familiarity: Option<Familiarity>,
}

/// Returns what the sensor faces at a row with these effects, or `None` if the sensor is not compared.
pub fn facing<'o>(effects: &EffectChain, observations: &'o Observations, row: &'o Observation) -> Option<Faced<'o>> {
    facing_in(observations, row, &effects.sensor(&row.context))
}

/// Returns what the sensor faces at a row in a given state.
pub fn facing_in<'o>(observations: &'o Observations, row: &'o Observation, state: &SensorState) -> Option<Faced<'o>> {
    let (law, unchanged) = observations.law.as_ref().zip(row.view.as_ref())?;
    let SensorState { robot, yaw_rad, perturbation } = *state;
    let is_widened = perturbation.width != 1.0 && law.looks_by_width();
    let is_moved = robot != row.context.pose || yaw_rad != 0.0 || is_widened;
    let sensor = observations.surroundings.sensor(&robot, yaw_rad);
    let familiarity = observations.recollection.as_ref().and_then(|recollection| recollection.at(&sensor));
    let view = if is_moved {
        Cow::Owned(law.view(&observations.surroundings.surfaces, &sensor, perturbation.width))
    } else {
        Cow::Borrowed(unchanged)
    };
    Some(Faced { law, view, perturbation, familiarity })
}

impl Faced<'_> {
    /// Returns the distribution of the reading.
    pub fn outcomes(&self) -> Outcomes {
        self.perturbed(&self.perturbation)
    }

    /// Returns the distribution of the reading under another perturbation.
    pub fn perturbed(&self, perturbation: &Perturbation) -> Outcomes {
        familiar::outcomes(self.familiarity.as_ref(), self.law, &self.view, perturbation)
    }
}
