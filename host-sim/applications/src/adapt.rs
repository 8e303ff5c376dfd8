//! Adapts a simulator to runs of the robot: first the effects of a diagnosis are added, then the remaining residuals
//! condition the posterior over robots. The networks and the evidence of the training logs are kept.

use schemars::JsonSchema;
use serde::Serialize;

use mindgap_diagnosis::progress::Stage;
use mindgap_diagnosis::verdict::NamedEffect;
use mindgap_diagnosis::{Method, findings_watched};
use mindgap_foundations::error::{Error, Result};
use mindgap_foundations::motion::{Axis, Motion};
use mindgap_learning::evaluation::observations::Observations;
use mindgap_learning::evaluation::predictions;
use mindgap_learning::learn::ensemble::conditioned;
use mindgap_learning::learn::ensemble::holds::{Hold, StepResidual, holds};
use mindgap_logs::inspection::Inspection;
use mindgap_logs::robot::same_robot;
use mindgap_logs::samples::RowId;
use mindgap_logs::{Logs, Robot};
use mindgap_models::effects::applied::AppliedEffect;
use mindgap_models::simulator::Simulator;
use mindgap_models::simulator::baseline::{Baseline, MotionModel};
use mindgap_models::simulator::ensemble::basis::CHANGE;
use mindgap_models::simulator::ensemble::posterior::log_evidence;
use mindgap_models::simulator::ensemble::{Ensemble, Held, Posterior};

/// Log evidence in nats by which effects must beat a bias per command: strong evidence.
const EFFECT_NATS: f64 = 5.0;
/// Factor on the errors of held-out runs beyond which effects predict worse than biases do. Evidence alone can favour an
/// effect that misleads wherever the logged runs did not drive.
const WORSE: f64 = 1.1;
/// Maximum number of cross-validation folds.
const PARTS: usize = 8;
/// Commands held for fewer steps than this are not reported.
const FEWEST_STEPS: usize = 2;

/// An adapted simulator and what it learned.
pub struct Adapted {
    /// The adapted simulator.
    pub simulator: Simulator,
    /// The simulator adapted by biases alone, if effects on the motion are used.
    pub without_effects: Option<Simulator>,
    /// What was learned.
    pub lesson: Lesson,
}

/// What was learned from the runs of a robot.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Lesson {
    /// Effects that the diagnosis named and that were added to the simulator.
    pub effects: Vec<AppliedEffect>,
    /// All effects that the diagnosis named.
    pub causes: Vec<Cause>,
    /// Corrections per command, largest change first.
    pub commands: Vec<CommandBias>,
    /// Error per step on held-out runs, before and after; null for a single run.
    pub gap: Option<Gap>,
}

/// An effect that the diagnosis of the runs named.
#[derive(Clone, Debug, PartialEq, Serialize, serde::Deserialize, JsonSchema)]
pub struct Cause {
    /// Its id.
    pub id: String,
    /// Its probability, 0..=1.
    pub probability: f64,
    /// Ids of effects that these runs cannot distinguish from it.
    pub ambiguous_with: Vec<String>,
    /// Whether it was added to the simulator; if not, a bias per command predicts the runs better.
    pub used: bool,
}

/// Bias of a command relative to the networks: forward (cm), lateral (cm) and turn (degrees) per step, each with its
/// standard deviation.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct CommandBias {
    /// Left and right command.
    pub command: [f64; 2],
    /// Number of steps for which the command was held.
    pub steps: usize,
    /// Bias before adaptation.
    pub before: Motion<[f64; 2]>,
    /// Bias after adaptation.
    pub after: Motion<[f64; 2]>,
}

/// Root-mean-square error per step of held commands, each `[before, after]` adaptation.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, serde::Deserialize, JsonSchema)]
pub struct Gap {
    /// Forward error, cm.
    pub forward_cm: [f64; 2],
    /// Lateral error, cm.
    pub lateral_cm: [f64; 2],
    /// Turn error, degrees.
    pub turn_deg: [f64; 2],
}

/// Adapts a simulator to logs of its robot. `seed` is the seed of the diagnosis, and `watch` is called when each of its
/// stages begins.
///
/// # Errors
/// If the simulator has no posterior, the logs are of another robot, or they contain no step with poses at both ends.
pub fn adapt(simulator: &Simulator, logs: &Logs, seed: u64, watch: impl Fn(Stage)) -> Result<Adapted> {
    same_robot(&simulator.robot, &logs.robot)?;
    let missing = || Error::new("the simulator file has no parameter uncertainty: train it again");
    let ensemble = simulator.ensemble.as_ref().ok_or_else(missing)?;
    let robot = &simulator.robot;
    let baseline = Baseline::at_posterior_mean(simulator)?;
    let observations = Observations::of(logs, baseline.motion.as_ref(), None);
    let plain = steps(&baseline, &[], &observations);
    if plain.is_empty() {
        return Err(Error::new("the runs contain no step with a pose at both ends: nothing to adapt to"));
    }
    let (effects, causes) = diagnosed(baseline.clone(), logs, seed, watch);
    let explained = steps(&baseline, &effects, &observations);
    let networks = simulator.motion_networks().ok_or_else(missing)?;
    let said: Held = &networks;
    let given = |steps: &[StepResidual]| conditioned(ensemble, robot, said, steps);
    let probability = |steps: &[StepResidual]| probability(given(steps), said);
    let held_out = |steps: &[StepResidual]| held_out(ensemble, robot, said, &plain, steps);
    let moves = explained != plain;
    let raises_likelihood = || probability(&explained) > probability(&plain) + EFFECT_NATS;
    let misleads =
        |gap: &Option<Gap>| moves && gap.zip(held_out(&plain)).is_some_and(|(with, without)| with.is_worse(&without));
    let gap_with = (!moves || raises_likelihood()).then(|| held_out(&explained)).filter(|gap| !misleads(gap));
    let is_used = gap_with.is_some();
    let (effects, steps, gap) = match gap_with {
        Some(gap) => (effects, explained, gap),
        None => (without_motion(&baseline, effects, &observations, &plain), plain.clone(), held_out(&plain)),
    };
    let after = given(&steps);
    let lesson = Lesson {
        commands: commands(&holds(&steps), said, ensemble, &after),
        gap,
        causes: causes.into_iter().map(|cause| Cause::of(cause, &effects)).collect(),
        effects: effects.clone(),
    };
    let with = |effects: Vec<AppliedEffect>, ensemble: Ensemble| {
        let added = [simulator.added.clone(), effects].concat();
        Simulator { added, ensemble: Some(ensemble), ..simulator.clone() }
    };
    let without_effects = (moves && is_used)
        .then(|| with(without_motion(&baseline, effects.clone(), &observations, &plain), given(&plain)));
    Ok(Adapted { simulator: with(effects, after), without_effects, lesson })
}

impl Cause {
    fn of(named: NamedEffect, used: &[AppliedEffect]) -> Self {
        Cause {
            used: used.iter().any(|effect| effect.effect == named.id),
            id: named.id.into(),
            probability: named.probability,
            ambiguous_with: named.ambiguous_with.into_iter().map(str::to_owned).collect(),
        }
    }
}

impl Gap {
    /// Returns whether runs that were not learned from are predicted worse than by another adaptation, all axes together.
    fn is_worse(&self, other: &Gap) -> bool {
        let after = |gap: &Gap| [gap.forward_cm[1], gap.lateral_cm[1], gap.turn_deg[1]];
        let ratios = after(self).into_iter().zip(after(other)).map(|(one, other)| one / other.max(f64::EPSILON));
        ratios.map(|ratio| ratio * ratio).sum::<f64>() > 3.0 * WORSE * WORSE
    }
}

/// Returns the log evidence under the assumption that the robot changed only by effects.
fn probability(mut ensemble: Ensemble, said: Held) -> f64 {
    ensemble.prior.iter_mut().for_each(|prior| prior[CHANGE] = 0.0);
    log_evidence(&ensemble, said)
}

/// Returns the effects that do not change the motion, such as those of the sensor.
fn without_motion(
    baseline: &Baseline,
    mut effects: Vec<AppliedEffect>,
    observations: &Observations,
    plain: &[StepResidual],
) -> Vec<AppliedEffect> {
    effects.retain(|effect| steps(baseline, std::slice::from_ref(effect), observations) == plain);
    effects
}

/// Returns the effects that a diagnosis names, as a simulator stores them and with their probabilities; empty if the logs do
/// not suffice for a diagnosis.
fn diagnosed(
    baseline: Baseline,
    logs: &Logs,
    seed: u64,
    watch: impl Fn(Stage),
) -> (Vec<AppliedEffect>, Vec<NamedEffect>) {
    let method = Method { seed, ..Method::default() };
    let found = findings_watched(baseline, &Inspection::new(logs.clone()), method, watch);
    found.map_or_else(|_| Default::default(), |found| (found.applied, found.diagnosis.effects))
}

/// Returns the residual of every logged step, with these effects in addition to those of the simulator. Effects act on
/// the robot as known from training, so its bias relative to the networks is added back.
fn steps(baseline: &Baseline, effects: &[AppliedEffect], observations: &Observations) -> Vec<StepResidual> {
    let Some(motion @ MotionModel::Learned { reference, .. }) = &baseline.motion else { return Vec::new() };
    let chain = baseline.chain_with(effects);
    let step = |row: &mindgap_learning::evaluation::observations::Observation| {
        let [now, before, ..] = row.context.commands;
        let left = predictions::residual(&chain, motion, row).filter(|_| row.following_steps.is_empty())?;
        let beyond = motion.beyond(now);
        let id = RowId { run: row.run, row: row.at };
        let off = Motion::from(left) + beyond;
        Some(StepResidual::new(id, [now[0], now[1], before[0], before[1]], off, reference))
    };
    observations.rows.iter().filter_map(step).collect()
}

/// Returns the held commands with their bias before and after, largest change first.
fn commands(held: &[Hold], said: Held, before: &Ensemble, after: &Ensemble) -> Vec<CommandBias> {
    let [before, after] = [before, after].map(|ensemble| Posterior::new(ensemble, said));
    let (Some(before), Some(after)) = (before, after) else { return Vec::new() };
    let mut steps: std::collections::BTreeMap<[i32; 2], usize> = std::collections::BTreeMap::new();
    for hold in held.iter().filter(|hold| !hold.first) {
        *steps.entry(hold.command.map(|c| c.round() as i32)).or_default() += hold.steps;
    }
    let bias = |(command, steps): (&[i32; 2], &usize)| {
        let command = command.map(f64::from);
        let networks = said.motion(command);
        let bias = |of: &Posterior| {
            of.motion(command).zip_with(networks, |[mean, deviation], networks| [mean - networks, deviation])
        };
        CommandBias { command, steps: *steps, before: bias(&before), after: bias(&after) }
    };
    let mut known: Vec<CommandBias> = steps.iter().filter(|(_, steps)| **steps >= FEWEST_STEPS).map(bias).collect();
    known.sort_by(|a, b| b.surprise().total_cmp(&a.surprise()));
    known
}

impl CommandBias {
    /// Returns the change of turn or forward motion in prior standard deviations.
    fn surprise(&self) -> f64 {
        let moved = self.before.zip_with(self.after, |[before, deviation], [after, _]| {
            (after - before).abs() / deviation.max(f64::EPSILON)
        });
        moved.forward.max(moved.turn)
    }
}

/// Returns the cross-validated error: each fold of runs is predicted from the others.
fn held_out(
    ensemble: &Ensemble,
    robot: &Robot,
    said: Held,
    plain: &[StepResidual],
    explained: &[StepResidual],
) -> Option<Gap> {
    let runs = plain.iter().map(StepResidual::run).max()? + 1;
    if runs < 2 {
        return None;
    }
    let before = Posterior::new(ensemble, said)?;
    let (mut sums, mut count) = (Motion::splat([0.0; 2]), 0.0);
    for part in 0..runs.min(PARTS) {
        let kept = |step: &&StepResidual| step.run() % PARTS == part;
        let others: Vec<StepResidual> = explained.iter().filter(|step| !kept(step)).copied().collect();
        let after = Posterior::new(&conditioned(ensemble, robot, said, &others), said)?;
        let of = |steps: &[StepResidual]| holds(&steps.iter().filter(kept).copied().collect::<Vec<_>>());
        for (a, b) in of(plain).iter().zip(&of(explained)) {
            count += a.steps as f64;
            let networks = said.motion(a.command);
            let off = [(a, before.motion(a.command)), (b, after.motion(b.command))];
            for axis in Axis::ALL {
                for (sum, (hold, motion)) in sums[axis].iter_mut().zip(&off) {
                    let left = hold.residual[axis] + hold.known[axis] + networks[axis] - motion[axis][0];
                    *sum += hold.steps as f64 * left * left;
                }
            }
        }
    }
    let rms = sums.map(|pair| pair.map(|sum: f64| (sum / count).sqrt()));
    Some(Gap { forward_cm: rms.forward, lateral_cm: rms.lateral, turn_deg: rms.turn })
}
