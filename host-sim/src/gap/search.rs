//! The search for the effects that explain the gap: every form is fitted and judged on runs that it was not fitted on.

use rayon::prelude::*;

use super::baseline::Baseline;
use super::effect::Form;
use super::evidence::Evidence;
use super::hypothesis::{Hypothesis, Terms};
use crate::ascent::{Maximum, climb};

/// A hypothesis, fitted.
#[derive(Clone)]
pub struct Fitted {
    /// What is supposed.
    pub hypothesis: Hypothesis,
    /// Its parameters, fitted on all runs.
    pub values: Vec<f64>,
    /// Log-likelihoods there.
    pub terms: Terms,
    /// The log-likelihood of each run with the parameters fitted on the others.
    pub held_out: Vec<f64>,
}

/// How much better one hypothesis does than another on runs that it was not fitted on.
#[derive(Clone, Copy, Debug)]
pub struct Gain {
    /// Nats over all runs.
    pub nats: f64,
    /// Standard error over runs.
    pub error: f64,
}

/// Rounds of a fit.
const ROUNDS: usize = 12;
/// A round that gains less ends the fit, nats.
const ENOUGH: f64 = 0.05;

impl Fitted {
    /// No effect at all.
    pub fn none(baseline: &Baseline, evidence: &Evidence) -> Self {
        let hypothesis = Hypothesis::none();
        let terms = hypothesis.terms(baseline, evidence, &[], None);
        let held_out = evidence.by_run(&total(&terms));
        Fitted { hypothesis, values: Vec::new(), terms, held_out }
    }

    /// The log-likelihood of each row.
    pub fn total(&self) -> Vec<f64> {
        total(&self.terms)
    }

    /// The names of its effects.
    pub fn ids(&self) -> Vec<&'static str> {
        self.hypothesis.forms.iter().map(|f| f.id).collect()
    }

    /// By how much this beats `other` on held-out runs.
    pub fn gain_over(&self, other: &Fitted) -> Gain {
        Gain::of(self.held_out.iter().zip(&other.held_out).map(|(a, b)| a - b).collect())
    }

    /// Adds one form and fits everything anew, from these values and the form's starts.
    pub fn with(&self, form: &'static Form, baseline: &Baseline, evidence: &Evidence) -> Fitted {
        let hypothesis = self.hypothesis.with(form);
        let start = |own: &&'static [f64]| self.values.iter().chain(own.iter()).copied().collect::<Vec<f64>>();
        fit(hypothesis, form.starts.iter().map(start).collect(), &self.terms, baseline, evidence)
    }

    /// Leaves the effect at `place` out and fits the others anew.
    pub fn without(&self, place: usize, baseline: &Baseline, evidence: &Evidence) -> Fitted {
        let mut forms = self.hypothesis.forms.clone();
        let before: usize = forms[..place].iter().map(|f| f.parameters.len()).sum();
        let count = forms.remove(place).parameters.len();
        let mut values = self.values.clone();
        values.drain(before..before + count);
        if forms.is_empty() {
            return Fitted::none(baseline, evidence);
        }
        let none = Fitted::none(baseline, evidence);
        fit(Hypothesis { forms }, vec![values], &none.terms, baseline, evidence)
    }
}

impl Gain {
    /// The gain of each run, together.
    pub fn of(by_run: Vec<f64>) -> Self {
        let n = by_run.len() as f64;
        let nats: f64 = by_run.iter().sum();
        let middle = nats / n;
        let variance = by_run.iter().map(|d| (d - middle) * (d - middle)).sum::<f64>() / (n - 1.0).max(1.0);
        Gain { nats, error: (n * variance).sqrt() }
    }

    /// Gain in standard errors.
    pub fn z(&self) -> f64 {
        self.nats / self.error.max(1e-9)
    }
}

/// Every form on top of what was found so far, side by side; the order is that of the forms.
pub fn extend(so_far: &Fitted, forms: &[&'static Form], baseline: &Baseline, evidence: &Evidence) -> Vec<Fitted> {
    let fresh = forms.iter().filter(|form| !so_far.ids().contains(&form.id)).collect::<Vec<_>>();
    fresh.into_par_iter().map(|form| so_far.with(form, baseline, evidence)).collect()
}

fn fit(
    hypothesis: Hypothesis,
    starts: Vec<Vec<f64>>,
    untouched: &Terms,
    baseline: &Baseline,
    evidence: &Evidence,
) -> Fitted {
    let bounds = hypothesis.bounds();
    let terms = |at: &[f64]| total(&hypothesis.terms(baseline, evidence, at, Some(untouched)));
    let value = |at: &[f64]| terms(at).iter().sum::<f64>();
    let best = starts.iter().map(|s| (value(s), s)).max_by(|a, b| a.0.total_cmp(&b.0));
    let start = best.map(|(_, s)| s.clone()).unwrap_or_default();
    let found = climb(&bounds, &start, ROUNDS, ENOUGH, terms);
    let held_out = held_out(&found, &hypothesis, untouched, baseline, evidence);
    let terms = hypothesis.terms(baseline, evidence, &found.at, Some(untouched));
    Fitted { hypothesis, values: found.at, terms, held_out }
}

/// The log-likelihood of each run with the parameters that the others alone would have.
fn held_out(
    found: &Maximum,
    hypothesis: &Hypothesis,
    untouched: &Terms,
    baseline: &Baseline,
    evidence: &Evidence,
) -> Vec<f64> {
    let bounds = hypothesis.bounds();
    let scatter = hypothesis.scatter(baseline, evidence, &found.at);
    (0..evidence.runs)
        .map(|run| {
            let left_out = evidence.of_run(run);
            let values = found.without(&bounds, |row| left_out.contains(&row));
            hypothesis.of_run(baseline, evidence, run, &values, scatter, untouched)
        })
        .collect()
}

fn total(terms: &Terms) -> Vec<f64> {
    terms.motion.iter().zip(&terms.sonar).map(|(m, s)| m + s).collect()
}
