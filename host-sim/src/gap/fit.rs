//! Fitting: the parameters of a hypothesis by maximum a posteriori, judged on runs that they were not fitted on.

use rayon::prelude::*;

use super::calibration::{Calibration, Gate};
use super::hypothesis::{Hypothesis, LogLikelihood};
use super::method::Method;
use crate::effects::applied::AppliedEffect;
use crate::effects::chain::EffectChain;
use crate::effects::{Candidate, Effect};
use crate::evaluation::observations::Observations;
use crate::simulator::baseline::Baseline;
use crate::statistics::maximise::{Maximum, climb};

/// What is fitted, to what, and what counts.
pub struct FitContext<'a> {
    /// The simulator.
    pub baseline: &'a Baseline<'a>,
    /// The logs on which effects are identified.
    pub observations: &'a Observations,
    /// The effects that compete.
    pub catalogue: &'static [&'static Effect],
    /// Thresholds for this many observations.
    pub calibration: Calibration,
    /// Seed of what is drawn.
    pub seed: u64,
    top_speed_cm_s: f64,
}

/// A hypothesis, fitted.
#[derive(Clone)]
pub struct Fitted {
    /// What is supposed.
    pub hypothesis: Hypothesis,
    /// Its parameters, fitted on all runs.
    pub values: Vec<f64>,
    /// Log-likelihoods there.
    pub log_likelihood: LogLikelihood,
    /// The log-likelihood of each block with the parameters fitted on the others.
    pub held_out: Vec<f64>,
}

/// How much better one hypothesis does than another on runs that it was not fitted on.
#[derive(Clone, Copy, Debug)]
pub struct Gain {
    /// Nats over all blocks.
    pub nats: f64,
    /// Standard error over blocks.
    pub error: f64,
}

/// A fit ends after this many iterations: ridges of two parameters take twenty.
pub const MOST_ITERATIONS: usize = 30;
/// An iteration that gains less ends the fit, nats: a tenth of what a parameter costs.
pub const TOLERANCE_NATS: f64 = 0.1;

impl<'a> FitContext<'a> {
    /// Observations against a simulator.
    pub fn new(baseline: &'a Baseline<'a>, observations: &'a Observations, method: Method) -> Self {
        FitContext {
            baseline,
            observations,
            catalogue: method.catalogue,
            calibration: method.calibration.for_rows(observations.rows.len()),
            seed: method.seed,
            top_speed_cm_s: observations.top_speed_cm_s(),
        }
    }

    /// Where fits of an effect start.
    pub fn initial_guesses(&self, candidate: &Candidate) -> Vec<Vec<f64>> {
        candidate.variant.initial_guesses(self.top_speed_cm_s)
    }
}

impl Fitted {
    /// No effect at all.
    pub fn none(context: &FitContext) -> Self {
        Fitted::at(Hypothesis::none(context.baseline), Vec::new(), context)
    }

    /// Effects that are known and need no fit.
    pub fn given(applied: &[AppliedEffect], context: &FitContext) -> Self {
        let (candidates, values): (Vec<Candidate>, Vec<Vec<f64>>) =
            applied.iter().filter_map(AppliedEffect::resolve).unzip();
        Fitted::at(Hypothesis::none(context.baseline).of(candidates), values.concat(), context)
    }

    fn at(hypothesis: Hypothesis, values: Vec<f64>, context: &FitContext) -> Self {
        let log_likelihood = hypothesis.log_likelihood(context.baseline, context.observations, &values, None);
        let held_out = context.observations.by_block(&log_likelihood.total());
        Fitted { hypothesis, values, log_likelihood, held_out }
    }

    /// Its effects at the fitted parameters.
    pub fn effects(&self) -> EffectChain {
        self.hypothesis.at(&self.values)
    }

    /// The ids of its effects.
    pub fn ids(&self) -> Vec<&'static str> {
        self.hypothesis.candidates.iter().map(|c| c.effect).collect()
    }

    /// The parameters of one of its effects.
    pub fn values_of(&self, place: usize) -> &[f64] {
        let candidates = &self.hypothesis.candidates;
        let before: usize = candidates[..place].iter().map(|c| c.variant.parameters.len()).sum();
        &self.values[before..before + candidates[place].variant.parameters.len()]
    }

    /// Its effects as a simulator takes them.
    pub fn applied(&self) -> Vec<AppliedEffect> {
        let candidates = self.hypothesis.candidates.iter().enumerate();
        candidates.map(|(place, candidate)| AppliedEffect::new(candidate, self.values_of(place))).collect()
    }

    /// By how much this beats `other` on each held-out block.
    pub fn gains_over(&self, other: &Fitted) -> Vec<f64> {
        self.held_out.iter().zip(&other.held_out).map(|(a, b)| a - b).collect()
    }

    /// The same over all blocks.
    pub fn gain_over(&self, other: &Fitted) -> Gain {
        Gain::of(&self.gains_over(other))
    }

    /// What ranks hypotheses: the held-out log-likelihood less the price of the parameters, so that of two that explain the
    /// same the simpler one is first.
    pub fn score(&self, calibration: &Calibration) -> f64 {
        self.held_out.iter().sum::<f64>() - calibration.judgement.parameter_nats * self.values.len() as f64
    }

    /// Whether the effect that was added last touches a stage that others touch.
    pub fn shares_a_stage(&self) -> bool {
        let Some((last, others)) = self.hypothesis.candidates.split_last() else { return false };
        let last = last.variant;
        others.iter().any(|c| c.variant.moves() && last.moves() || c.variant.senses() && last.senses())
    }

    /// Whether a reported parameter of the effect that was added last lies at a bound.
    pub fn last_is_at_a_bound(&self) -> bool {
        let Some(last) = self.hypothesis.candidates.last() else { return false };
        let values = self.values_of(self.hypothesis.candidates.len() - 1);
        last.variant.parameters.iter().zip(values).any(|(parameter, value)| parameter.is_at_a_bound(*value))
    }

    /// The log-likelihood of rows that it was not fitted on.
    pub fn judged_on(&self, others: &Observations, context: &FitContext) -> LogLikelihood {
        let scatter = self.hypothesis.scatter(context.baseline, context.observations, &self.values);
        self.hypothesis.log_likelihood_with(scatter, context.baseline, others, &self.values)
    }

    /// Adds one effect and fits everything anew, from these values and the variant's guesses.
    pub fn with(&self, candidate: Candidate, context: &FitContext) -> Fitted {
        let hypothesis = self.hypothesis.with(candidate);
        let starts = context.initial_guesses(&candidate).into_iter();
        let starts = starts.map(|own| [self.values.as_slice(), own.as_slice()].concat()).collect();
        fit(hypothesis, starts, &self.log_likelihood, context)
    }

    /// Adds each variant of each effect that is not there yet. `alone` are the same variants fitted on nothing, where they
    /// are known: what touches other stages than these effects need not be fitted again.
    pub fn with_each(&self, alone: Option<&[Fitted]>, context: &FitContext) -> Vec<Fitted> {
        let mut fresh = Candidate::all(context.catalogue);
        fresh.retain(|candidate| !self.ids().contains(&candidate.effect));
        let one = |candidate: &Candidate| {
            let known = alone.into_iter().flatten().find(|f| f.hypothesis.candidates[0] == *candidate);
            match known.filter(|f| self.is_apart_from(f)) {
                Some(known) => self.combined_with(known, context),
                None => self.with(*candidate, context),
            }
        };
        fresh.par_iter().map(one).collect()
    }

    /// Leaves the effect at `place` out and fits the others anew.
    pub fn without(&self, place: usize, context: &FitContext) -> Fitted {
        let none = Fitted::none(context);
        let mut candidates = self.hypothesis.candidates.clone();
        candidates.remove(place);
        if candidates.is_empty() {
            return none;
        }
        let others = (0..=candidates.len()).filter(|i| *i != place);
        let values = others.flat_map(|i| self.values_of(i)).copied().collect();
        fit(self.hypothesis.of(candidates), vec![values], &none.log_likelihood, context)
    }

    /// Whether no stage is touched by both.
    fn is_apart_from(&self, other: &Fitted) -> bool {
        let touches = |f: &Fitted| [f.hypothesis.moves(), f.hypothesis.senses()];
        touches(self).iter().zip(touches(other)).all(|(a, b)| !(*a && b))
    }

    /// This and a fit that is apart from it: their likelihoods multiply, so nothing needs to be fitted again.
    fn combined_with(&self, other: &Fitted, context: &FitContext) -> Fitted {
        let moved = other.hypothesis.moves();
        let log_likelihood = LogLikelihood {
            motion: if moved { &other.log_likelihood } else { &self.log_likelihood }.motion.clone(),
            sonar: if moved { &self.log_likelihood } else { &other.log_likelihood }.sonar.clone(),
        };
        let gains = other.gains_over(&Fitted::none(context));
        let held_out = self.held_out.iter().zip(gains).map(|(s, g)| s + g).collect();
        let candidates = [self.hypothesis.candidates.as_slice(), &other.hypothesis.candidates].concat();
        let values = [self.values.as_slice(), &other.values].concat();
        Fitted { hypothesis: self.hypothesis.of(candidates), values, log_likelihood, held_out }
    }
}

impl Gain {
    /// Nothing.
    pub const NONE: Gain = Gain { nats: 0.0, error: 0.0 };

    /// The gain of each block, together.
    pub fn of(by_block: &[f64]) -> Self {
        let n = by_block.len() as f64;
        let nats: f64 = by_block.iter().sum();
        let mean = nats / n;
        let variance = by_block.iter().map(|d| (d - mean) * (d - mean)).sum::<f64>() / (n - 1.0).max(1.0);
        Gain { nats, error: (n * variance).sqrt() }
    }

    /// Whether it counts.
    pub fn passes(&self, gate: &Gate) -> bool {
        self.nats >= gate.nats && self.z() >= gate.z
    }

    /// Gain in standard errors.
    pub fn z(&self) -> f64 {
        self.nats / self.error.max(1e-9)
    }
}

/// The best fit of each effect that was added last, best first.
pub fn best_of_each(mut fits: Vec<Fitted>, calibration: &Calibration) -> Vec<Fitted> {
    fits.sort_by(|a, b| b.score(calibration).total_cmp(&a.score(calibration)));
    let mut seen = Vec::new();
    fits.retain(|fit| {
        let id = fit.ids().last().copied();
        let fresh = !seen.contains(&id);
        seen.push(id);
        fresh
    });
    fits
}

fn fit(hypothesis: Hypothesis, starts: Vec<Vec<f64>>, untouched: &LogLikelihood, context: &FitContext) -> Fitted {
    let bounds = hypothesis.bounds();
    // The prior stands behind the rows as one more term, which belongs to no block.
    let terms = |at: &[f64]| {
        let rows = hypothesis.log_likelihood(context.baseline, context.observations, at, Some(untouched));
        let mut terms = rows.total();
        terms.push(hypothesis.log_prior(at));
        terms
    };
    let value = |at: &[f64]| terms(at).iter().sum::<f64>();
    let best = starts.iter().map(|s| (value(s), s)).max_by(|a, b| a.0.total_cmp(&b.0));
    let start = best.map(|(_, s)| s.clone()).unwrap_or_default();
    let found = climb(&bounds, &start, MOST_ITERATIONS, TOLERANCE_NATS, terms);
    let held_out = held_out(&found, &hypothesis, untouched, context);
    let log_likelihood = hypothesis.log_likelihood(context.baseline, context.observations, &found.at, Some(untouched));
    Fitted { hypothesis, values: found.at, log_likelihood, held_out }
}

/// The log-likelihood of each block with the parameters that the others alone would have, by the one-step jackknife.
fn held_out(found: &Maximum, hypothesis: &Hypothesis, untouched: &LogLikelihood, context: &FitContext) -> Vec<f64> {
    let bounds = hypothesis.bounds();
    let scatter = hypothesis.scatter(context.baseline, context.observations, &found.at);
    (0..context.observations.blocks)
        .map(|block| {
            let left_out = context.observations.of_block(block);
            let values = found.without(&bounds, |row| left_out.contains(&row));
            hypothesis.of_block(context.baseline, context.observations, block, &values, scatter, untouched)
        })
        .collect()
}

#[cfg(test)]
mod tests;
