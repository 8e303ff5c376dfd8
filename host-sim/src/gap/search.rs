//! The search for the effects that explain the gap: every form is fitted and judged on runs that it was not fitted on.

use rayon::prelude::*;

use super::calibration::{Calibration, Gate};
use super::hypothesis::{Hypothesis, Terms};
use crate::effects::applied::AppliedEffect;
use crate::effects::effect::Variant;
use crate::effects::{self, chain::EffectChain};
use crate::evaluation::observations::Observations;
use crate::simulator::baseline::Baseline;
use crate::statistics::maximise::{Maximum, climb};

/// A hypothesis, fitted.
#[derive(Clone)]
pub struct Fitted {
    /// What is supposed.
    pub hypothesis: Hypothesis,
    /// Its parameters, fitted on all runs.
    pub values: Vec<f64>,
    /// Log-likelihoods there.
    pub terms: Terms,
    /// The log-likelihood of each block with the parameters fitted on the others.
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

/// What is judged, and against what.
#[derive(Clone, Copy)]
pub struct Given<'a> {
    /// The simulator.
    pub baseline: &'a Baseline<'a>,
    /// The logs.
    pub evidence: &'a Observations,
    /// What counts.
    pub calibration: Calibration,
}

impl<'a> Given<'a> {
    /// Observations against a simulator, by thresholds that become its size.
    pub fn new(baseline: &'a Baseline<'a>, evidence: &'a Observations, calibration: Calibration) -> Self {
        Given { baseline, evidence, calibration: calibration.for_rows(evidence.rows.len()) }
    }
}

/// What a parameter costs, nats.
const OCCAM: f64 = 1.0;
/// Rounds of a fit.
const ROUNDS: usize = 30;
/// A round that gains less ends the fit, nats.
const ENOUGH: f64 = 0.1;

impl Fitted {
    /// No effect at all.
    pub fn none(logs: &Given) -> Self {
        let hypothesis = Hypothesis::none(logs.baseline);
        let terms = hypothesis.terms(logs.baseline, logs.evidence, &[], None);
        let held_out = logs.evidence.by_block(&terms.total());
        Fitted { hypothesis, values: Vec::new(), terms, held_out }
    }

    /// This with effects that are known, which need no fit.
    pub fn as_given(&self, added: &[AppliedEffect], logs: &Given) -> Self {
        let known = || added.iter().filter_map(|a| Some((a.variant()?, &a.values)));
        let hypothesis = self.hypothesis.of(known().map(|(form, _)| form).collect());
        let values: Vec<f64> = known().flat_map(|(_, values)| values).copied().collect();
        let terms = hypothesis.terms(logs.baseline, logs.evidence, &values, None);
        let held_out = logs.evidence.by_block(&terms.total());
        Fitted { hypothesis, values, terms, held_out }
    }

    /// Its effects at the fitted parameters.
    pub fn effects(&self) -> EffectChain {
        self.hypothesis.at(&self.values)
    }

    /// The names of its effects.
    pub fn ids(&self) -> Vec<&'static str> {
        self.hypothesis.forms.iter().map(|f| f.id).collect()
    }

    /// The parameters of one of its effects.
    pub fn values_of(&self, place: usize) -> &[f64] {
        let forms = &self.hypothesis.forms;
        let before: usize = forms[..place].iter().map(|f| f.parameters.len()).sum();
        &self.values[before..before + forms[place].parameters.len()]
    }

    /// Its effects as a simulator takes them.
    pub fn added(&self) -> Vec<AppliedEffect> {
        let forms = self.hypothesis.forms.iter().enumerate();
        forms.map(|(place, form)| AppliedEffect::new(form, self.values_of(place))).collect()
    }

    /// By how much this beats `other` on each held-out block.
    pub fn gains_over(&self, other: &Fitted) -> Vec<f64> {
        self.held_out.iter().zip(&other.held_out).map(|(a, b)| a - b).collect()
    }

    /// The same over all blocks.
    pub fn gain_over(&self, other: &Fitted) -> Gain {
        Gain::of(&self.gains_over(other))
    }

    /// What ranks hypotheses: the held-out log-likelihood, less a little for each parameter, so that of two that
    /// explain the same the simpler one is first.
    pub fn score(&self) -> f64 {
        self.held_out.iter().sum::<f64>() - OCCAM * self.values.len() as f64
    }

    /// Whether the effect that was added last touches a stage that others touch.
    pub fn shares_a_stage(&self) -> bool {
        let Some((last, others)) = self.hypothesis.forms.split_last() else { return false };
        others.iter().any(|f| f.moves() && last.moves() || f.senses() && last.senses())
    }

    /// Whether no stage is touched by both.
    fn is_apart_from(&self, other: &Fitted) -> bool {
        let touches = |f: &Fitted| {
            let forms = &f.hypothesis.forms;
            [forms.iter().any(|f| f.moves()), forms.iter().any(|f| f.senses())]
        };
        touches(self).iter().zip(touches(other)).all(|(a, b)| !(*a && b))
    }

    /// This and a fit that is apart from it: nothing needs to be fitted again.
    fn beside(&self, other: &Fitted, logs: &Given) -> Fitted {
        let moved = other.hypothesis.forms.iter().any(|f| f.moves());
        let terms = Terms {
            motion: if moved { other.terms.motion.clone() } else { self.terms.motion.clone() },
            sonar: if moved { self.terms.sonar.clone() } else { other.terms.sonar.clone() },
        };
        let none = Fitted::none(logs);
        let held_out = self.held_out.iter().zip(other.gains_over(&none)).map(|(s, g)| s + g).collect();
        let forms = self.hypothesis.forms.iter().chain(&other.hypothesis.forms).copied().collect();
        let values = self.values.iter().chain(&other.values).copied().collect();
        Fitted { hypothesis: self.hypothesis.of(forms), values, terms, held_out }
    }

    /// The log-likelihood of rows that it was not fitted on; `logs` are those that it was.
    pub fn judged_on(&self, others: &Observations, logs: &Given) -> Terms {
        let scatter = self.hypothesis.scatter(logs.baseline, logs.evidence, &self.values);
        self.hypothesis.terms_of_others(logs.baseline, others, &self.values, scatter)
    }

    /// Adds one form and fits everything anew, from these values and the form's starts.
    pub fn with(&self, form: &'static Variant, logs: &Given) -> Fitted {
        let hypothesis = self.hypothesis.with(form);
        let start = |own: &&'static [f64]| self.values.iter().chain(own.iter()).copied().collect::<Vec<f64>>();
        fit(hypothesis, form.starts.iter().map(start).collect(), &self.terms, logs)
    }

    /// Leaves the effect at `place` out and fits the others anew.
    pub fn without(&self, place: usize, logs: &Given) -> Fitted {
        let mut forms = self.hypothesis.forms.clone();
        let before: usize = forms[..place].iter().map(|f| f.parameters.len()).sum();
        let count = forms.remove(place).parameters.len();
        let mut values = self.values.clone();
        values.drain(before..before + count);
        if forms.is_empty() {
            return Fitted::none(logs);
        }
        let none = Fitted::none(logs);
        fit(self.hypothesis.of(forms), vec![values], &none.terms, logs)
    }
}

impl Gain {
    /// Nothing.
    pub const NONE: Gain = Gain { nats: 0.0, error: 0.0 };

    /// The gain of each block, together.
    pub fn of(by_block: &[f64]) -> Self {
        let n = by_block.len() as f64;
        let nats: f64 = by_block.iter().sum();
        let middle = nats / n;
        let variance = by_block.iter().map(|d| (d - middle) * (d - middle)).sum::<f64>() / (n - 1.0).max(1.0);
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

/// The best form of every effect on top of what was found so far, the best effect first. `alone` are the same forms
/// fitted on nothing, where they are known: what touches other stages than those before need not be fitted again.
pub fn extend(so_far: &Fitted, alone: Option<&[Fitted]>, logs: &Given) -> Vec<Fitted> {
    let fresh: Vec<_> = effects::all().into_iter().filter(|form| !so_far.ids().contains(&form.id)).collect();
    let one = |form: &&'static Variant| {
        let known = alone.into_iter().flatten().find(|f| std::ptr::eq(f.hypothesis.forms[0], *form));
        match known.filter(|f| so_far.is_apart_from(f)) {
            Some(known) => so_far.beside(known, logs),
            None => so_far.with(form, logs),
        }
    };
    fresh.par_iter().map(one).collect()
}

/// The best fit of each effect that was added last, best first.
pub fn best_of_each(mut fits: Vec<Fitted>) -> Vec<Fitted> {
    fits.sort_by(|a, b| b.score().total_cmp(&a.score()));
    let mut seen = Vec::new();
    fits.retain(|fit| {
        let id = fit.ids().last().copied();
        let fresh = !seen.contains(&id);
        seen.push(id);
        fresh
    });
    fits
}

fn fit(hypothesis: Hypothesis, starts: Vec<Vec<f64>>, untouched: &Terms, logs: &Given) -> Fitted {
    let bounds = hypothesis.bounds();
    let terms = |at: &[f64]| hypothesis.terms(logs.baseline, logs.evidence, at, Some(untouched)).total();
    let value = |at: &[f64]| terms(at).iter().sum::<f64>();
    let best = starts.iter().map(|s| (value(s), s)).max_by(|a, b| a.0.total_cmp(&b.0));
    let start = best.map(|(_, s)| s.clone()).unwrap_or_default();
    let found = climb(&bounds, &start, ROUNDS, ENOUGH, terms);
    let held_out = held_out(&found, &hypothesis, untouched, logs);
    let terms = hypothesis.terms(logs.baseline, logs.evidence, &found.at, Some(untouched));
    Fitted { hypothesis, values: found.at, terms, held_out }
}

/// The log-likelihood of each block with the parameters that the others alone would have.
fn held_out(found: &Maximum, hypothesis: &Hypothesis, untouched: &Terms, logs: &Given) -> Vec<f64> {
    let bounds = hypothesis.bounds();
    let scatter = hypothesis.scatter(logs.baseline, logs.evidence, &found.at);
    (0..logs.evidence.blocks)
        .map(|block| {
            let left_out = logs.evidence.of_block(block);
            let values = found.without(&bounds, |row| left_out.contains(&row));
            hypothesis.of_block(logs.baseline, logs.evidence, block, &values, scatter, untouched)
        })
        .collect()
}
