//! What a simulator with effects predicts of logs, beside what was logged.

use std::borrow::Cow;

use super::observations::{Observation, Observations};
use mindgap_foundations::error::Result;
use mindgap_foundations::geometry::wrap_rad;
use mindgap_logs::Logs;
use mindgap_models::effects::chain::EffectChain;
use mindgap_models::effects::{PoseIncrement, SensorState, StepContext};
use mindgap_models::simulator::Simulator;
use mindgap_models::simulator::baseline::{Baseline, MotionModel};
use mindgap_models::sonar::familiar::{self, Familiarity};
use mindgap_models::sonar::{Outcomes, Perturbation, SensorLaw, View};

/// Logged and predicted, sample by sample.
#[derive(Clone, Debug, Default)]
pub struct Predictions {
    /// Way forward, cm.
    pub forward: Vec<[f64; 2]>,
    /// Way to the left, cm.
    pub lateral: Vec<[f64; 2]>,
    /// Turn, degrees.
    pub turn: Vec<[f64; 2]>,
    /// One for an echo and zero for none, and the probability of one.
    pub echo_probability: Vec<[f64; 2]>,
    /// The reading, cm.
    pub echo_value: Vec<[f64; 2]>,
}

/// Predicts every row of logs by a simulator with the effects that were applied to it.
///
/// # Errors
/// When the simulator does not know how its training logs scattered.
pub fn predict(simulator: &Simulator, logs: &Logs) -> Result<Predictions> {
    let baseline = Baseline::learned(simulator)?;
    let observations = Observations::of(logs, baseline.sonar.as_ref());
    let effects = EffectChain::of(&baseline.applied);
    let mut all = Predictions::default();
    for row in &observations.rows {
        if let (Some(drive), Some(logged)) = (&baseline.motion, &row.motion) {
            let predicted = increment(&effects, drive, row);
            all.forward.push([logged.forward_cm, predicted.forward_cm]);
            all.lateral.push([logged.lateral_cm, predicted.lateral_cm]);
            all.turn.push([logged.turn_rad, predicted.turn_rad].map(f64::to_degrees));
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

/// The predicted increment of one step.
pub fn step(effects: &EffectChain, drive: &MotionModel, context: &StepContext) -> PoseIncrement {
    effects.wrap(context, |now, before| drive.step(now, before))
}

/// The predicted increment of a row's step, or of the steps that are judged as one.
pub fn increment(effects: &EffectChain, drive: &MotionModel, row: &Observation) -> PoseIncrement {
    let usual = [row.context.commands[0], row.context.commands[1]];
    let first = effects.wrap(&row.context, |now, before| match row.expected {
        Some(expected) if usual == [now, before] => expected,
        _ => drive.step(now, before),
    });
    if row.then.is_empty() {
        return first;
    }
    let start = &row.context.pose;
    let end = row
        .then
        .iter()
        .fold(first.from(start), |pose, context| step(effects, drive, &StepContext { pose, ..*context }).from(&pose));
    PoseIncrement::between(start, &end)
}

/// Logged minus predicted of a row, a step: forward (cm), lateral (cm), turn (rad).
pub fn residual(effects: &EffectChain, drive: &MotionModel, row: &Observation) -> Option<[f64; 3]> {
    let logged = row.motion?;
    let predicted = increment(effects, drive, row);
    let off = [
        logged.forward_cm - predicted.forward_cm,
        logged.lateral_cm - predicted.lateral_cm,
        wrap_rad(logged.turn_rad - predicted.turn_rad),
    ];
    // Independent noise adds up over steps that are judged as one.
    let steps = (1 + row.then.len()) as f64;
    Some(off.map(|off| off / steps.sqrt()))
}

/// What the sensor faces at a row.
pub struct Faced<'o> {
    /// Its law.
    law: &'o SensorLaw,
    /// What that looks at.
    view: Cow<'o, View>,
    /// How its readings are perturbed.
    pub change: Perturbation,
    /// What is known of its pose.
    pub familiarity: Option<Familiarity>,
}

/// What the sensor faces at a row with these effects; none where no law of it is known.
pub fn facing<'o>(effects: &EffectChain, observations: &'o Observations, row: &'o Observation) -> Option<Faced<'o>> {
    facing_in(observations, row, &effects.sensor(&row.context))
}

/// What it faces at a row in a state.
pub fn facing_in<'o>(observations: &'o Observations, row: &'o Observation, state: &SensorState) -> Option<Faced<'o>> {
    let (law, usual) = observations.law.as_ref().zip(row.view.as_ref())?;
    let SensorState { robot, yaw_rad, perturbation: change } = *state;
    let widened = change.width != 1.0 && law.looks_by_width();
    let moved = robot != row.context.pose || yaw_rad != 0.0 || widened;
    let sensor = observations.surroundings.sensor(&robot, yaw_rad);
    let familiarity = observations.recollection.as_ref().and_then(|recollection| recollection.at(&sensor));
    let view = if moved {
        Cow::Owned(law.view(&observations.surroundings.surfaces, &sensor, change.width))
    } else {
        Cow::Borrowed(usual)
    };
    Some(Faced { law, view, change, familiarity })
}

impl Faced<'_> {
    /// What the sensor may report.
    pub fn outcomes(&self) -> Outcomes {
        self.perturbed(&self.change)
    }

    /// The same with another perturbation.
    pub fn perturbed(&self, change: &Perturbation) -> Outcomes {
        familiar::outcomes(self.familiarity.as_ref(), self.law, &self.view, change)
    }
}
