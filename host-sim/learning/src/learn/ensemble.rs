//! Learns the distribution over robots from logs: what they say of the motion under each command, and how far such biases
//! reach and how large they are.

pub mod holds;
pub mod noise;

use rayon::prelude::*;

use holds::{StepResidual, holds};
use mindgap_logs::{Logs, Robot, samples};
use mindgap_models::simulator::Simulator;
use mindgap_models::simulator::ensemble::basis::{CHANGE, unit_factor};
use mindgap_models::simulator::ensemble::evidence::by_cell;
use mindgap_models::simulator::ensemble::posterior::Likelihood;
use mindgap_models::simulator::ensemble::{Ensemble, Evidence, Held, Member, MotionNoise, PARTS, Posterior};

/// Sizes of the process's parts are sought by factors that get smaller, from this share of the robot's chance in a step.
const FIRST_SIZE: f64 = 0.5;
const FACTORS: [f64; 4] = [4.0, 4.0, 2.0, 1.4];

/// Parts of the logs that are left out in turn.
const FOLDS: usize = 5;

/// How much a wheel may have changed since training, as a share: the one under which the runs are most probable.
const CHANGES: [f64; 4] = [0.0, 0.02, 0.06, 0.2];

/// The distribution that the training logs of a simulator leave; none without motion networks and what is normal beyond
/// them.
pub fn learn(simulator: &Simulator, logs: &Logs) -> Option<Ensemble> {
    let networks = simulator.motion_networks()?;
    let steps = residuals(simulator, logs)?;
    // Noise is what a process leaves, and how large the process is depends on noise.
    let plain = given(&steps, &networks, noise::rough(&steps));
    let pieces = noise::pieces(&steps);
    let middles = without_each_fold(&pieces, &plain, &networks)?;
    let middle = |piece: usize| &middles[piece % FOLDS];
    Some(given(&steps, &networks, noise::learn(&pieces, middle, &networks)))
}

/// The robot in the middle by all pieces of the logs but those of a fold, for each fold: a process that has seen a step leaves
/// too little of it.
fn without_each_fold(pieces: &[&[StepResidual]], plain: &Ensemble, said: Held) -> Option<Vec<Member>> {
    let without = |fold: usize| {
        let others = pieces.iter().enumerate().filter(|(piece, _)| piece % FOLDS != fold);
        let others: Vec<StepResidual> = others.flat_map(|(_, steps)| steps.iter().copied()).collect();
        let evidence = holds(&others).iter().map(|hold| hold.evidence(&plain.noise, said)).collect();
        Some(Posterior::new(&Ensemble { evidence, ..plain.clone() }, said)?.mean())
    };
    (0..FOLDS).into_par_iter().map(without).collect()
}

/// The distribution that steps leave, if noise is this.
fn given(steps: &[StepResidual], said: Held, noise: MotionNoise) -> Ensemble {
    let evidence = by_cell(holds(steps).iter().map(|hold| hold.evidence(&noise, said)), said.scale());
    let factor = unit_factor();
    let typical = |channel: usize| {
        let variances = evidence.iter().map(|e| noise.step_variance(e.motion(said), channel));
        (variances.sum::<f64>() / evidence.len().max(1) as f64).sqrt()
    };
    let sizes = |channel: usize| sizes(&Likelihood::new(&factor, &evidence, &noise, said, channel), typical(channel));
    let prior: Vec<[f64; PARTS]> = (0..3).into_par_iter().map(sizes).collect();
    Ensemble { prior: [prior[0], prior[1], prior[2]], noise, evidence }
}

/// A distribution with what further runs say of the robot, which may have changed since the training logs; `said` is what its
/// networks say.
pub fn conditioned(ensemble: &Ensemble, robot: &Robot, said: Held, steps: &[StepResidual]) -> Ensemble {
    let mut ensemble = ensemble.clone();
    let more = holds(steps).into_iter().map(|hold| hold.evidence(&ensemble.noise, said));
    let more: Vec<Evidence> = more.map(|evidence| Evidence { after_training: true, ..evidence }).collect();
    ensemble.evidence.extend(more);
    let factor = unit_factor();
    let cells = by_cell(ensemble.evidence.iter().copied(), said.scale());
    for (channel, prior) in ensemble.prior.iter_mut().enumerate() {
        let likelihood = Likelihood::new(&factor, &cells, &ensemble.noise, said, channel);
        let of = |change: f64| {
            let mut prior = *prior;
            prior[CHANGE] = change * full(robot)[channel];
            (likelihood.log_evidence(&prior), prior)
        };
        let (_, likeliest) = CHANGES
            .map(of)
            .into_iter()
            .fold((f64::NEG_INFINITY, *prior), |best, other| if other.0 > best.0 { other } else { best });
        *prior = likeliest;
    }
    ensemble
}

/// What one wheel at full command moves a robot in a step: forward (cm), lateral (cm), turn (degrees).
fn full(robot: &Robot) -> [f64; 3] {
    let way_cm = robot.full_speed_cm_s * robot.step_ms / 1000.0;
    [0.5 * way_cm, 0.0, (way_cm / robot.track_cm).to_degrees()]
}

/// What the networks leave of every step of training logs.
fn residuals(simulator: &Simulator, logs: &Logs) -> Option<Vec<StepResidual>> {
    let networks = simulator.motion_networks()?;
    let known = simulator.reference.as_ref()?.motion.as_ref()?;
    let residual = |s: &samples::MotionSample| {
        let (off, correction) = (networks.residual(s), known.correction(&s.speeds));
        StepResidual::new([s.run, s.row], s.speeds, [0, 1, 2].map(|c| off[c] - correction[c]), known)
    };
    Some(samples::motion(logs).iter().map(residual).collect())
}

/// The sizes of the process's parts under which the evidence is most probable, one after the other.
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

    /// A robot that is driven by the same commands for long does what the distribution allows.
    #[test]
    fn held_commands_stay_within_what_is_not_known() {
        let logs = record(&default_robot(), &training_room(), 40, 60, &[], 3).expect("room to drive");
        let simulator = train(&logs, &Trainer::Fast, &TABLE_ONE, 1, &|_| {}).expect("networks");
        let ensemble = simulator.ensemble.clone().expect("a distribution");
        assert!(ensemble.is_sound() && ensemble.evidence.len() > 100);
        let networks = simulator.motion_networks().expect("networks");
        let posterior = Posterior::new(&ensemble, &networks).expect("a posterior");
        let fresh = record(&default_robot(), &training_room(), 40, 60, &[], 4).expect("room to drive");
        let steps = residuals(&simulator, &fresh).expect("residuals");
        let mut squares = [0.0; 3];
        let held: Vec<holds::Hold> = holds(&steps).into_iter().filter(|hold| !hold.first).collect();
        for hold in &held {
            let motion = posterior.motion(hold.command);
            for channel in 0..3 {
                let [mean, deviation] = motion[channel];
                let evidence = hold.evidence(&ensemble.noise, &networks);
                let variance = deviation * deviation + f64::from(evidence.variance[channel]);
                let off = evidence.motion(&networks)[channel] - mean;
                squares[channel] += off * off / variance;
            }
        }
        for (channel, squares) in squares.iter().enumerate() {
            let ratio = squares / held.len() as f64;
            assert!((0.6..1.5).contains(&ratio), "channel {channel}: {ratio}");
        }
    }
}
