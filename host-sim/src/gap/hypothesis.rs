//! Effects that are supposed to be at work together, with free parameters, and how likely they make the logs.

use std::f64::consts::PI;
use std::ops::Range;

use super::channel::Channel;
use crate::effects::chain::EffectChain;
use crate::effects::effect::Variant;
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
    pub forms: Vec<&'static Variant>,
}

/// Log-likelihoods by row and channel.
#[derive(Clone, Debug)]
pub struct Terms {
    /// Forward, lateral, turn.
    pub motion: Vec<[f64; 3]>,
    /// Echo rate, echo value.
    pub sonar: Vec<[f64; 2]>,
}

impl Terms {
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

/// A step that is so much wider than usual counts as a jump of the tracker.
const JUMP: f64 = 8.0;
/// How often the tracker jumps, at most.
const JUMPS: f64 = 0.01;

impl Hypothesis {
    /// The simulator as it is.
    pub fn none(baseline: &Baseline) -> Self {
        Hypothesis { given: EffectChain::of(&baseline.applied), forms: Vec::new() }
    }

    /// The same simulator with these effects.
    pub fn of(&self, forms: Vec<&'static Variant>) -> Self {
        Hypothesis { given: self.given.clone(), forms }
    }

    /// This and one more.
    pub fn with(&self, form: &'static Variant) -> Self {
        self.of(self.forms.iter().copied().chain([form]).collect())
    }

    /// The effects at given parameters.
    pub fn at(&self, values: &[f64]) -> EffectChain {
        self.given.with(&self.forms, values)
    }

    /// Bounds of all parameters.
    pub fn bounds(&self) -> Vec<Bounds> {
        self.forms.iter().flat_map(|f| f.parameters.iter().map(|p| p.bounds)).collect()
    }

    /// The log-likelihood of every row at `values`; what the hypothesis does not touch is taken from `untouched`.
    pub fn terms(
        &self,
        baseline: &Baseline,
        evidence: &Observations,
        values: &[f64],
        untouched: Option<&Terms>,
    ) -> Terms {
        let kept = |touched: bool| untouched.filter(|_| !touched);
        let motion = || {
            let scatter = self.scatter(baseline, evidence, values);
            self.motion_terms(baseline, &evidence.rows, values, scatter)
        };
        let sonar = || self.sonar_terms(baseline, evidence, 0..evidence.rows.len(), values);
        Terms {
            motion: kept(self.moves()).map_or_else(motion, |t| t.motion.clone()),
            sonar: kept(self.senses()).map_or_else(sonar, |t| t.sonar.clone()),
        }
    }

    /// The same of rows that the hypothesis was not fitted on, with the scatter of those that it was fitted on.
    pub fn terms_of_others(
        &self,
        baseline: &Baseline,
        others: &Observations,
        values: &[f64],
        scatter: [f64; 3],
    ) -> Terms {
        Terms {
            motion: self.motion_terms(baseline, &others.rows, values, scatter),
            sonar: self.sonar_terms(baseline, others, 0..others.rows.len(), values),
        }
    }

    /// The log-likelihood of one block, with the scatter of all.
    pub fn of_block(
        &self,
        baseline: &Baseline,
        evidence: &Observations,
        block: usize,
        values: &[f64],
        scatter: [f64; 3],
        untouched: &Terms,
    ) -> f64 {
        let range = evidence.of_block(block);
        let motion: f64 = if self.moves() {
            self.motion_terms(baseline, &evidence.rows[range.clone()], values, scatter).as_flattened().iter().sum()
        } else {
            untouched.motion[range.clone()].as_flattened().iter().sum()
        };
        let sonar: f64 = if self.senses() {
            self.sonar_terms(baseline, evidence, range, values).as_flattened().iter().sum()
        } else {
            untouched.sonar[range].as_flattened().iter().sum()
        };
        motion + sonar
    }

    /// A nuisance of every hypothesis: the scatter may be larger than the simulator's, never smaller.
    pub fn scatter(&self, baseline: &Baseline, evidence: &Observations, values: &[f64]) -> [f64; 3] {
        let Some(drive) = &baseline.motion else { return [1.0; 3] };
        let effects = self.at(values);
        let residuals: Vec<_> = evidence.rows.iter().map(|row| residual(&effects, drive, row)).collect();
        refitted(&residuals, drive.scatter())
    }

    fn moves(&self) -> bool {
        self.forms.iter().any(|f| f.moves())
    }

    fn senses(&self) -> bool {
        self.forms.iter().any(|f| f.senses())
    }

    /// The log-likelihoods of the motion channels with a given scatter.
    pub fn motion_terms(
        &self,
        baseline: &Baseline,
        rows: &[Observation],
        values: &[f64],
        scatter: [f64; 3],
    ) -> Vec<[f64; 3]> {
        let Some(drive) = &baseline.motion else { return vec![[0.0; 3]; rows.len()] };
        let effects = self.at(values);
        let densities = |r: [f64; 3]| [0, 1, 2].map(|c| log_density(r[c], scatter[c]));
        rows.iter().map(|row| residual(&effects, drive, row).map_or([0.0; 3], densities)).collect()
    }

    fn sonar_terms(
        &self,
        baseline: &Baseline,
        evidence: &Observations,
        rows: Range<usize>,
        values: &[f64],
    ) -> Vec<[f64; 2]> {
        let Some(sonar) = &baseline.sonar else { return vec![[0.0; 2]; rows.len()] };
        let effects = self.at(values);
        let term = |row: &Observation| {
            let (fan, change) = facing(&effects, evidence, row);
            let outcomes = sonar.outcomes(&fan, &change, row.previous_echo_cm);
            let rate = outcomes.log_detection(row.echo_cm);
            [rate, outcomes.log_likelihood(row.echo_cm) - rate]
        };
        evidence.rows[rows].iter().map(term).collect()
    }
}

fn refitted(residuals: &[Option<[f64; 3]>], least: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|c| {
        let bound = 4.0 * least[c];
        let squares = residuals.iter().flatten().map(|r| r[c].clamp(-bound, bound)).map(|r| r * r);
        let (sum, n) = squares.fold((0.0, 0.0), |(sum, n), s| (sum + s, n + 1.0));
        if n > 0.0 { f64::max(least[c], f64::sqrt(sum / n)) } else { least[c] }
    })
}

fn log_density(residual: f64, scatter: f64) -> f64 {
    let t = residual / scatter;
    let normal = |t: f64| libm::exp(-0.5 * t * t) / (2.0 * PI).sqrt();
    libm::log((1.0 - JUMPS) * normal(t) + JUMPS * normal(t / JUMP) / JUMP) - libm::log(scatter)
}
