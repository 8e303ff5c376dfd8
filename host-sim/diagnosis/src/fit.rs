//! Fitting: the parameters of a hypothesis by maximum a posteriori, judged on runs that they were not fitted on.

mod problem;

use std::ops::Range;

use problem::Problem;
use rayon::prelude::*;

use super::calibration::Calibration;
use super::channel::Channel;
use super::gain::Gain;
use super::hypothesis::{Hypothesis, LogLikelihood};
use super::memo::Sights;
use super::method::Method;
use super::own_error::OwnErrors;
use mindgap_foundations::statistics::maximise::Point;
use mindgap_learning::evaluation::observations::Observations;
use mindgap_models::effects::applied::AppliedEffect;
use mindgap_models::effects::chain::EffectChain;
use mindgap_models::effects::{Candidate, Effect};
use mindgap_models::simulator::baseline::Baseline;
use mindgap_models::sonar::SensorLaw;

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
    /// What the simulator does not know of its own motion, and these logs tell; none where it knows it better than they do.
    pub own_errors: Option<OwnErrors>,
    /// What the effects that the simulator has already explain of these logs in each channel, nats.
    pub explained_already: [f64; Channel::ALL.len()],
    top_speed_cm_s: f64,
    /// What sketches look at where there are many rows.
    few: Option<Few>,
}

/// Some of many rows.
struct Few {
    rows: Observations,
    /// One in so many.
    every: usize,
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
    /// Standard errors of the parameters, by the jackknife over blocks.
    pub errors: Vec<f64>,
    /// What the evidence exceeds the held-out log-likelihood by, nats: less than nothing, the price of freedom.
    pub occam: f64,
}

/// A fit ends after this many iterations: ridges of two parameters take twenty.
pub const MOST_ITERATIONS: usize = 30;
/// Whether a fit is promising shows on so many rows, as many as 24 runs of a minute have: of twice as many a sketch looks at
/// every second one.
const MOST_SKETCHED_ROWS: usize = 1500;
/// So many of the fits that were sketched are carried on: more than twice as many as the rivals beside which an effect has to
/// gain more.
const PROMISING: usize = 10;
/// An iteration that gains less ends the fit, nats: a tenth of what a parameter costs.
pub const TOLERANCE_NATS: f64 = 0.1;
/// 95 % of a normal law lie within so many standard errors.
const NORMAL_95: f64 = 1.96;

impl<'a> FitContext<'a> {
    /// Observations against a simulator.
    pub fn new(baseline: &'a Baseline<'a>, observations: &'a Observations, method: Method) -> Self {
        let every = observations.rows.len().div_ceil(MOST_SKETCHED_ROWS);
        FitContext {
            baseline,
            observations,
            few: (every > 1).then(|| Few { rows: observations.every(every), every }),
            catalogue: method.catalogue,
            calibration: method.calibration_for(observations.rows.len(), baseline.trained_on()),
            seed: method.seed,
            own_errors: OwnErrors::of(baseline, observations),
            explained_already: explained_already(baseline, observations),
            top_speed_cm_s: observations.top_speed_cm_s(),
        }
    }

    /// What of a channel forms of the effects that the simulator has already could leave over that are not quite right, nats:
    /// as much as those of effects that were found.
    pub fn feigned_already(&self, channel: Channel) -> f64 {
        self.calibration.further_share * self.explained_already[channel.index()]
    }

    /// Where fits of an effect start.
    pub fn initial_guesses(&self, candidate: &Candidate) -> Vec<Vec<f64>> {
        candidate.variant.initial_guesses(self.top_speed_cm_s)
    }
}

fn explained_already(baseline: &Baseline, observations: &Observations) -> [f64; Channel::ALL.len()] {
    if baseline.applied.is_empty() {
        return Default::default();
    }
    let [with, without] = [Hypothesis::none(baseline), Hypothesis::bare()]
        .map(|hypothesis| hypothesis.log_likelihood(baseline, observations, &[], None));
    Channel::ALL.map(|channel| (with.of(channel) - without.of(channel)).max(0.0))
}

impl Fitted {
    /// No effect at all.
    pub fn none(context: &FitContext) -> Self {
        Fitted::at(Hypothesis::none(context.baseline), Vec::new(), context)
    }

    /// Effects that are known and need no fit.
    pub fn given(applied: &[AppliedEffect], context: &FitContext) -> Self {
        let (candidates, values): (Vec<Candidate>, Vec<Vec<f64>>) =
            applied.iter().flat_map(AppliedEffect::resolve).unzip();
        Fitted::at(Hypothesis::none(context.baseline).of(candidates), values.concat(), context)
    }

    fn at(hypothesis: Hypothesis, values: Vec<f64>, context: &FitContext) -> Self {
        let log_likelihood = hypothesis.log_likelihood(context.baseline, context.observations, &values, None);
        let held_out = context.observations.by_block(&log_likelihood.total());
        let errors = vec![0.0; values.len()];
        Fitted { hypothesis, values, log_likelihood, held_out, errors, occam: 0.0 }
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
        &self.values[self.parameters_of(place)]
    }

    /// Where the parameters of one of its effects are among all.
    pub fn parameters_of(&self, place: usize) -> Range<usize> {
        let candidates = &self.hypothesis.candidates;
        let before: usize = candidates[..place].iter().map(|c| c.variant.parameters.len()).sum();
        before..before + candidates[place].variant.parameters.len()
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

    /// The same over all blocks, by the evidence.
    pub fn gain_over(&self, other: &Fitted) -> Gain {
        Gain::of(&self.gains_over(other)).less(other.occam - self.occam)
    }

    /// By how much a channel is likelier than under `other`, nats.
    pub fn gained_in(&self, channel: Channel, other: &Fitted) -> f64 {
        self.log_likelihood.of(channel) - other.log_likelihood.of(channel)
    }

    /// Logarithm of the marginal likelihood, by which hypotheses are compared: that of the logs under all values that the
    /// priors allow, by Laplace's method (Kass and Raftery 1995, section 4.1). Whole runs are its unit: in place of the
    /// likelihood at its maximum it takes that of each block at the parameters of the others, which is less by one nat a
    /// parameter where rows are independent, and by more where they come in clumps.
    pub fn log_evidence(&self) -> f64 {
        self.held_out.iter().sum::<f64>() + self.occam
    }

    /// The values between which a parameter lies with 95 %, within its bounds.
    pub fn interval(&self, parameter: usize) -> [f64; 2] {
        let reach = NORMAL_95 * self.errors[parameter];
        let [low, high] =
            self.hypothesis.parameters().nth(parameter).map_or([f64::NEG_INFINITY, f64::INFINITY], |p| p.bounds);
        [(self.values[parameter] - reach).max(low), (self.values[parameter] + reach).min(high)]
    }

    /// The reported parameters of one of its effects that lie at a bound.
    pub fn at_bound(&self, place: usize) -> Vec<&'static str> {
        let parameters = self.hypothesis.candidates[place].variant.parameters.iter().zip(self.values_of(place));
        parameters.filter(|(parameter, value)| parameter.is_at_a_bound(**value)).map(|(p, _)| p.name).collect()
    }

    /// How steps scatter that it leaves: forward (cm), lateral (cm), turn (rad).
    pub fn scatter(&self, context: &FitContext) -> [f64; 3] {
        self.hypothesis.scatter(context.baseline, context.observations, &self.values)
    }

    /// The log-likelihood of rows that it was not fitted on.
    pub fn judged_on(&self, others: &Observations, context: &FitContext) -> LogLikelihood {
        self.hypothesis.log_likelihood_with(self.scatter(context), context.baseline, others, &self.values)
    }

    /// Adds one effect and fits everything anew, from these values and the variant's guesses.
    pub fn with(&self, candidate: Candidate, context: &FitContext) -> Fitted {
        let (problem, sketch) = self.sketched_with(candidate, None, context);
        problem.settle(sketch)
    }

    /// Adds each variant of each effect that is not there yet. `alone` are the same variants fitted on nothing: what touches
    /// other stages than these effects need not be fitted again, and of the others only the most promising are fitted to the
    /// end.
    pub fn with_each(&self, alone: Option<&[Fitted]>, context: &FitContext) -> Vec<Fitted> {
        let mut fresh = Candidate::all(context.catalogue);
        let hears_by_a_ray = context.baseline.sonar.as_ref().is_some_and(SensorLaw::is_ray);
        let is_sought = |candidate: &Candidate| hears_by_a_ray || !candidate.variant.is_for_a_ray();
        fresh.retain(|candidate| !self.ids().contains(&candidate.effect) && is_sought(candidate));
        let Some(alone) = alone else {
            return fresh.par_iter().map(|candidate| self.with(*candidate, context)).collect();
        };
        let apart = |candidate: &Candidate| {
            alone.iter().find(|f| f.hypothesis.candidates[0] == *candidate).filter(|f| self.is_apart_from(f))
        };
        let combined = fresh.par_iter().filter_map(|c| Some((*c, self.combined_with(apart(c)?, context))));
        let mut fits: Vec<(Candidate, Fitted)> = combined.collect();
        let sights =
            self.hypothesis.senses().then(|| self.problem(self.hypothesis.clone(), context).sights(&self.values));
        let sketches = fresh.par_iter().filter(|c| apart(c).is_none());
        let mut sketches: Vec<_> = sketches.map(|c| (*c, self.sketched_with(*c, sights.as_ref(), context))).collect();
        sketches.sort_by(|a, b| b.1.1.value().total_cmp(&a.1.1.value()));
        sketches.truncate(PROMISING);
        fits.par_extend(sketches.into_par_iter().map(|(c, (problem, sketch))| (c, problem.settle(sketch))));
        // In the order of the catalogue, whichever way they came about.
        let place = |candidate: &Candidate| fresh.iter().position(|c| c == candidate);
        fits.sort_by_key(|(candidate, _)| place(candidate));
        fits.into_iter().map(|(_, fit)| fit).collect()
    }

    /// A few iterations of the fit with one more effect; `sights` are what the sensor faces about these values, if that is
    /// known.
    fn sketched_with<'a>(
        &'a self,
        candidate: Candidate,
        sights: Option<&Sights>,
        context: &'a FitContext<'a>,
    ) -> (Problem<'a>, Point) {
        let starts = context.initial_guesses(&candidate).into_iter();
        let starts = starts.map(|own| [self.values.as_slice(), own.as_slice()].concat()).collect();
        let problem = self.problem(self.hypothesis.with(candidate), context);
        let sketch = problem.sketch(starts, sights);
        (problem, sketch)
    }

    /// A fit of a hypothesis that takes what it does not touch from here.
    fn problem<'a>(&'a self, hypothesis: Hypothesis, context: &'a FitContext<'a>) -> Problem<'a> {
        Problem { hypothesis, untouched: &self.log_likelihood, context }
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
        let problem = none.problem(self.hypothesis.of(candidates), context);
        let sketch = problem.sketch(vec![values], None);
        problem.settle(sketch)
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
        let errors = [self.errors.as_slice(), &other.errors].concat();
        let occam = self.occam + other.occam;
        Fitted { hypothesis: self.hypothesis.of(candidates), values, log_likelihood, held_out, errors, occam }
    }
}

/// The best fit of each effect that was added last, best first.
pub fn best_of_each(mut fits: Vec<Fitted>) -> Vec<Fitted> {
    fits.sort_by(|a, b| b.log_evidence().total_cmp(&a.log_evidence()));
    let mut seen = Vec::new();
    fits.retain(|fit| {
        let id = fit.ids().last().copied();
        let fresh = !seen.contains(&id);
        seen.push(id);
        fresh
    });
    fits
}

#[cfg(test)]
mod tests;
