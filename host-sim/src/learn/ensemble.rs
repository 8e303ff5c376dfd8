//! Learns the distribution over robots from logs: what they say of the motion under each command, and how far such biases
//! reach and how large they are.

pub mod holds;

use std::collections::BTreeMap;

use rayon::prelude::*;

use crate::logs::{Logs, samples};
use crate::simulator::Simulator;
use crate::simulator::ensemble::basis::{CHANGE, unit_factor};
use crate::simulator::ensemble::posterior::Likelihood;
use crate::simulator::ensemble::{Ensemble, Evidence, Held, Member, PARTS, Posterior};
use holds::{Hold, MotionNoise, StepResidual, holds};

/// Training logs are summed up over commands as far apart as this: finer than friction bends.
const CELL: f32 = 4.0;
/// Sizes of the process's parts are sought by factors that get smaller, from this share of the robot's chance in a step.
const FIRST_SIZE: f64 = 0.5;
const FACTORS: [f64; 4] = [4.0, 4.0, 2.0, 1.4];
/// Chance that lasts is sought up to so many times what a step adds, in such parts of it: finer than logs tell it.
const MOST_TIMES: u32 = 2;
const PARTS_OF_ONE: u32 = 20;

/// How much a wheel may have changed since training, as a share: the one under which the runs are most probable.
const CHANGES: [f64; 4] = [0.0, 0.02, 0.06, 0.2];

/// The distribution that the training logs of a simulator leave; none without motion networks and what is normal beyond
/// them.
pub fn learn(simulator: &Simulator, logs: &Logs) -> Option<Ensemble> {
    let noise = MotionNoise::of(simulator)?;
    let networks = simulator.motion_networks()?;
    let said = |command: [f64; 2]| networks.held(command);
    let stretches = holds(&residuals(simulator, logs)?);
    // Chance is what a process leaves, and how large the process is depends on chance.
    let plain = given(&stretches, &noise, &said, Chance::default());
    let middle = Posterior::new(&plain, &said)?.mean();
    Some(given(&stretches, &noise, &said, Chance::of(&stretches, &noise, &middle, &said)))
}

/// The distribution that stretches of steps leave, if chance is this.
fn given(stretches: &[Hold], noise: &MotionNoise, said: Held, chance: Chance) -> Ensemble {
    let Chance { first_step, lasting } = chance;
    let evidence = summed(stretches.iter().map(|hold| hold.evidence(noise, &first_step, &lasting)));
    let factor = unit_factor();
    let sizes = |channel: usize| sizes(&Likelihood::new(&factor, &evidence, said, channel), noise.typical(channel));
    let prior: Vec<[f64; PARTS]> = (0..3).into_par_iter().map(sizes).collect();
    Ensemble { prior: [prior[0], prior[1], prior[2]], first_step, lasting, evidence }
}

/// A distribution with what further runs say of the robot, which may have changed since the training logs; `said` is what its
/// networks say.
pub fn conditioned(ensemble: &Ensemble, noise: &MotionNoise, said: Held, steps: &[StepResidual]) -> Ensemble {
    let mut ensemble = ensemble.clone();
    let stretches = holds(steps);
    let more = stretches.iter().map(|hold| hold.evidence(noise, &ensemble.first_step, &ensemble.lasting));
    let more: Vec<Evidence> = more.map(|evidence| Evidence { after_training: true, ..evidence }).collect();
    ensemble.evidence.extend(more);
    let factor = unit_factor();
    for (channel, prior) in ensemble.prior.iter_mut().enumerate() {
        let likelihood = Likelihood::new(&factor, &ensemble.evidence, said, channel);
        let of = |change: f64| {
            let mut prior = *prior;
            prior[CHANGE] = change * noise.full(channel);
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

/// What the networks leave of every step of training logs.
fn residuals(simulator: &Simulator, logs: &Logs) -> Option<Vec<StepResidual>> {
    let networks = simulator.motion_networks()?;
    let known = simulator.reference.as_ref()?.motion.as_ref()?;
    let residual = |s: &samples::MotionSample| {
        let m = networks.step(s.speeds.map(|v| v as f32));
        let correction = known.correction(&s.speeds);
        let predicted = [m.forward_cm, m.lateral_cm, m.turn_rad].map(f64::from);
        let off = [s.forward_cm - predicted[0], s.lateral_cm - predicted[1], s.turn_rad - predicted[2]];
        StepResidual::new([s.run, s.row], s.speeds, [0, 1, 2].map(|c| off[c] - correction[c]), known)
    };
    Some(samples::motion(logs).iter().map(residual).collect())
}

/// What a robot does that neither its command says nor a step alone draws, as standard deviations.
#[derive(Clone, Copy, Default)]
struct Chance {
    first_step: [f64; 3],
    lasting: [f64; 3],
}

impl Chance {
    /// What is left of stretches by the robot in the middle of a distribution that they leave.
    fn of(stretches: &[Hold], noise: &MotionNoise, middle: &Member, said: Held) -> Self {
        let mut chance = Chance::default();
        for channel in 0..3 {
            let process = |hold: &Hold| noise.process_variance(hold.command, channel);
            let left = |hold: &Hold| {
                let (does, says) = (middle.motion(hold.command), said(hold.command));
                let off = hold.residual[channel] + hold.known[channel] + says[channel] - does[channel];
                off * off
            };
            let steady = stretches.iter().filter(|hold| !hold.first);
            let lasting = likeliest(steady.map(|hold| [left(hold), noise.variance(hold, channel), process(hold)]));
            let typical = noise.typical(channel);
            let of_first = |hold: &Hold| {
                let known = noise.variance(hold, channel) + lasting * lasting * process(hold);
                [left(hold), known, typical * typical]
            };
            let first = likeliest(stretches.iter().filter(|hold| hold.first).map(of_first));
            (chance.lasting[channel], chance.first_step[channel]) = (lasting, first * typical);
        }
        chance
    }
}

/// How many times a standard deviation adds to what is known of chance, such that squares of residuals are the most probable:
/// of each stretch its square, the variance that is known, and the one that is added.
fn likeliest(stretches: impl Iterator<Item = [f64; 3]>) -> f64 {
    let stretches: Vec<[f64; 3]> = stretches.collect();
    let log_likelihood = |times: f64| {
        let of = |[square, known, added]: &[f64; 3]| {
            let variance = known + times * times * added;
            -0.5 * (libm::log(variance) + square / variance)
        };
        stretches.iter().map(of).sum::<f64>()
    };
    let grid = (0..=MOST_TIMES * PARTS_OF_ONE).map(|i| f64::from(i) / f64::from(PARTS_OF_ONE));
    let known = grid.map(|times| (log_likelihood(times), times));
    known.fold((f64::NEG_INFINITY, 0.0), |best, other| if other.0 > best.0 { other } else { best }).1
}

/// Evidence of commands that lie together as one.
fn summed(evidence: impl Iterator<Item = Evidence>) -> Vec<Evidence> {
    let mut cells: BTreeMap<[i32; 2], Vec<Evidence>> = BTreeMap::new();
    for e in evidence {
        cells.entry(e.command.map(|c| (c / CELL).round() as i32)).or_default().push(e);
    }
    cells.values().map(|together| one(together)).collect()
}

fn one(together: &[Evidence]) -> Evidence {
    let weighted = |value: fn(&Evidence, usize) -> f32, channel: usize| {
        let (sum, weights) = together.iter().fold((0.0, 0.0), |(sum, weights), e| {
            let weight = 1.0 / f64::from(e.variance[channel]);
            (sum + weight * f64::from(value(e, channel)), weights + weight)
        });
        (sum / weights, 1.0 / weights)
    };
    let bias = [0, 1, 2].map(|channel| weighted(|e, c| e.bias[c], channel));
    Evidence {
        command: [0, 1].map(|side| {
            let sum: f32 = together.iter().map(|e| e.command[side]).sum();
            sum / together.len() as f32
        }),
        bias: bias.map(|(mean, _)| mean as f32),
        variance: bias.map(|(_, variance)| variance as f32),
        after_training: false,
    }
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
    use crate::built_in_robot::{default_robot, record, training_room};
    use crate::learn::train::{TABLE_ONE, Trainer, train};

    /// A robot that is driven by the same commands for long does what the distribution allows.
    #[test]
    fn held_commands_stay_within_what_is_not_known() {
        let logs = record(&default_robot(), &training_room(), 40, 60, &[], 3).expect("room to drive");
        let simulator = train(&logs, &Trainer::Fast, &TABLE_ONE, 1, &|_| {}).expect("networks");
        let ensemble = simulator.ensemble.clone().expect("a distribution");
        assert!(ensemble.is_sound() && ensemble.evidence.len() > 100);
        let networks = simulator.motion_networks().expect("networks");
        let said = |command: [f64; 2]| networks.held(command);
        let posterior = Posterior::new(&ensemble, &said).expect("a posterior");
        let fresh = record(&default_robot(), &training_room(), 40, 60, &[], 4).expect("room to drive");
        let noise = MotionNoise::of(&simulator).expect("noise");
        let steps = residuals(&simulator, &fresh).expect("residuals");
        let mut squares = [0.0; 3];
        let held: Vec<Hold> = holds(&steps).into_iter().filter(|hold| !hold.first).collect();
        for hold in &held {
            let motion = posterior.motion(hold.command);
            for channel in 0..3 {
                let [mean, deviation] = motion[channel];
                let evidence = hold.evidence(&noise, &ensemble.first_step, &ensemble.lasting);
                let variance = deviation * deviation + f64::from(evidence.variance[channel]);
                let off = evidence.motion(&said)[channel] - mean;
                squares[channel] += off * off / variance;
            }
        }
        for (channel, squares) in squares.iter().enumerate() {
            let ratio = squares / held.len() as f64;
            assert!((0.6..1.5).contains(&ratio), "channel {channel}: {ratio}");
        }
    }
}
