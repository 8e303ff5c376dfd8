//! Maximum a posteriori of a hypothesis: a few iterations from several starts, and convergence for the promising ones.

use std::borrow::Cow;

use super::{FitContext, Fitted, MOST_ITERATIONS, TOLERANCE_NATS};
use crate::hypothesis::Hypothesis;
use crate::sample::{Identification, Sample};
use crate::scores::Scores;
use crate::sensor_cache::{FacedRows, SensorCache};
use mindgap_foundations::statistics::maximise::{Bounds, Maximum, Point, climb_from, single_parameter_step};

/// A hypothesis whose parameters are fitted.
pub struct Problem<'a> {
    /// The effects.
    pub hypothesis: Hypothesis,
    /// Scores of the channels that they do not touch.
    pub untouched: &'a Scores,
    /// The data and settings.
    pub context: &'a FitContext<'a>,
}

/// Maximum number of starts that are tried. Starts have to lie behind the best one by less than a few iterations gain.
const STARTS: usize = 3;
const NEARLY_AS_GOOD_NATS: f64 = 5.0;
/// Iterations after which a fit shows whether it is promising.
const SKETCH_ITERATIONS: usize = 3;
/// Maximum number of single-parameter steps that restart a stalled climb. The parameters of a noiseless ghost echo need four.
const MOST_STEPS_OF_ONE: usize = 6;

impl<'a> Problem<'a> {
    /// Runs a few iterations from the best starts, since likelihoods have several maxima; on some of the rows if there are
    /// many. `faced` is what the sensor faces near the starts, if that is known.
    pub fn sketch(&self, starts: Vec<Vec<f64>>, faced: Option<&FacedRows>) -> Point {
        let (sample, untouched) = self.sketched();
        let cache = SensorCache::new(sample, faced);
        let terms = |at: &[f64]| self.terms(&cache, &untouched, at);
        let mut starts: Vec<Point> = starts.into_iter().map(|start| Point::new(&start, terms)).collect();
        starts.sort_by(|a, b| b.value().total_cmp(&a.value()));
        let best = starts.first().map_or(0.0, Point::value);
        let promising = starts.into_iter().take(STARTS).take_while(|start| best - start.value() < NEARLY_AS_GOOD_NATS);
        let bounds = self.hypothesis.bounds();
        let climbs = promising.map(|start| climb_from(&bounds, start, SKETCH_ITERATIONS, TOLERANCE_NATS, terms));
        let best = climbs.max_by(|a, b| a.value().total_cmp(&b.value()));
        best.unwrap_or_else(|| Point::new(&vec![0.0; bounds.len()], terms))
    }

    /// Returns the value at a point on the rows of a sketch, plus `further` nats over all rows. `faced` is as for a sketch.
    pub fn sketched_value(&self, at: &[f64], faced: Option<&FacedRows>, further: f64) -> f64 {
        let (sample, untouched) = self.sketched();
        let share = sample.rows.len() as f64 / self.context.rows.rows.len().max(1) as f64;
        let cache = SensorCache::new(sample, faced);
        Point::new(at, |at| self.terms(&cache, &untouched, at)).value() + share * further
    }

    /// Iterates to convergence on all rows and cross-validates the result.
    pub fn converge(self, sketch: Point) -> Fitted {
        self.finish(sketch, MOST_ITERATIONS, MOST_STEPS_OF_ONE)
    }

    /// Cross-validates a sketch on all rows as it is.
    pub fn settle(self, sketch: Point) -> Fitted {
        self.finish(sketch, 0, 0)
    }

    fn finish(self, sketch: Point, iterations: usize, steps_of_one: usize) -> Fitted {
        let Problem { hypothesis, untouched, context } = self;
        let rows = context.rows;
        let (bounds, cache) = (hypothesis.bounds(), SensorCache::new(rows, None));
        let terms = |at: &[f64]| with_prior(&cache, &hypothesis, untouched, at);
        let climb =
            |from: Point| climb_from(&bounds, from, iterations, TOLERANCE_NATS, terms).into_maximum(&bounds, terms);
        let mut found = climb(if rows.sketch().is_none() { sketch } else { Point::new(&sketch.at, terms) });
        for _ in 0..steps_of_one {
            let Some(further) = single_parameter_step(&bounds, &found, TOLERANCE_NATS, terms) else { break };
            found = climb(further);
        }
        let noise = hypothesis.noise(rows, &found.at);
        let without = without_each_block(&found, &bounds, rows);
        let (witnesses, _) = hypothesis.witnesses(rows, &found.at);
        let cross_validated = hypothesis.scores_by_block(&without, noise, &witnesses, untouched, rows);
        let scores = cache.scores(&hypothesis, &found.at, untouched);
        drop(cache);
        let penalty = complexity_penalty(&found, &hypothesis, &bounds);
        Fitted {
            errors: jackknife_errors(&found.at, &without),
            complexity_penalties: if hypothesis.moves() { [penalty, 0.0] } else { [0.0, penalty] },
            values: found.at,
            hypothesis,
            noise,
            witnesses,
            scores,
            cross_validated,
        }
    }

    /// Returns what the sensor faces at these values and at the shifted points of a first iteration.
    pub fn faced(&self, values: &[f64]) -> FacedRows<'a> {
        let (sample, untouched) = self.sketched();
        let cache = SensorCache::new(sample, None);
        let terms = |at: &[f64]| self.terms(&cache, &untouched, at);
        Point::new(values, terms).into_maximum(&self.hypothesis.bounds(), terms);
        cache.into_faced()
    }

    /// Returns the rows of a sketch with the scores of untouched channels.
    fn sketched(&self) -> (&'a Sample<'a>, Cow<'a, Scores>) {
        match self.context.rows.sketch() {
            Some(sketch) => {
                let untouched = self.untouched.every(sketch.every, sketch.sample.row_blocks());
                (&sketch.sample, Cow::Owned(untouched))
            }
            None => (self.context.rows, Cow::Borrowed(self.untouched)),
        }
    }

    fn terms(&self, cache: &SensorCache, untouched: &Scores, at: &[f64]) -> Vec<f64> {
        with_prior(cache, &self.hypothesis, untouched, at)
    }
}

/// Returns the log-likelihood of each row. The last term is the log prior, which belongs to no block.
fn with_prior(cache: &SensorCache, hypothesis: &Hypothesis, untouched: &Scores, at: &[f64]) -> Vec<f64> {
    let mut terms = cache.scores(hypothesis, at, untouched).by_row();
    terms.push(hypothesis.log_prior(at));
    terms
}

/// Returns the parameters without each block in turn, by the one-step jackknife.
fn without_each_block(found: &Maximum, bounds: &[Bounds], rows: &Identification) -> Vec<Vec<f64>> {
    let without = |block: usize| {
        let left_out = rows.of_block(block);
        found.without(bounds, |row| left_out.contains(&row))
    };
    (0..rows.blocks).map(without).collect()
}

/// Returns standard errors by the jackknife (Efron and Tibshirani 1993, equation 11.5).
fn jackknife_errors(values: &[f64], without: &[Vec<f64>]) -> Vec<f64> {
    let n = without.len() as f64;
    let error = |i: usize| {
        let mean = without.iter().map(|w| w[i]).sum::<f64>() / n;
        ((n - 1.0) / n * without.iter().map(|w| (w[i] - mean) * (w[i] - mean)).sum::<f64>()).sqrt()
    };
    (0..values.len()).map(error).collect()
}

/// Returns how far the evidence lies below the cross-validated score. The Occam factor is the prior density at the maximum times
/// the posterior volume. The cross-validated score already loses one nat per parameter where rows are independent, which is
/// given back.
fn complexity_penalty(found: &Maximum, hypothesis: &Hypothesis, bounds: &[Bounds]) -> f64 {
    // The prior is the last of the terms.
    let rows = found.scores.len() - 1;
    let volume = found.log_volume(bounds, &hypothesis.prior_precisions(), |term| term < rows);
    let prior = hypothesis.log_prior_peak() + hypothesis.log_prior(&found.at);
    -(bounds.len() as f64 + (prior + volume).min(0.0))
}
