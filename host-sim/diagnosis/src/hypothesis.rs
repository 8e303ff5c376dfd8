//! Effects that are supposed to be at work together, with free parameters, and how likely they make the logs.

use std::ops::Range;

use super::channel::Channel;
use super::residual_law::{fitted_scatter, log_density};
use mindgap_foundations::statistics::maximise::Bounds;
use mindgap_learning::evaluation::observations::{Observation, Observations};
use mindgap_learning::evaluation::predictions::{facing_in, residual};
use mindgap_models::effects::chain::EffectChain;
use mindgap_models::effects::{Candidate, Parameter, SensorState, Variant};
use mindgap_models::simulator::baseline::Baseline;
use mindgap_models::sonar::Outcomes;

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

    /// Every so many rows of these, the first one first.
    pub fn every(&self, step: usize) -> Self {
        LogLikelihood {
            motion: self.motion.iter().step_by(step).copied().collect(),
            sonar: self.sonar.iter().step_by(step).copied().collect(),
        }
    }

    /// One channel of all rows.
    pub fn of(&self, channel: Channel) -> f64 {
        self.channel(channel).iter().sum()
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

impl Hypothesis {
    /// The simulator as it is.
    pub fn none(baseline: &Baseline) -> Self {
        Hypothesis { given: EffectChain::of(&baseline.applied), candidates: Vec::new() }
    }

    /// The simulator without the effects that it has already.
    pub fn bare() -> Self {
        Hypothesis { given: EffectChain::of(&[]), candidates: Vec::new() }
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

    /// Logarithm of the prior density of parameters where it is largest, per unit of each.
    pub fn log_prior_peak(&self) -> f64 {
        self.parameters().map(Parameter::log_prior_peak).sum()
    }

    /// Precisions of the priors, one a parameter, in squared inverse units; zero where every value is as likely.
    pub fn prior_precisions(&self) -> Vec<f64> {
        self.parameters().map(|p| 1.0 / (p.prior_sd * p.prior_sd)).collect()
    }

    /// The free parameters, effect after effect.
    pub fn parameters(&self) -> impl Iterator<Item = &'static Parameter> {
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
        let motion = || self.motion(baseline, &observations.rows, values);
        let sonar = || self.sonar_of(baseline, observations, 0..observations.rows.len(), values);
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
            motion: self.motion_with(scatter, baseline, &others.rows, values),
            sonar: self.sonar_of(baseline, others, 0..others.rows.len(), values),
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
            self.motion_with(scatter, baseline, &observations.rows[range.clone()], values).as_flattened().iter().sum()
        } else {
            untouched.motion[range.clone()].as_flattened().iter().sum()
        };
        let sonar: f64 = if self.senses() {
            self.sonar_of(baseline, observations, range, values).as_flattened().iter().sum()
        } else {
            untouched.sonar[range].as_flattened().iter().sum()
        };
        motion + sonar
    }

    /// A nuisance of every hypothesis: the scatter may be larger than the simulator's, never smaller.
    pub fn scatter(&self, baseline: &Baseline, observations: &Observations, values: &[f64]) -> [f64; 3] {
        fitted(&observations.rows, &self.residuals(baseline, &observations.rows, values), baseline)
    }

    /// Whether a further effect changes the motion.
    pub fn moves(&self) -> bool {
        self.candidates.iter().any(|c| c.variant.moves())
    }

    /// Whether a further effect changes the sensor.
    pub fn senses(&self) -> bool {
        self.candidates.iter().any(|c| c.variant.senses())
    }

    /// The values of those of its effects that a test picks.
    pub fn values_of(&self, values: &[f64], is_picked: impl Fn(&Variant) -> bool) -> Vec<f64> {
        let picked = self.candidates.iter().flat_map(|c| c.variant.parameters.iter().map(|_| is_picked(c.variant)));
        picked.zip(values).filter(|(is_picked, _)| *is_picked).map(|(_, value)| *value).collect()
    }

    /// The log-likelihoods of the motion channels.
    pub fn motion(&self, baseline: &Baseline, rows: &[Observation], values: &[f64]) -> Vec<[f64; 3]> {
        let residuals = self.residuals(baseline, rows, values);
        densities(rows, &residuals, fitted(rows, &residuals, baseline))
    }

    /// The same with a given scatter.
    fn motion_with(
        &self,
        scatter: [f64; 3],
        baseline: &Baseline,
        rows: &[Observation],
        values: &[f64],
    ) -> Vec<[f64; 3]> {
        densities(rows, &self.residuals(baseline, rows, values), scatter)
    }

    /// Logged minus predicted of every row.
    fn residuals(&self, baseline: &Baseline, rows: &[Observation], values: &[f64]) -> Vec<Option<[f64; 3]>> {
        let Some(drive) = &baseline.motion else { return vec![None; rows.len()] };
        let effects = self.at(values);
        rows.iter().map(|row| residual(&effects, drive, row)).collect()
    }

    /// The log-likelihoods of the sonar's channels; `outcomes` tells what the sensor may report at a row in a state.
    pub fn sonar(
        &self,
        baseline: &Baseline,
        observations: &Observations,
        rows: Range<usize>,
        values: &[f64],
        outcomes: impl Fn(usize, &SensorState) -> Option<Outcomes>,
    ) -> Vec<[f64; 2]> {
        if baseline.sonar.is_none() {
            return vec![[0.0; 2]; rows.len()];
        }
        let effects = self.at(values);
        let term = |i: usize| {
            let row = &observations.rows[i];
            let Some(outcomes) = outcomes(i, &effects.sensor(&row.context)) else { return [0.0; 2] };
            let rate = outcomes.log_detection(row.echo_cm);
            let [rate_weight, value_weight] = row.echo_weight;
            [rate_weight * rate, value_weight * (outcomes.log_likelihood(row.echo_cm) - rate)]
        };
        rows.map(term).collect()
    }

    fn sonar_of(
        &self,
        baseline: &Baseline,
        observations: &Observations,
        rows: Range<usize>,
        values: &[f64],
    ) -> Vec<[f64; 2]> {
        self.sonar(baseline, observations, rows, values, |row, state| {
            Some(facing_in(observations, &observations.rows[row], state)?.outcomes())
        })
    }
}

/// The log-density of each channel, zero where nothing was logged.
fn densities(rows: &[Observation], residuals: &[Option<[f64; 3]>], scatter: [f64; 3]) -> Vec<[f64; 3]> {
    let of = |(row, r): (&Observation, &Option<[f64; 3]>)| {
        let term = |r: [f64; 3]| [0, 1, 2].map(|i| row.motion_weight[i] * log_density(i, r[i], scatter[i]));
        r.map_or([0.0; 3], term)
    };
    rows.iter().zip(residuals).map(of).collect()
}

fn fitted(rows: &[Observation], residuals: &[Option<[f64; 3]>], baseline: &Baseline) -> [f64; 3] {
    let Some(drive) = &baseline.motion else { return [1.0; 3] };
    let least = drive.scatter();
    [0, 1, 2].map(|axis| {
        let of_axis = rows.iter().zip(residuals).filter_map(|(row, r)| Some([(*r)?[axis], row.motion_weight[axis]]));
        fitted_scatter(axis, &of_axis.collect::<Vec<[f64; 2]>>(), least[axis])
    })
}

#[cfg(test)]
mod tests;
