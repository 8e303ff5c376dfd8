//! Learns the distribution over robots from logs: the evidence about the motion under each command, and the reach and size
//! of the biases.

pub mod holds;
pub mod noise;

use rayon::prelude::*;

use super::drive_filter;
use holds::{StepResidual, holds};
use mindgap_foundations::motion::{Axis, Motion};
use mindgap_logs::{Logs, Robot, samples};
use mindgap_models::simulator::Simulator;
use mindgap_models::simulator::ensemble::basis::{CHANGE, unit_factor};
use mindgap_models::simulator::ensemble::evidence::by_cell;
use mindgap_models::simulator::ensemble::posterior::Likelihood;
use mindgap_models::simulator::ensemble::{Ensemble, Evidence, Held, Member, MotionNoise, PARTS, Posterior};

/// Start of the search for the sizes of the process's parts, as a share of the robot's process noise in a step; and the
/// factors by which they are varied.
const FIRST_SIZE: f64 = 0.5;
const FACTORS: [f64; 4] = [4.0, 4.0, 2.0, 1.4];

/// Number of folds of cross-validation.
const FOLDS: usize = 5;

/// Candidate standard deviations of a wheel's change since training, as a share; the one with the largest evidence is
/// chosen.
const CHANGES: [f64; 4] = [0.0, 0.02, 0.06, 0.2];

/// Learns the posterior over robots from the training logs of a simulator; `None` without motion networks and their
/// reference.
pub fn learn(simulator: &Simulator, logs: &Logs) -> Option<Ensemble> {
    let networks = simulator.motion_networks()?;
    let steps = residuals(simulator, logs)?;
    // The noise is the residual of the process, and the size of the process depends on the noise.
    let plain = given(&steps, &networks, noise::rough(&steps));
    let pieces = noise::pieces(&steps);
    let middles = without_each_fold(&pieces, &plain, &networks)?;
    let middle = |piece: usize| &middles[piece % FOLDS];
    Some(given(&steps, &networks, noise::learn(&pieces, middle, &networks)))
}

/// Returns the posterior mean without each fold of the pieces: residuals of a process that was fitted to a step are too
/// small.
fn without_each_fold(pieces: &[&[StepResidual]], plain: &Ensemble, said: Held) -> Option<Vec<Member>> {
    let without = |fold: usize| {
        let others = pieces.iter().enumerate().filter(|(piece, _)| piece % FOLDS != fold);
        let others: Vec<StepResidual> = others.flat_map(|(_, steps)| steps.iter().copied()).collect();
        let evidence = holds(&others).iter().map(|hold| hold.evidence(&plain.noise, said)).collect();
        Some(Posterior::new(&Ensemble { evidence, ..plain.clone() }, said)?.mean())
    };
    (0..FOLDS).into_par_iter().map(without).collect()
}

/// Returns the posterior given steps and their noise.
fn given(steps: &[StepResidual], said: Held, noise: MotionNoise) -> Ensemble {
    let evidence = by_cell(holds(steps).iter().map(|hold| hold.evidence(&noise, said)), said.scale());
    let factor = unit_factor();
    let typical = |axis: Axis| {
        let variances = evidence.iter().map(|e| noise.step_variance(e.motion(said), axis));
        (variances.sum::<f64>() / evidence.len().max(1) as f64).sqrt()
    };
    let sizes = |axis: Axis| sizes(&Likelihood::new(&factor, &evidence, &noise, said, axis), typical(axis));
    let prior: Vec<[f64; PARTS]> = Axis::ALL.into_par_iter().map(sizes).collect();
    Ensemble { prior: Motion::from_fn(|axis| prior[axis as usize]), noise, evidence }
}

/// Conditions a distribution on further runs of a robot that may have changed since the training logs; `said` returns the
/// predictions of its networks.
pub fn conditioned(ensemble: &Ensemble, robot: &Robot, said: Held, steps: &[StepResidual]) -> Ensemble {
    let mut ensemble = ensemble.clone();
    let more = holds(steps).into_iter().map(|hold| hold.evidence(&ensemble.noise, said));
    let more: Vec<Evidence> = more.map(|evidence| Evidence { after_training: true, ..evidence }).collect();
    ensemble.evidence.extend(more);
    let factor = unit_factor();
    let cells = by_cell(ensemble.evidence.iter().copied(), said.scale());
    for (axis, prior) in Axis::ALL.into_iter().zip(ensemble.prior.iter_mut()) {
        let likelihood = Likelihood::new(&factor, &cells, &ensemble.noise, said, axis);
        let evidence_of = |change: f64| {
            let mut prior = *prior;
            prior[CHANGE] = change * full(robot)[axis];
            (likelihood.log_evidence(&prior), prior)
        };
        let (_, most_likely) = CHANGES
            .map(evidence_of)
            .into_iter()
            .fold((f64::NEG_INFINITY, *prior), |best, other| if other.0 > best.0 { other } else { best });
        *prior = most_likely;
    }
    ensemble
}

/// Returns the motion of a robot in a step with one wheel at full command; the turn is in degrees.
fn full(robot: &Robot) -> Motion<f64> {
    let distance_cm = robot.full_speed_cm_s * robot.step_ms / 1000.0;
    Motion { forward: 0.5 * distance_cm, lateral: 0.0, turn: distance_cm / robot.track_cm }.turn_in_degrees()
}

/// Returns the residuals of the networks for every step of training logs.
fn residuals(simulator: &Simulator, logs: &Logs) -> Option<Vec<StepResidual>> {
    let networks = simulator.motion_networks()?;
    let known = simulator.reference.as_ref()?.motion.as_ref()?;
    // What is held is a command; what the networks see of it comes out of the filter.
    let residual = |(sent, filtered): (samples::MotionSample, samples::MotionSample)| {
        let left = networks.residual(&filtered) - known.correction(&filtered.speeds);
        StepResidual::new(sent.id(), sent.speeds, left, known)
    };
    Some(samples::steps(logs).zip(drive_filter::steps(simulator.filter, logs)).map(residual).collect())
}

/// Returns the sizes of the process's parts that maximise the evidence, by coordinate ascent.
fn sizes(likelihood: &Likelihood, noise: f64) -> [f64; PARTS] {
    let mut best = [FIRST_SIZE * noise; PARTS];
    best[CHANGE] = 0.0;
    let mut most = likelihood.log_evidence(&best);
    for factor in FACTORS {
        for part in 0..CHANGE {
            for by in [factor, 1.0 / factor] {
                let mut tried = best;
                tried[part] *= by;
                let probable = likelihood.log_evidence(&tried);
                if probable > most {
                    (best, most) = (tried, probable);
                }
            }
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::learn::train::{TABLE_ONE, Trainer, train};
    use mindgap_built_in_robot::{default_robot, record, training_room};
    use mindgap_foundations::executor::Serial;

    /// The motion of a robot under long-held commands agrees with the distribution.
    #[test]
    fn held_commands_agree_with_the_posterior() {
        let logs = record(&default_robot(), &training_room(), 40, 60, &[], 3).expect("room to drive");
        let simulator = train(&Serial, &logs, &Trainer::Fast, &TABLE_ONE, 1, &|_| {}).expect("networks");
        let ensemble = simulator.ensemble.clone().expect("a distribution");
        assert!(ensemble.is_sound() && ensemble.evidence.len() > 100);
        let networks = simulator.motion_networks().expect("networks");
        let posterior = Posterior::new(&ensemble, &networks).expect("a posterior");
        let fresh = record(&default_robot(), &training_room(), 40, 60, &[], 4).expect("room to drive");
        let steps = residuals(&simulator, &fresh).expect("residuals");
        let mut squares = Motion::ZERO;
        let held: Vec<holds::Hold> = holds(&steps).into_iter().filter(|hold| !hold.first).collect();
        for hold in &held {
            let motion = posterior.motion(hold.command);
            for axis in Axis::ALL {
                let [mean, deviation] = motion[axis];
                let evidence = hold.evidence(&ensemble.noise, &networks);
                let variance = deviation * deviation + f64::from(evidence.variance[axis]);
                let off = evidence.motion(&networks)[axis] - mean;
                squares[axis] += off * off / variance;
            }
        }
        for (axis, squares) in Axis::ALL.into_iter().zip(squares) {
            let ratio = squares / held.len() as f64;
            assert!((0.6..1.5).contains(&ratio), "{axis:?}: {ratio}");
        }
    }
}
