//! Effects that are supposed to be at work together, with free parameters, and how likely they make the logs.

use std::f64::consts::PI;
use std::ops::Range;

use super::channel::Channel;
use crate::effects::chain::EffectChain;
use crate::effects::{Candidate, Parameter};
use crate::evaluation::observations::{Observation, Observations};
use crate::evaluation::predictions::{facing, residual};
use crate::simulator::baseline::Baseline;
use crate::statistics::maximise::Bounds;

/// Effects that are supposed to be there, in the order in which they act; none is the simulator as it is.
#[derive(Clone)]
pub struct Hypothesis {
    /// What the simulator has already, with its parameters.
    given: EffectChain,
    /// One variant of each further effect.
    pub candidates: Vec<Candidate>,
}

/// Log-likelihood of every row, by channel.
#[derive(Clone, Debug)]
pub struct LogLikelihood {
    /// Forward, lateral, turn.
    pub motion: Vec<[f64; 3]>,
    /// Echo rate, echo value.
    pub sonar: Vec<[f64; 2]>,
}

impl LogLikelihood {
    /// All channels of each row together.
    pub fn total(&self) -> Vec<f64> {
        let both = |(m, s): (&[f64; 3], &[f64; 2])| m.iter().sum::<f64>() + s.iter().sum::<f64>();
        self.motion.iter().zip(&self.sonar).map(both).collect()
    }

    /// One channel of each row.
    pub fn channel(&self, channel: Channel) -> Vec<f64> {
        match channel {
            Channel::Forward => self.motion.iter().map(|m| m[0]).collect(),
            Channel::Lateral => self.motion.iter().map(|m| m[1]).collect(),
            Channel::Turn => self.motion.iter().map(|m| m[2]).collect(),
            Channel::EchoRate => self.sonar.iter().map(|s| s[0]).collect(),
            Channel::EchoValue => self.sonar.iter().map(|s| s[1]).collect(),
        }
    }
}

/// Scatter of a jump of the tracker against that of a step: a jump of some tens of centimetres.
const JUMP: f64 = 8.0;
/// Share of steps in which the tracker jumps, at most.
const JUMPS: f64 = 0.01;
/// A residual beyond this multiple of the usual scatter counts as that: jumps are no scatter.
const FARTHEST: f64 = 4.0;

impl Hypothesis {
    /// The simulator as it is.
    pub fn none(baseline: &Baseline) -> Self {
        Hypothesis { given: EffectChain::of(&baseline.applied), candidates: Vec::new() }
    }

    /// The same simulator with these effects.
    pub fn of(&self, candidates: Vec<Candidate>) -> Self {
        Hypothesis { given: self.given.clone(), candidates }
    }

    /// This and one more.
    pub fn with(&self, candidate: Candidate) -> Self {
        self.of(self.candidates.iter().copied().chain([candidate]).collect())
    }

    /// The effects at given parameters.
    pub fn at(&self, values: &[f64]) -> EffectChain {
        let variants: Vec<_> = self.candidates.iter().map(|c| c.variant).collect();
        self.given.with(&variants, values)
    }

    /// Bounds of all parameters.
    pub fn bounds(&self) -> Vec<Bounds> {
        self.parameters().map(Parameter::fit_bounds).collect()
    }

    /// Logarithm of the prior density of parameters, relative to its maximum.
    pub fn log_prior(&self, values: &[f64]) -> f64 {
        self.parameters().zip(values).map(|(parameter, value)| parameter.log_prior(*value)).sum()
    }

    fn parameters(&self) -> impl Iterator<Item = &'static Parameter> {
        self.candidates.iter().flat_map(|c| c.variant.parameters)
    }

    /// The log-likelihood of every row at `values`; what the hypothesis does not touch is taken from `untouched`.
    pub fn log_likelihood(
        &self,
        baseline: &Baseline,
        observations: &Observations,
        values: &[f64],
        untouched: Option<&LogLikelihood>,
    ) -> LogLikelihood {
        let kept = |touched: bool| untouched.filter(|_| !touched);
        let motion = || {
            let scatter = self.scatter(baseline, observations, values);
            self.motion(baseline, &observations.rows, values, scatter)
        };
        let sonar = || self.sonar(baseline, observations, 0..observations.rows.len(), values);
        LogLikelihood {
            motion: kept(self.moves()).map_or_else(motion, |t| t.motion.clone()),
            sonar: kept(self.senses()).map_or_else(sonar, |t| t.sonar.clone()),
        }
    }

    /// The same with a given scatter: that of the rows on which the hypothesis was fitted.
    pub fn log_likelihood_with(
        &self,
        scatter: [f64; 3],
        baseline: &Baseline,
        others: &Observations,
        values: &[f64],
    ) -> LogLikelihood {
        LogLikelihood {
            motion: self.motion(baseline, &others.rows, values, scatter),
            sonar: self.sonar(baseline, others, 0..others.rows.len(), values),
        }
    }

    /// The log-likelihood of one block, with the scatter of all.
    pub fn of_block(
        &self,
        baseline: &Baseline,
        observations: &Observations,
        block: usize,
        values: &[f64],
        scatter: [f64; 3],
        untouched: &LogLikelihood,
    ) -> f64 {
        let range = observations.of_block(block);
        let motion: f64 = if self.moves() {
            self.motion(baseline, &observations.rows[range.clone()], values, scatter).as_flattened().iter().sum()
        } else {
            untouched.motion[range.clone()].as_flattened().iter().sum()
        };
        let sonar: f64 = if self.senses() {
            self.sonar(baseline, observations, range, values).as_flattened().iter().sum()
        } else {
            untouched.sonar[range].as_flattened().iter().sum()
        };
        motion + sonar
    }

    /// A nuisance of every hypothesis: the scatter may be larger than the simulator's, never smaller.
    pub fn scatter(&self, baseline: &Baseline, observations: &Observations, values: &[f64]) -> [f64; 3] {
        let Some(drive) = &baseline.motion else { return [1.0; 3] };
        let effects = self.at(values);
        let residuals: Vec<[f64; 3]> =
            observations.rows.iter().filter_map(|row| residual(&effects, drive, row)).collect();
        let least = drive.scatter();
        [0, 1, 2].map(|axis| refitted(residuals.iter().map(|r| r[axis]), least[axis]))
    }

    /// Whether a further effect changes the motion.
    pub fn moves(&self) -> bool {
        self.candidates.iter().any(|c| c.variant.moves())
    }

    /// Whether a further effect changes the sensor.
    pub fn senses(&self) -> bool {
        self.candidates.iter().any(|c| c.variant.senses())
    }

    /// The log-likelihoods of the motion channels with a given scatter.
    fn motion(&self, baseline: &Baseline, rows: &[Observation], values: &[f64], scatter: [f64; 3]) -> Vec<[f64; 3]> {
        let Some(drive) = &baseline.motion else { return vec![[0.0; 3]; rows.len()] };
        let effects = self.at(values);
        let densities = |r: [f64; 3]| [0, 1, 2].map(|c| log_density(r[c], scatter[c]));
        rows.iter().map(|row| residual(&effects, drive, row).map_or([0.0; 3], densities)).collect()
    }

    fn sonar(
        &self,
        baseline: &Baseline,
        observations: &Observations,
        rows: Range<usize>,
        values: &[f64],
    ) -> Vec<[f64; 2]> {
        let Some(sonar) = &baseline.sonar else { return vec![[0.0; 2]; rows.len()] };
        let effects = self.at(values);
        let term = |row: &Observation| {
            let (fan, perturbation) = facing(&effects, observations, row);
            let outcomes = sonar.outcomes(&fan, &perturbation, row.previous_echo_cm);
            let rate = outcomes.log_detection(row.echo_cm);
            [rate, outcomes.log_likelihood(row.echo_cm) - rate]
        };
        observations.rows[rows].iter().map(term).collect()
    }
}

/// The standard deviation of residuals, those far off counted as less far; never less than `least`.
pub fn refitted(residuals: impl Iterator<Item = f64>, least: f64) -> f64 {
    let bound = FARTHEST * least;
    let squares = residuals.map(|r| r.clamp(-bound, bound)).map(|r| r * r);
    let (sum, n) = squares.fold((0.0, 0.0), |(sum, n), s| (sum + s, n + 1.0));
    if n > 0.0 { f64::max(least, f64::sqrt(sum / n)) } else { least }
}

/// The logarithm of a residual's density: normal, and now and then a jump of the tracker.
pub fn log_density(residual: f64, scatter: f64) -> f64 {
    let t = residual / scatter;
    let normal = |t: f64| libm::exp(-0.5 * t * t) / (2.0 * PI).sqrt();
    libm::log((1.0 - JUMPS) * normal(t) + JUMPS * normal(t / JUMP) / JUMP) - libm::log(scatter)
}

#[cfg(test)]
mod tests;
