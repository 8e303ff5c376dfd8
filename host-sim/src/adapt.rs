//! Adapts a simulator to runs of the robot: a diagnosis of them first, then what no effect explains conditions the
//! distribution over robots. The networks stay as they are, and what training logs said stays known.

use serde::Serialize;

use crate::effects::applied::AppliedEffect;
use crate::effects::chain::EffectChain;
use crate::error::{Error, Result};
use crate::evaluation::observations::Observations;
use crate::evaluation::predictions;
use crate::gap::progress::Stage;
use crate::gap::{Method, findings_watched, validate};
use crate::inspection::Inspection;
use crate::learn::ensemble::conditioned;
use crate::learn::ensemble::holds::{Hold, StepResidual, holds};
use crate::logs::{Logs, Robot};
use crate::simulator::Simulator;
use crate::simulator::baseline::{Baseline, MotionModel};
use crate::simulator::ensemble::basis::CHANGE;
use crate::simulator::ensemble::posterior::log_evidence;
use crate::simulator::ensemble::{Ensemble, Held, Posterior};

/// Effects have to explain the motion better than a bias by command does, by so many nats: strong evidence.
const EFFECT_NATS: f64 = 5.0;
/// Runs are kept back in so many parts at most.
const PARTS: usize = 8;
/// Commands held for fewer steps than this are not told.
const FEWEST_STEPS: usize = 2;

/// An adapted simulator and what it learned.
pub struct Adapted {
    /// The simulator.
    pub simulator: Simulator,
    /// What was learned.
    pub lesson: Lesson,
}

/// What runs told of a robot.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Lesson {
    /// Effects that the diagnosis named, and that were added.
    pub effects: Vec<AppliedEffect>,
    /// Commands whose motion is known better now, those that differ most first.
    pub commands: Vec<CommandBias>,
    /// What simulated steps are off by on runs kept back, before and after; none of a single run.
    pub gap: Option<Gap>,
}

/// The bias of a command: forward (cm), lateral (cm) and turn (degrees) of a step, each with its standard deviation.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CommandBias {
    /// Left and right command.
    pub command: [f64; 2],
    /// Steps for which it was held.
    pub steps: usize,
    /// Before.
    pub before: [[f64; 2]; 3],
    /// After.
    pub after: [[f64; 2]; 3],
}

/// Root mean square of what the steps of held commands are off by, the first number before and the second after adapting.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, serde::Deserialize)]
pub struct Gap {
    /// Forward.
    pub forward_cm: [f64; 2],
    /// To the left.
    pub lateral_cm: [f64; 2],
    /// Turn.
    pub turn_deg: [f64; 2],
}

/// Adapts a simulator to logs of the robot that it stands for; `seed` fixes the draws of the diagnosis, and `watch` is told each
/// of its stages when it begins.
///
/// # Errors
/// When the simulator does not say what its training logs left open, or the logs are another robot's or hold no step.
pub fn adapt(simulator: &Simulator, logs: &Logs, seed: u64, watch: impl Fn(Stage)) -> Result<Adapted> {
    validate::same_robot(&simulator.robot, &logs.robot)?;
    let missing = || Error::new("the simulator file does not say what its training logs leave open: train it again");
    let ensemble = simulator.ensemble.as_ref().ok_or_else(missing)?;
    let robot = &simulator.robot;
    let baseline = Baseline::of_middle(simulator)?;
    let observations = Observations::of(logs, baseline.motion.as_ref(), None);
    let plain = steps(&baseline, &[], &observations);
    if plain.is_empty() {
        return Err(Error::new("the runs hold no step with a pose at both ends: there is nothing to adapt to"));
    }
    let effects = diagnosed(baseline.clone(), logs, seed, watch);
    let explained = steps(&baseline, &effects, &observations);
    let networks = simulator.motion_networks().ok_or_else(missing)?;
    let said: Held = &networks;
    let given = |steps: &[StepResidual]| conditioned(ensemble, robot, said, steps);
    let probability = |steps: &[StepResidual]| probability(given(steps), said);
    let named = explained == plain || probability(&explained) > probability(&plain) + EFFECT_NATS;
    let (effects, steps) = if named {
        (effects, explained)
    } else {
        (of_no_motion(&baseline, effects, &observations, &plain), plain.clone())
    };
    let after = given(&steps);
    let lesson = Lesson {
        commands: commands(&holds(&steps), said, ensemble, &after),
        gap: kept_back(ensemble, robot, said, &plain, &steps),
        effects: effects.clone(),
    };
    let mut simulator = simulator.clone();
    simulator.added.extend(effects);
    simulator.ensemble = Some(after);
    Ok(Adapted { simulator, lesson })
}

/// How probable all evidence is, if the robot did not change but by effects.
fn probability(mut ensemble: Ensemble, said: Held) -> f64 {
    ensemble.prior.iter_mut().for_each(|prior| prior[CHANGE] = 0.0);
    log_evidence(&ensemble, said)
}

/// Those of the effects that leave the motion alone, as those of the sensor do.
fn of_no_motion(
    baseline: &Baseline,
    mut effects: Vec<AppliedEffect>,
    observations: &Observations,
    plain: &[StepResidual],
) -> Vec<AppliedEffect> {
    effects.retain(|effect| steps(baseline, std::slice::from_ref(effect), observations) == plain);
    effects
}

/// The effects that a diagnosis names; none where the logs do not suffice for one.
fn diagnosed(baseline: Baseline, logs: &Logs, seed: u64, watch: impl Fn(Stage)) -> Vec<AppliedEffect> {
    let method = Method { seed, ..Method::default() };
    let found = findings_watched(baseline, &Inspection::of(logs.clone()), method, watch);
    found.map_or_else(|_| Vec::new(), |found| found.applied)
}

/// What every logged step is off by, with these effects beside those that were added before. Effects act on the robot as it
/// was known in training, and what that does beyond the networks is no news.
fn steps(baseline: &Baseline, effects: &[AppliedEffect], observations: &Observations) -> Vec<StepResidual> {
    let Some(motion @ MotionModel::Learned { reference, .. }) = &baseline.motion else { return Vec::new() };
    let applied: Vec<AppliedEffect> = baseline.applied.iter().chain(effects).cloned().collect();
    let chain = EffectChain::of(&applied);
    let step = |row: &crate::evaluation::observations::Observation| {
        let [now, before, ..] = row.context.commands;
        let left = predictions::residual(&chain, motion, row).filter(|_| row.following_steps.is_empty())?;
        let beyond = motion.beyond(now);
        let off = [0, 1, 2].map(|channel| left[channel] + beyond[channel]);
        Some(StepResidual::new([row.run, row.at], [now[0], now[1], before[0], before[1]], off, reference))
    };
    observations.rows.iter().filter_map(step).collect()
}

/// The commands that were held, with what is known of them before and after; those that differ most first.
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
            let motion = of.motion(command);
            [0, 1, 2].map(|c| [motion[c][0] - networks[c], motion[c][1]])
        };
        CommandBias { command, steps: *steps, before: bias(&before), after: bias(&after) }
    };
    let mut known: Vec<CommandBias> = steps.iter().filter(|(_, steps)| **steps >= FEWEST_STEPS).map(bias).collect();
    known.sort_by(|a, b| b.surprise().total_cmp(&a.surprise()));
    known
}

impl CommandBias {
    /// How far the turn or the way forward moved, in standard deviations of what was known.
    fn surprise(&self) -> f64 {
        let moved = |c: usize| (self.after[c][0] - self.before[c][0]).abs() / self.before[c][1].max(f64::EPSILON);
        moved(0).max(moved(2))
    }
}

/// The gap on runs kept back: each part is predicted from the others.
fn kept_back(
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
    let (mut sums, mut count) = ([[0.0; 2]; 3], 0.0);
    for part in 0..runs.min(PARTS) {
        let kept = |step: &&StepResidual| step.run() % PARTS == part;
        let others: Vec<StepResidual> = explained.iter().filter(|step| !kept(step)).copied().collect();
        let after = Posterior::new(&conditioned(ensemble, robot, said, &others), said)?;
        let of = |steps: &[StepResidual]| holds(&steps.iter().filter(kept).copied().collect::<Vec<_>>());
        for (a, b) in of(plain).iter().zip(&of(explained)) {
            count += a.steps as f64;
            let networks = said.motion(a.command);
            let off = [(a, before.motion(a.command)), (b, after.motion(b.command))];
            for channel in 0..3 {
                for (sum, (hold, motion)) in sums[channel].iter_mut().zip(&off) {
                    let left = hold.residual[channel] + hold.known[channel] + networks[channel] - motion[channel][0];
                    *sum += hold.steps as f64 * left * left;
                }
            }
        }
    }
    let [forward_cm, lateral_cm, turn_deg] = sums.map(|pair| pair.map(|sum: f64| (sum / count).sqrt()));
    Some(Gap { forward_cm, lateral_cm, turn_deg })
}
