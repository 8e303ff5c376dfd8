//! Learns the distribution over robots from logs: what they say of the motion under each command, and how far such biases
//! reach and how large they are.

pub mod holds;

use std::collections::BTreeMap;

use rayon::prelude::*;

use crate::logs::{Logs, samples};
use crate::simulator::Simulator;
use crate::simulator::ensemble::basis::{CHANGE, unit_factor};
use crate::simulator::ensemble::posterior::Likelihood;
use crate::simulator::ensemble::{Ensemble, Evidence, PARTS};
use holds::{Hold, MotionNoise, StepResidual, holds};

/// Training logs are summed up over commands as far apart as this: finer than friction bends.
const CELL: f32 = 4.0;
/// Sizes of the process's parts are sought by factors that get smaller, from this share of the robot's chance in a step.
const FIRST_SIZE: f64 = 0.5;
const FACTORS: [f64; 4] = [4.0, 4.0, 2.0, 1.4];

/// How much a wheel may have changed since training, as a share: the one under which the runs are most probable.
const CHANGES: [f64; 4] = [0.0, 0.02, 0.06, 0.2];

/// The distribution that the training logs of a simulator leave; none without motion networks and what is normal beyond
/// them.
pub fn learn(simulator: &Simulator, logs: &Logs) -> Option<Ensemble> {
    let noise = MotionNoise::of(simulator)?;
    let held = holds(&residuals(simulator, logs)?);
    let first_step = first_step(&held, &noise);
    let evidence = summed(held.iter().map(|hold| hold.evidence(&noise, &first_step)));
    let factor = unit_factor();
    let sizes = |channel: usize| sizes(&Likelihood::new(&factor, &evidence, channel), noise.typical(channel));
    let prior: Vec<[f64; PARTS]> = (0..3).into_par_iter().map(sizes).collect();
    Some(Ensemble { prior: [prior[0], prior[1], prior[2]], first_step, evidence })
}

/// A distribution with what further runs say of the robot, which may have changed since the training logs.
pub fn conditioned(ensemble: &Ensemble, noise: &MotionNoise, steps: &[StepResidual]) -> Ensemble {
    let mut ensemble = ensemble.clone();
    let held = holds(steps);
    let more = held.iter().map(|hold| hold.evidence(noise, &ensemble.first_step));
    let more: Vec<Evidence> = more.map(|evidence| Evidence { after_training: true, ..evidence }).collect();
    ensemble.evidence.extend(more);
    let factor = unit_factor();
    for (channel, prior) in ensemble.prior.iter_mut().enumerate() {
        let likelihood = Likelihood::new(&factor, &ensemble.evidence, channel);
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

/// Standard deviations of what first steps do beyond later ones: what is left of their variance once noise is taken off.
fn first_step(held: &[Hold], noise: &MotionNoise) -> [f64; 3] {
    [0, 1, 2].map(|channel| {
        let excess = |first: bool| {
            let single = held.iter().filter(|hold| hold.first == first && hold.steps == 1);
            let (sum, n) = single.fold((0.0, 0.0), |(sum, n), hold| {
                (sum + hold.residual[channel] * hold.residual[channel] - noise.variance(hold, channel), n + 1.0)
            });
            if n > 0.0 { sum / n } else { 0.0 }
        };
        f64::max(excess(true) - excess(false), 0.0).sqrt()
    })
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
    use crate::simulator::ensemble::Posterior;

    /// A robot that is driven by the same commands for long does what the distribution allows.
    #[test]
    fn held_commands_stay_within_what_is_not_known() {
        let logs = record(&default_robot(), &training_room(), 40, 60, &[], 3).expect("room to drive");
        let simulator = train(&logs, &Trainer::Fast, &TABLE_ONE, 1, |_| {}).expect("networks");
        let ensemble = simulator.ensemble.clone().expect("a distribution");
        assert!(ensemble.is_sound() && ensemble.evidence.len() > 100);
        let posterior = Posterior::new(&ensemble).expect("a posterior");
        let fresh = record(&default_robot(), &training_room(), 40, 60, &[], 4).expect("room to drive");
        let noise = MotionNoise::of(&simulator).expect("noise");
        let steps = residuals(&simulator, &fresh).expect("residuals");
        let mut squares = [0.0; 3];
        let held: Vec<Hold> = holds(&steps).into_iter().filter(|hold| !hold.first).collect();
        for hold in &held {
            let bias = posterior.bias(hold.command);
            for channel in 0..3 {
                let [mean, deviation] = bias[channel];
                let variance = deviation * deviation + noise.variance(hold, channel);
                let off = hold.residual[channel] + hold.known[channel] - mean;
                squares[channel] += off * off / variance;
            }
        }
        for (channel, squares) in squares.iter().enumerate() {
            let ratio = squares / held.len() as f64;
            assert!((0.6..1.5).contains(&ratio), "channel {channel}: {ratio}");
        }
    }
}
