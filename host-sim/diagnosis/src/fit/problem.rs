//! A hypothesis whose parameters are sought: by a few iterations from several starts, and on to the end where those are
//! promising.

use std::borrow::Cow;

use super::{FitContext, Fitted, MOST_ITERATIONS, TOLERANCE_NATS};
use crate::hypothesis::{Hypothesis, LogLikelihood};
use crate::memo::{Memo, Sights};
use mindgap_foundations::statistics::maximise::{Bounds, Maximum, Point, climb_from, single_parameter_step};
use mindgap_learning::evaluation::observations::Observations;

/// A hypothesis whose parameters are sought.
pub struct Problem<'a> {
    /// What is supposed.
    pub hypothesis: Hypothesis,
    /// The log-likelihood of what it does not touch.
    pub untouched: &'a LogLikelihood,
    /// What it is fitted to.
    pub context: &'a FitContext<'a>,
}

/// So many starts are tried, where they lag behind the best by less than what a few iterations gain at the least.
const STARTS: usize = 3;
const NEARLY_AS_GOOD_NATS: f64 = 5.0;
/// Iterations after which it shows whether a fit is promising.
const SKETCH_ITERATIONS: usize = 3;
/// A climb that ended on the way is set going again so often: by the shares of a ghost that does not scatter, four times.
const MOST_STEPS_OF_ONE: usize = 6;

impl<'a> Problem<'a> {
    /// A few iterations from the best starts, on some of the rows where there are many: likelihoods with several maxima have
    /// more than one that is promising. `sights` are what the sensor faces about the starts, if that is known.
    pub fn sketch(&self, starts: Vec<Vec<f64>>, sights: Option<&Sights>) -> Point {
        let (rows, untouched) = self.sketched_rows();
        let memo = Memo::new(rows, sights);
        let terms = |at: &[f64]| self.terms(&memo, &untouched, at);
        let mut starts: Vec<Point> = starts.into_iter().map(|start| Point::new(&start, terms)).collect();
        starts.sort_by(|a, b| b.value().total_cmp(&a.value()));
        let best = starts.first().map_or(0.0, Point::value);
        let promising = starts.into_iter().take(STARTS).take_while(|start| best - start.value() < NEARLY_AS_GOOD_NATS);
        let bounds = self.hypothesis.bounds();
        let climbs = promising.map(|start| climb_from(&bounds, start, SKETCH_ITERATIONS, TOLERANCE_NATS, terms));
        let best = climbs.max_by(|a, b| a.value().total_cmp(&b.value()));
        best.unwrap_or_else(|| Point::new(&vec![0.0; bounds.len()], terms))
    }

    /// The fit to the end.
    pub fn settle(self, sketch: Point) -> Fitted {
        let Problem { hypothesis, untouched, context } = &self;
        let (bounds, memo) = (hypothesis.bounds(), Memo::new(context.observations, None));
        let terms = |at: &[f64]| self.terms(&memo, untouched, at);
        let on = |from: Point| {
            climb_from(&bounds, from, MOST_ITERATIONS, TOLERANCE_NATS, terms).into_maximum(&bounds, terms)
        };
        let mut found = on(if context.few.is_none() { sketch } else { Point::new(&sketch.at, terms) });
        for _ in 0..MOST_STEPS_OF_ONE {
            let Some(further) = single_parameter_step(&bounds, &found, TOLERANCE_NATS, terms) else { break };
            found = on(further);
        }
        let without = without_each_block(&found, &bounds, context);
        let held_out = held_out(&without, &found, hypothesis, untouched, context);
        let errors = jackknife_errors(&found.at, &without);
        let log_likelihood = memo.log_likelihood(hypothesis, context.baseline, &found.at, untouched);
        let occam = occam(&found, hypothesis, &bounds);
        Fitted { hypothesis: self.hypothesis, values: found.at, log_likelihood, held_out, errors, occam }
    }

    /// What the sensor faces with these values, and beside them for each parameter: on the way of every fit that begins there.
    pub fn sights(&self, values: &[f64]) -> Sights<'a> {
        let (rows, untouched) = self.sketched_rows();
        let memo = Memo::new(rows, None);
        let terms = |at: &[f64]| self.terms(&memo, &untouched, at);
        Point::new(values, terms).into_maximum(&self.hypothesis.bounds(), terms);
        memo.into_sights()
    }

    /// The rows that a sketch looks at, with the log-likelihood of what the hypothesis does not touch there.
    fn sketched_rows(&self) -> (&'a Observations, Cow<'a, LogLikelihood>) {
        match &self.context.few {
            Some(few) => (&few.rows, Cow::Owned(self.untouched.every(few.every))),
            None => (self.context.observations, Cow::Borrowed(self.untouched)),
        }
    }

    /// The log-likelihood of each row. The prior stands behind them as one more term, which belongs to no block.
    fn terms(&self, memo: &Memo, untouched: &LogLikelihood, at: &[f64]) -> Vec<f64> {
        let mut terms = memo.log_likelihood(&self.hypothesis, self.context.baseline, at, untouched).total();
        terms.push(self.hypothesis.log_prior(at));
        terms
    }
}

/// The parameters that the blocks would have without each in turn, by the one-step jackknife.
fn without_each_block(found: &Maximum, bounds: &[Bounds], context: &FitContext) -> Vec<Vec<f64>> {
    let without = |block: usize| {
        let left_out = context.observations.of_block(block);
        found.without(bounds, |row| left_out.contains(&row))
    };
    (0..context.observations.blocks).map(without).collect()
}

/// The log-likelihood of each block with the parameters that the others alone would have.
fn held_out(
    without: &[Vec<f64>],
    found: &Maximum,
    hypothesis: &Hypothesis,
    untouched: &LogLikelihood,
    context: &FitContext,
) -> Vec<f64> {
    let scatter = hypothesis.scatter(context.baseline, context.observations, &found.at);
    let of_block = |(block, values): (usize, &Vec<f64>)| {
        hypothesis.of_block(context.baseline, context.observations, block, values, scatter, untouched)
    };
    without.iter().enumerate().map(of_block).collect()
}

/// Standard errors by the jackknife (Efron and Tibshirani 1993, equation 11.5).
fn jackknife_errors(values: &[f64], without: &[Vec<f64>]) -> Vec<f64> {
    let n = without.len() as f64;
    let error = |i: usize| {
        let mean = without.iter().map(|w| w[i]).sum::<f64>() / n;
        ((n - 1.0) / n * without.iter().map(|w| (w[i] - mean) * (w[i] - mean)).sum::<f64>()).sqrt()
    };
    (0..values.len()).map(error).collect()
}

/// By how much the evidence exceeds the held-out log-likelihood: the prior at the maximum times the volume about it, less
/// what held-out rows lose where they are independent, which is one nat a parameter. A gain from freedom alone is none.
fn occam(found: &Maximum, hypothesis: &Hypothesis, bounds: &[Bounds]) -> f64 {
    // The prior is the last of the terms.
    let rows = found.scores.len() - 1;
    let volume = found.log_volume(bounds, &hypothesis.prior_precisions(), |term| term < rows);
    let prior = hypothesis.log_prior_peak() + hypothesis.log_prior(&found.at);
    bounds.len() as f64 + (prior + volume).min(0.0)
}
