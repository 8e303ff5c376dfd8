//! A set of effects with free parameters, and the likelihood of logs under it.

use std::ops::Range;

use super::noise_model::{fitted_noise, log_density};
use super::sample::Sample;
use super::scores::Scores;
use super::witnesses::{Seen, Witnesses};
use mindgap_foundations::channel::Channel;
use mindgap_foundations::statistics::maximise::Bounds;
use mindgap_learning::evaluation::observations::Observation;
use mindgap_learning::evaluation::predictions::facing_in;
use mindgap_models::effects::chain::EffectChain;
use mindgap_models::effects::{Candidate, Parameter, SensorState, Variant};
use mindgap_models::simulator::baseline::Baseline;
use mindgap_models::sonar::Outcomes;

/// A set of effects in the order in which they act. The empty set is the simulator as it is.
#[derive(Clone)]
pub struct Hypothesis {
    /// The effects that the simulator has already, with their parameters.
    given: EffectChain,
    /// The same up to the rims, as rotation counters see it.
    given_to_the_rims: EffectChain,
    /// The same up to the body, as a gyro sees it.
    given_to_the_body: EffectChain,
    /// One variant of each further effect.
    pub candidates: Vec<Candidate>,
}

impl Hypothesis {
    /// The simulator as it is.
    pub fn null(baseline: &Baseline) -> Self {
        Hypothesis {
            given: baseline.chain(),
            given_to_the_rims: baseline.chain_to_the_rims(),
            given_to_the_body: baseline.chain_to_the_body(),
            candidates: Vec::new(),
        }
    }

    /// The simulator without the effects that it has already.
    pub fn without_applied(baseline: &Baseline) -> Self {
        Hypothesis::null(&Baseline { applied: Vec::new(), ..baseline.clone() })
    }

    /// The same simulator with these effects.
    pub fn of(&self, candidates: Vec<Candidate>) -> Self {
        Hypothesis { candidates, ..self.clone() }
    }

    /// The same effects and one more.
    pub fn with(&self, candidate: Candidate) -> Self {
        self.of(self.candidates.iter().copied().chain([candidate]).collect())
    }

    /// Returns the effects at given parameters.
    pub fn at(&self, values: &[f64]) -> EffectChain {
        let variants: Vec<_> = self.candidates.iter().map(|c| c.variant).collect();
        self.given.with(&variants, values)
    }

    /// Decides by the likelihood of these rows where the effects show on the witnesses; also returns their score of every row.
    pub fn witnesses(&self, sample: &Sample, values: &[f64]) -> (Witnesses, Vec<[f64; 3]>) {
        let fitted = |witnesses: Witnesses| {
            let seen = self.seen(&witnesses, values);
            witnesses.fitted(&seen, sample)
        };
        let counted = |scores: &[[f64; 3]]| scores.iter().map(|[left, right, _]| left + right).sum::<f64>();
        // One candidate after the other: all combinations would take twice as long for each further one.
        Witnesses::undecided(&self.candidates, sample).into_iter().fold(
            fitted(Witnesses::expected(&self.candidates)),
            |best, candidate| {
                let hidden = fitted(best.0.hidden(candidate));
                if counted(&hidden.1) > counted(&best.1) { hidden } else { best }
            },
        )
    }

    /// Scores the witnesses of every row at `values`, as they were decided: left and right counter, gyro.
    pub fn witnessed(&self, witnesses: &Witnesses, sample: &Sample, values: &[f64]) -> Vec<[f64; 3]> {
        witnesses.scores(&self.seen(witnesses, values), &sample.rows, sample)
    }

    /// Returns the witnesses that show whether a candidate acts before them or behind: those that would be less likely by this
    /// many nats if it were the other way round.
    pub fn decided_by(
        &self,
        candidate: usize,
        witnesses: &Witnesses,
        sample: &Sample,
        values: &[f64],
        nats: f64,
    ) -> Vec<Channel> {
        let [as_it_is, other_way] =
            [witnesses, &witnesses.reversed(candidate)].map(|seen| self.witnessed(seen, sample, values));
        let lead = |witness: usize| as_it_is.iter().zip(&other_way).map(|(a, b)| a[witness] - b[witness]).sum::<f64>();
        let witnesses = Channel::WITNESSES.into_iter().enumerate();
        witnesses.filter(|(witness, _)| lead(*witness) >= nats).map(|(_, channel)| channel).collect()
    }

    fn seen(&self, witnesses: &Witnesses, values: &[f64]) -> Seen {
        Seen {
            rims: self.seen_at(&self.given_to_the_rims, values, witnesses.on_counters()),
            body: self.seen_at(&self.given_to_the_body, values, witnesses.on_gyro()),
        }
    }

    fn seen_at(&self, given: &EffectChain, values: &[f64], is_seen: &[bool]) -> EffectChain {
        let mut rest = values;
        let (mut variants, mut seen_values) = (Vec::new(), Vec::new());
        for (candidate, is_seen) in self.candidates.iter().zip(is_seen) {
            let (own, others) = rest.split_at(candidate.variant.parameters.len());
            rest = others;
            if *is_seen {
                variants.push(candidate.variant);
                seen_values.extend(own);
            }
        }
        given.with(&variants, &seen_values)
    }

    /// Returns the free parameters, effect after effect.
    pub fn parameters(&self) -> impl Iterator<Item = &'static Parameter> {
        self.candidates.iter().flat_map(|c| c.variant.parameters)
    }

    /// Returns the bounds of all parameters.
    pub fn bounds(&self) -> Vec<Bounds> {
        self.parameters().map(Parameter::fit_bounds).collect()
    }

    /// Returns the log prior density of parameters, relative to its maximum.
    pub fn log_prior(&self, values: &[f64]) -> f64 {
        self.parameters().zip(values).map(|(parameter, value)| parameter.log_prior(*value)).sum()
    }

    /// Returns the maximum of the log prior density, per unit of each parameter.
    pub fn log_prior_peak(&self) -> f64 {
        self.parameters().map(Parameter::log_prior_peak).sum()
    }

    /// Returns the precision of each parameter's prior, in squared inverse units; zero for a flat prior.
    pub fn prior_precisions(&self) -> Vec<f64> {
        self.parameters().map(|p| 1.0 / (p.prior_sd * p.prior_sd)).collect()
    }

    /// Returns whether a further effect changes the motion.
    pub fn moves(&self) -> bool {
        self.candidates.iter().any(|c| c.variant.moves())
    }

    /// Returns whether a further effect changes the sensor.
    pub fn senses(&self) -> bool {
        self.candidates.iter().any(|c| c.variant.senses())
    }

    /// Returns the values of the effects for which a test holds.
    pub fn values_of(&self, values: &[f64], is_picked: impl Fn(&Variant) -> bool) -> Vec<f64> {
        let picked = self.candidates.iter().flat_map(|c| c.variant.parameters.iter().map(|_| is_picked(c.variant)));
        picked.zip(values).filter(|(is_picked, _)| *is_picked).map(|(_, value)| *value).collect()
    }

    /// Scores every row at `values`, with the noise of motion fitted to these rows.
    pub fn scores(&self, sample: &Sample, values: &[f64]) -> Scores {
        let (_, witnesses) = self.witnesses(sample, values);
        self.scores_within(self.noise(sample, values), sample, values).with_witnesses(&witnesses)
    }

    /// Scores every row at `values`; channels that no candidate touches are taken from `untouched`.
    pub fn scores_over(&self, untouched: &Scores, sample: &Sample, values: &[f64]) -> Scores {
        let mut scores = untouched.clone();
        if self.moves() {
            let (_, witnesses) = self.witnesses(sample, values);
            scores = scores.with_motion(&self.motion(sample, values)).with_witnesses(&witnesses);
        }
        if self.senses() {
            scores = scores.with_sonar(&self.all_sonar(sample, values));
        }
        scores
    }

    /// Scores every row at `values` with given standard deviations of motion: forward (cm), lateral (cm), turn (rad). Witnesses are
    /// not scored.
    pub fn scores_within(&self, noise: [f64; 3], sample: &Sample, values: &[f64]) -> Scores {
        let motion = densities(&sample.rows, &sample.residuals(&self.at(values)), noise);
        Scores::zero(sample.row_blocks()).with_motion(&motion).with_sonar(&self.all_sonar(sample, values))
    }

    /// Scores every block at values of its own, with the given noise; channels that no candidate touches are taken from
    /// `untouched`.
    pub fn scores_by_block(
        &self,
        values: &[Vec<f64>],
        noise: [f64; 3],
        witnesses: &Witnesses,
        untouched: &Scores,
        sample: &Sample,
    ) -> Scores {
        let mut scores = untouched.clone();
        let blocks = || values.iter().enumerate().map(|(block, values)| (sample.of_block(block), values));
        if self.moves() {
            let motion = blocks().flat_map(|(range, values)| {
                let rows = &sample.rows[range];
                densities(rows, &sample.residuals_of(rows, &self.at(values)), noise)
            });
            scores = scores.with_motion(&motion.collect::<Vec<_>>());
            let witnessed = blocks().flat_map(|(range, values)| {
                witnesses.scores(&self.seen(witnesses, values), &sample.rows[range], sample)
            });
            scores = scores.with_witnesses(&witnessed.collect::<Vec<_>>());
        }
        if self.senses() {
            let sonar = blocks().flat_map(|(range, values)| self.sonar_of(sample, range, values));
            scores = scores.with_sonar(&sonar.collect::<Vec<_>>());
        }
        scores
    }

    /// Fits the noise of motion, a nuisance parameter of every hypothesis: it may exceed the simulator's but never fall
    /// below it. Returns standard deviations of forward (cm), lateral (cm) and turn (rad).
    pub fn noise(&self, sample: &Sample, values: &[f64]) -> [f64; 3] {
        noise_of(&sample.residuals(&self.at(values)), sample)
    }

    /// Scores the motion channels of every row, with fitted noise.
    pub fn motion(&self, sample: &Sample, values: &[f64]) -> Vec<[f64; 3]> {
        let residuals = sample.residuals(&self.at(values));
        densities(&sample.rows, &residuals, noise_of(&residuals, sample))
    }

    /// Scores the sonar channels of some rows. `outcomes` gives the distribution of the reading at a row in a state.
    pub fn sonar(
        &self,
        sample: &Sample,
        rows: Range<usize>,
        values: &[f64],
        outcomes: impl Fn(usize, &SensorState) -> Option<Outcomes>,
    ) -> Vec<[f64; 2]> {
        if sample.baseline.sonar.is_none() {
            return vec![[0.0; 2]; rows.len()];
        }
        let effects = self.at(values);
        let term = |i: usize| {
            let row = &sample.rows[i];
            let Some(outcomes) = outcomes(i, &effects.sensor(&row.context)) else { return [0.0; 2] };
            let rate = outcomes.log_detection(row.echo_cm);
            let [rate_weight, value_weight] = row.echo_weight;
            [rate_weight * rate, value_weight * (outcomes.log_likelihood(row.echo_cm) - rate)]
        };
        rows.map(term).collect()
    }

    fn sonar_of(&self, sample: &Sample, rows: Range<usize>, values: &[f64]) -> Vec<[f64; 2]> {
        self.sonar(sample, rows, values, |row, state| Some(facing_in(sample, &sample.rows[row], state)?.outcomes()))
    }

    fn all_sonar(&self, sample: &Sample, values: &[f64]) -> Vec<[f64; 2]> {
        self.sonar_of(sample, 0..sample.rows.len(), values)
    }
}

/// Returns the weighted log-density of each channel, zero where nothing was logged.
fn densities(rows: &[Observation], residuals: &[Option<[f64; 3]>], noise: [f64; 3]) -> Vec<[f64; 3]> {
    let of_row = |(row, residual): (&Observation, &Option<[f64; 3]>)| {
        let density =
            |r: [f64; 3]| [0, 1, 2].map(|axis| row.motion_weight[axis] * log_density(axis, r[axis], noise[axis]));
        residual.map_or([0.0; 3], density)
    };
    rows.iter().zip(residuals).map(of_row).collect()
}

fn noise_of(residuals: &[Option<[f64; 3]>], sample: &Sample) -> [f64; 3] {
    let Some(drive) = &sample.baseline.motion else { return [1.0; 3] };
    let least = drive.scatter().into_array();
    [0, 1, 2].map(|axis| {
        let rows = sample.rows.iter().zip(residuals);
        let of_axis = rows.filter_map(|(row, r)| Some([(*r)?[axis], row.motion_weight[axis]]));
        fitted_noise(axis, &of_axis.collect::<Vec<[f64; 2]>>(), least[axis])
    })
}

#[cfg(test)]
mod tests;
