//! Fitting: the parameters of a hypothesis by maximum a posteriori, cross-validated between blocks.

pub mod parts;
mod problem;

use std::ops::Range;
use std::sync::OnceLock;

use parts::Part;
use problem::Problem;
use rayon::prelude::*;

use super::calibration::Calibration;
use super::explanation::Explanation;
use super::further_shares::FurtherShares;
use super::hypothesis::Hypothesis;
use super::method::Method;
use super::motion_uncertainty::MotionUncertainty;
use super::sample::{HoldOut, Identification, Sample};
use super::scores::Scores;
use super::sensor_cache::FacedRows;
use super::witnesses::Witnesses;
use mindgap_foundations::channel::Channel;
use mindgap_foundations::statistics::maximise::Point;
use mindgap_foundations::statistics::summary::student_95;
use mindgap_logs::Robot;
use mindgap_models::effects::applied::AppliedEffect;
use mindgap_models::effects::chain::EffectChain;
use mindgap_models::effects::{Candidate, Effect};
use mindgap_models::simulator::baseline::{Baseline, MotionModel};
use mindgap_models::sonar::SensorLaw;

/// The data that explanations are fitted to, and the settings.
pub struct FitContext<'a> {
    /// The rows, with the simulator that they are compared with.
    pub rows: &'a Identification<'a>,
    /// The effects that compete.
    pub catalogue: Vec<&'static Effect>,
    /// Thresholds for this number of rows.
    pub calibration: Calibration,
    /// Model-form error by effect.
    pub further_shares: &'static FurtherShares,
    /// Seed of random draws.
    pub seed: u64,
    /// See [`Method::is_driving`].
    pub is_driving: bool,
    /// What the training logs leave open of the simulator's motion, as far as these rows can tell more.
    pub motion_uncertainty: Option<MotionUncertainty>,
    /// Nats by channel that the effects explain which the simulator has already.
    pub already_explained: [f64; Channel::COUNT],
    top_speed: f64,
    null: OnceLock<Fitted>,
}

/// A hypothesis fitted to identification rows: the simulator as it is, or effects, a formula among them.
#[derive(Clone)]
pub struct Fitted {
    /// The effects.
    pub hypothesis: Hypothesis,
    /// Their parameters, fitted to all blocks.
    pub values: Vec<f64>,
    /// Standard errors of the parameters, by the jackknife over blocks.
    pub errors: Vec<f64>,
    /// Standard deviations of the residuals: forward (cm), lateral (cm), turn (rad).
    pub noise: [f64; 3],
    /// Where the effects show on what the robot measures of its own motion.
    pub witnesses: Witnesses,
    /// Log-likelihoods at the fitted parameters.
    pub scores: Scores,
    /// Log-likelihoods of each block at the parameters of the other blocks.
    pub cross_validated: Scores,
    /// See [`Explanation::complexity_penalty`]: that of the effects that change the motion, and of those of the sensor alone.
    pub complexity_penalties: [f64; 2],
}

/// Maximum number of iterations of a fit; curved valleys of two parameters take twenty.
pub const MOST_ITERATIONS: usize = 30;
/// Number of preliminary fits that are refined to convergence: more than twice the number of rivals with which an effect is
/// ambiguous.
const PROMISING: usize = 7;
/// A sketch is promising if it gains more, nats: what one parameter costs, fitted to rows on which it explains nothing.
const LEAST_NATS: f64 = 1.0;
/// A fit has converged when an iteration gains less, nats: a tenth of what a parameter costs.
pub const TOLERANCE_NATS: f64 = 0.1;

impl<'a> FitContext<'a> {
    /// Prepares fits to these rows.
    pub fn new(rows: &'a Identification<'a>, method: Method) -> Self {
        FitContext {
            rows,
            catalogue: candidates(method, rows),
            calibration: method.calibration_for(rows.rows.len(), rows.baseline.trained_on()),
            further_shares: method.further_shares,
            seed: method.seed,
            is_driving: method.is_driving,
            motion_uncertainty: MotionUncertainty::of(rows),
            already_explained: already_explained(rows),
            top_speed: rows.top_speed(),
            null: OnceLock::new(),
        }
    }

    /// Returns the simulator.
    pub fn baseline(&self) -> &'a Baseline<'a> {
        self.rows.baseline
    }

    /// Returns the nats of a channel that model-form error of the simulator's own effects could account for.
    pub fn form_error_nats(&self, channel: Channel) -> f64 {
        self.calibration.further_share * self.already_explained[channel.index()]
    }

    /// Returns where fits of an effect start.
    pub fn initial_guesses(&self, candidate: &Candidate) -> Vec<Vec<f64>> {
        candidate.variant.initial_guesses(self.top_speed)
    }
}

/// Returns the effects that compete against this simulator.
fn candidates(method: Method, rows: &Identification) -> Vec<&'static Effect> {
    let is_known = rows.baseline.motion.as_ref().is_none_or(MotionModel::is_learned);
    let is_there = |effect: &&Effect| method.place.is_none_or(|place| effect.may_sit_in(place));
    let competing = method.catalogue.iter().copied().filter(is_there);
    competing.filter(|effect| is_known || !effect.needs_known_robot).collect()
}

fn already_explained(rows: &Identification) -> [f64; Channel::COUNT] {
    if rows.baseline.applied.is_empty() {
        return Default::default();
    }
    let [with, without] = [Hypothesis::null(rows.baseline), Hypothesis::without_applied(rows.baseline)]
        .map(|hypothesis| hypothesis.scores(rows, &[]));
    Channel::ALL.map(|channel| (with.total_of(channel) - without.total_of(channel)).max(0.0))
}

impl Explanation for Fitted {
    fn cross_validated(&self) -> &Scores {
        &self.cross_validated
    }

    fn predict(&self, rows: &HoldOut) -> Scores {
        let witnesses = self.hypothesis.witnessed(&self.witnesses, rows, &self.values);
        self.scores_within(self.noise, rows).with_witnesses(&witnesses)
    }

    fn complexity_penalty(&self) -> f64 {
        self.complexity_penalties.iter().sum()
    }
}

impl Fitted {
    /// The null hypothesis: the simulator as it is.
    pub fn null(context: &FitContext) -> Self {
        // Every fit of a part starts from it.
        let null = || Fitted::at(Hypothesis::null(context.baseline()), Vec::new(), context);
        context.null.get_or_init(null).clone()
    }

    /// Effects whose parameters are given and not fitted.
    pub fn given(applied: &[AppliedEffect], context: &FitContext) -> Self {
        let (candidates, values): (Vec<Candidate>, Vec<Vec<f64>>) =
            applied.iter().flat_map(|effect| effect.resolve(&context.baseline().robot)).unzip();
        Fitted::at(Hypothesis::null(context.baseline()).of(candidates), values.concat(), context)
    }

    fn at(hypothesis: Hypothesis, values: Vec<f64>, context: &FitContext) -> Self {
        let noise = hypothesis.noise(context.rows, &values);
        let (witnesses, witnessed) = hypothesis.witnesses(context.rows, &values);
        let scores = hypothesis.scores_within(noise, context.rows, &values).with_witnesses(&witnessed);
        let errors = vec![0.0; values.len()];
        Fitted {
            hypothesis,
            values,
            errors,
            noise,
            witnesses,
            cross_validated: scores.clone(),
            scores,
            complexity_penalties: [0.0; 2],
        }
    }

    /// The same effects with their parameters taken as given: nothing is left to cross-validate or to penalise.
    pub fn taken_as_given(&self) -> Self {
        Fitted { cross_validated: self.scores.clone(), complexity_penalties: [0.0; 2], ..self.clone() }
    }

    /// Returns its effects at the fitted parameters.
    pub fn effects(&self) -> EffectChain {
        self.hypothesis.at(&self.values)
    }

    /// Returns the ids of its effects.
    pub fn ids(&self) -> Vec<&'static str> {
        self.hypothesis.candidates.iter().map(|c| c.effect).collect()
    }

    /// Returns the ids of its effects for people.
    pub fn name(&self) -> String {
        if self.hypothesis.candidates.is_empty() { "the simulator".into() } else { self.ids().join("+") }
    }

    /// Returns the parameters of one of its effects.
    pub fn values_of(&self, effect: usize) -> &[f64] {
        &self.values[self.parameters_of(effect)]
    }

    /// Returns the indices of one effect's parameters among all.
    pub fn parameters_of(&self, effect: usize) -> Range<usize> {
        let candidates = &self.hypothesis.candidates;
        let before: usize = candidates[..effect].iter().map(|c| c.variant.parameters.len()).sum();
        before..before + candidates[effect].variant.parameters.len()
    }

    /// Returns the columns beyond commands and poses that show where in the robot one of its effects acts, by at least this
    /// many nats.
    pub fn witness(&self, effect: usize, nats: f64, rows: &Sample) -> Vec<&'static str> {
        let decided_by = self.hypothesis.decided_by(effect, &self.witnesses, rows, &self.values, nats);
        decided_by.into_iter().filter_map(Channel::column).collect()
    }

    /// Returns its effects as a simulator file stores them.
    pub fn applied(&self, robot: &Robot) -> Vec<AppliedEffect> {
        let candidates = self.hypothesis.candidates.iter().enumerate();
        candidates.map(|(effect, candidate)| AppliedEffect::new(candidate, self.values_of(effect), robot)).collect()
    }

    /// Returns the gain over `other` in a channel at the fitted parameters, in nats.
    pub fn gained_in(&self, channel: Channel, other: &Fitted) -> f64 {
        self.scores.total_of(channel) - other.scores.total_of(channel)
    }

    /// Returns the 95 % interval of a parameter by its statistical error, with Student's law for the number of blocks, clipped to its
    /// bounds.
    pub fn interval(&self, parameter: usize) -> [f64; 2] {
        let reach = student_95(self.cross_validated.block_count()) * self.errors[parameter];
        let [low, high] =
            self.hypothesis.parameters().nth(parameter).map_or([f64::NEG_INFINITY, f64::INFINITY], |p| p.bounds);
        [(self.values[parameter] - reach).max(low), (self.values[parameter] + reach).min(high)]
    }

    /// Returns the names of the reported parameters of one effect that lie at a bound.
    pub fn at_bound(&self, effect: usize) -> Vec<&'static str> {
        let parameters = self.hypothesis.candidates[effect].variant.parameters.iter().zip(self.values_of(effect));
        parameters.filter(|(parameter, value)| parameter.is_at_a_bound(**value)).map(|(p, _)| p.setting().0).collect()
    }

    /// Scores rows at the fitted parameters with given standard deviations of motion.
    pub fn scores_within(&self, noise: [f64; 3], sample: &Sample) -> Scores {
        self.hypothesis.scores_within(noise, sample, &self.values)
    }

    /// Adds one effect and refits the parameters of its part, starting at these values and the variant's guesses.
    pub fn with(&self, candidate: Candidate, context: &FitContext) -> Fitted {
        self.changed(Part::of(&candidate), context, |part| {
            let (problem, sketch) = part.sketched_with(candidate, None, context);
            problem.converge(sketch)
        })
    }

    /// Fits every wanted variant of every effect alone. Of the effects of the motion, and of those of the sensor, only the most
    /// promising are fitted to convergence.
    pub fn with_each_alone(&self, is_wanted: impl Fn(&Candidate) -> bool + Sync, context: &FitContext) -> Vec<Fitted> {
        let mut candidates = self.further_candidates(context);
        candidates.retain(is_wanted);
        let sketches: Vec<_> = candidates.par_iter().map(|c| self.sketched_with(*c, None, context)).collect();
        let values: Vec<(bool, f64)> =
            candidates.iter().zip(&sketches).map(|(c, (_, sketch))| (c.variant.moves(), sketch.value())).collect();
        let ahead = |(moves, value): &(bool, f64)| values.iter().filter(|(m, v)| m == moves && v > value).count();
        let finish = |((problem, sketch), value): ((Problem, Point), &(bool, f64))| {
            if ahead(value) < PROMISING { problem.converge(sketch) } else { problem.settle(sketch) }
        };
        sketches.into_par_iter().zip(values.par_iter()).map(finish).collect()
    }

    /// Adds each variant of each further effect that changes this part. Only the most promising are fitted to convergence, and the
    /// others are left out.
    pub fn with_each(&self, part: Part, context: &FitContext) -> Vec<Fitted> {
        let mut further = self.further_candidates(context);
        further.retain(|candidate| Part::of(candidate) == part);
        let faced = self.hypothesis.senses();
        let faced = faced.then(|| self.problem(self.hypothesis.clone(), context).faced(&self.values));
        let least = self.problem(self.hypothesis.clone(), context);
        let least = least.sketched_value(&self.values, faced.as_ref(), LEAST_NATS);
        let sketches = further.par_iter().map(|c| (*c, self.sketched_with(*c, faced.as_ref(), context)));
        let mut sketches: Vec<_> = sketches.filter(|(_, (_, sketch))| sketch.value() > least).collect();
        sketches.sort_by(|a, b| b.1.1.value().total_cmp(&a.1.1.value()));
        sketches.truncate(PROMISING);
        let converged = |(c, (problem, sketch)): (Candidate, (Problem, Point))| (c, problem.converge(sketch));
        let mut fits: Vec<(Candidate, Fitted)> = sketches.into_par_iter().map(converged).collect();
        // In the order of the catalogue, however they were fitted.
        fits.sort_by_key(|(candidate, _)| further.iter().position(|c| c == candidate));
        fits.into_iter().map(|(_, fit)| fit).collect()
    }

    /// Returns each variant of each effect of the catalogue that is not included yet.
    pub fn further_candidates(&self, context: &FitContext) -> Vec<Candidate> {
        let mut further = Candidate::all(&context.catalogue);
        let is_ray = context.baseline().sonar.as_ref().is_some_and(SensorLaw::is_ray);
        let is_quick = context.baseline().motion.as_ref().is_some_and(MotionModel::answers_within_a_step);
        let applies = |candidate: &Candidate| {
            (is_ray || !candidate.variant.is_for_a_ray()) && !(is_quick && candidate.variant.delays_in_the_filter())
        };
        further.retain(|candidate| !self.ids().contains(&candidate.effect) && applies(candidate));
        further
    }

    /// Runs a few iterations of the fit with one more effect. `faced` is what the sensor faces near these values, if known.
    fn sketched_with<'a>(
        &'a self,
        candidate: Candidate,
        faced: Option<&FacedRows>,
        context: &'a FitContext<'a>,
    ) -> (Problem<'a>, Point) {
        let starts = context.initial_guesses(&candidate).into_iter();
        let starts = starts.map(|own| [self.values.as_slice(), own.as_slice()].concat()).collect();
        let problem = self.problem(self.hypothesis.with(candidate), context);
        let sketch = problem.sketch(starts, faced);
        (problem, sketch)
    }

    /// Returns the fit of a hypothesis that takes untouched channels from this one.
    fn problem<'a>(&'a self, hypothesis: Hypothesis, context: &'a FitContext<'a>) -> Problem<'a> {
        Problem { hypothesis, untouched: &self.scores, context }
    }

    /// Removes one effect and refits the others of its part.
    pub fn without(&self, effect: usize, context: &FitContext) -> Fitted {
        let removed = self.hypothesis.candidates[effect];
        self.changed(Part::of(&removed), context, |part| part.refitted_without(&removed, context))
    }

    fn refitted_without(&self, removed: &Candidate, context: &FitContext) -> Fitted {
        let null = Fitted::null(context);
        let effects: Vec<usize> =
            (0..self.ids().len()).filter(|effect| self.hypothesis.candidates[*effect] != *removed).collect();
        if effects.is_empty() {
            return null;
        }
        let candidates = effects.iter().map(|effect| self.hypothesis.candidates[*effect]).collect();
        let values = effects.iter().flat_map(|effect| self.values_of(*effect)).copied().collect();
        let problem = null.problem(self.hypothesis.of(candidates), context);
        let sketch = problem.sketch(vec![values], None);
        problem.converge(sketch)
    }
}

/// Returns the best fit of each effect that was added last, best first.
pub fn best_of_each(mut fits: Vec<Fitted>) -> Vec<Fitted> {
    fits.sort_by(|a, b| b.log_evidence().total_cmp(&a.log_evidence()));
    let mut seen = Vec::new();
    fits.retain(|fit| {
        let id = fit.ids().last().copied();
        let is_first = !seen.contains(&id);
        seen.push(id);
        is_first
    });
    fits
}

#[cfg(test)]
mod tests;
