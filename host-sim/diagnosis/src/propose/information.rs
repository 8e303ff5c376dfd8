//! What a run is expected to say about which name is true.

use std::collections::BTreeMap;

use nalgebra::{Cholesky, DMatrix, DVector};

use super::names::Name;
use crate::fit::FitContext;
use mindgap_learning::evaluation::predictions;
use mindgap_models::effects::StepContext;
use mindgap_models::effects::chain::EffectChain;
use mindgap_models::simulator::baseline::MotionModel;
use mindgap_models::simulator::ensemble::evidence::cell;

/// Grid over readings, about their standard deviation.
const GRID_CM: f64 = 4.0;

/// The expected information of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Information {
    /// Mutual information between the names and the run, nats.
    pub nats: f64,
    /// Expected log-likelihood ratio of the first two names, nats.
    pub between_first: f64,
}

/// What a name expects of a run.
struct Expectation {
    /// Motion of every step by axis, in standard deviations of the noise.
    motion: DVector<f64>,
    /// How the motion changes with each parameter, by its standard error; one column per parameter.
    open: DMatrix<f64>,
    /// Probabilities of the readings of every step: of none, and of the cells of the grid.
    readings: Vec<Vec<f64>>,
}

/// Returns the information that these steps are expected to give about which of the names is true.
///
/// It is the mutual information between names and outcome (Lindley, "On a measure of the information provided by an
/// experiment", 1956; reviews: Chaloner and Verdinelli, "Bayesian experimental design", 1995; Ryan, Drovandi, McGree and Pettitt,
/// "A review of modern computational algorithms for Bayesian optimal design", 2016). Each name predicts a normal distribution
/// that is widened by what the logs leave open of its parameters (Box and Hill, "Discrimination among mechanistic models",
/// 1967), since a rival whose parameters could follow the new run is not refuted by it. The information of a mixture of such
/// distributions has no closed form; this is its lower bound by Bhattacharyya distances, a quarter of the divergence of normal
/// distributions of equal width (Kolchinsky and Tracey, "Estimating mixture entropy with pairwise distances", 2017). Steps that
/// repeat each other, or steps that were logged, share the simulator's own error and count as in the diagnosis.
pub fn expected(names: &[Name], steps: &[StepContext], logged: &Logged, context: &FitContext) -> Information {
    let weights = weights(names, steps, logged, context);
    let senses = names.iter().any(|name| name.fit.hypothesis.senses());
    let expectations: Vec<Expectation> =
        names.iter().map(|name| Expectation::of(name, steps, &weights, senses, context)).collect();
    let nats = |a: usize, b: usize| expectations[a].nats_against(&expectations[b]);
    let distance = |a: usize, b: usize| if a == b { 0.0 } else { nats(a.max(b), a.min(b)) };
    let distances: Vec<Vec<f64>> =
        (0..names.len()).map(|a| (0..names.len()).map(|b| distance(a, b)).collect()).collect();
    let likelihoods: Vec<f64> = names.iter().map(|name| name.likelihood).collect();
    Information { nats: of_mixture(&likelihoods, &distances), between_first: distances[0][names.len().min(2) - 1] }
}

/// Returns the mutual information of hypotheses with these relative likelihoods, between which outcomes diverge by these nats.
fn of_mixture(likelihoods: &[f64], nats: &[Vec<f64>]) -> f64 {
    let sum: f64 = likelihoods.iter().sum();
    let probability = |i: usize| likelihoods[i] / sum;
    let alike = |row: &Vec<f64>| row.iter().enumerate().map(|(j, d)| probability(j) * libm::exp(-d / 4.0)).sum::<f64>();
    nats.iter().enumerate().map(|(i, row)| -probability(i) * libm::log(alike(row))).sum()
}

/// How often the logs have the commands now and before, in cells within which commands count as the same.
pub struct Logged(BTreeMap<[[i32; 2]; 2], usize>);

impl Logged {
    /// Counts the rows of logs.
    pub fn of(context: &FitContext) -> Self {
        let mut counts = BTreeMap::new();
        if let Some(drive) = &context.baseline().motion {
            let with_motion = context.rows.rows.iter().filter(|row| row.motion.is_some());
            with_motion.for_each(|row| *counts.entry(cells(drive, row.commands())).or_default() += 1);
        }
        Logged(counts)
    }
}

fn cells(drive: &MotionModel, commands: [[f64; 2]; 2]) -> [[i32; 2]; 2] {
    commands.map(|command| cell(drive.percent(command)))
}

/// Returns the weight of every step by axis: one over the standard deviation of its noise, less for steps that repeat each other
/// or steps of the logs.
fn weights(names: &[Name], steps: &[StepContext], logged: &Logged, context: &FitContext) -> Vec<[f64; 3]> {
    let Some(drive) = &context.baseline().motion else { return vec![[0.0; 3]; steps.len()] };
    let noise = names[0].fit.noise;
    let commands = |step: &StepContext| [step.commands[0], step.commands[1]];
    let mut counts: BTreeMap<[[i32; 2]; 2], usize> = BTreeMap::new();
    steps.iter().for_each(|step| *counts.entry(cells(drive, commands(step))).or_default() += 1);
    let weight = |step: &StepContext| {
        let [now, before] = commands(step);
        let own_error = drive.own_error(now, before).into_array();
        let cells = cells(drive, [now, before]);
        let others = (counts[&cells] - 1 + logged.0.get(&cells).copied().unwrap_or(0)) as f64;
        [0, 1, 2].map(|c| 1.0 / f64::sqrt(noise[c] * noise[c] + others * own_error[c]))
    };
    steps.iter().map(weight).collect()
}

impl Expectation {
    fn of(name: &Name, steps: &[StepContext], weights: &[[f64; 3]], senses: bool, context: &FitContext) -> Self {
        let fit = &name.fit;
        let motion = expected_motion(&fit.effects(), steps, weights, context);
        let bounds: Vec<[f64; 2]> = fit.hypothesis.parameters().map(|p| p.bounds).collect();
        let by_parameter = |parameter: usize| {
            let mut values = fit.values.clone();
            let error = fit.errors[parameter];
            let [low, high] = bounds[parameter];
            // A step within the bounds, whichever the side.
            let step = if values[parameter] + error <= high { error } else { -error };
            values[parameter] = (values[parameter] + step).clamp(low, high);
            expected_motion(&fit.hypothesis.at(&values), steps, weights, context) - &motion
        };
        let columns: Vec<DVector<f64>> =
            (0..fit.values.len()).filter(|p| fit.errors[*p].is_finite()).map(by_parameter).collect();
        let open = match columns.as_slice() {
            [] => DMatrix::zeros(motion.len(), 0),
            columns => DMatrix::from_columns(columns),
        };
        let readings = if senses { readings(&fit.effects(), steps, context) } else { Vec::new() };
        Expectation { motion, open, readings }
    }

    /// Returns the expected log-likelihood ratio, symmetric in the two.
    fn nats_against(&self, other: &Self) -> f64 {
        let difference = &self.motion - &other.motion;
        let open = DMatrix::from_columns(&self.open.column_iter().chain(other.open.column_iter()).collect::<Vec<_>>());
        let readings = self.readings.iter().zip(&other.readings).map(|(a, b)| divergence(a, b)).sum::<f64>();
        beyond_open(&difference, &open) + readings
    }
}

/// Returns ½ dᵀ (1 + U Uᵀ)⁻¹ d by Woodbury's identity: the nats of a difference d that parameters could follow along U.
fn beyond_open(difference: &DVector<f64>, open: &DMatrix<f64>) -> f64 {
    let all = difference.norm_squared();
    let along = open.tr_mul(difference);
    let inner = open.tr_mul(open) + DMatrix::identity(open.ncols(), open.ncols());
    let followed = Cholesky::new(inner).map_or(0.0, |inner| along.dot(&inner.solve(&along)));
    0.5 * (all - followed).max(0.0)
}

/// Returns the expected motion of steps, axis by axis, in standard deviations.
fn expected_motion(
    effects: &EffectChain,
    steps: &[StepContext],
    weights: &[[f64; 3]],
    context: &FitContext,
) -> DVector<f64> {
    let Some(drive) = &context.baseline().motion else { return DVector::zeros(0) };
    let of_step = |(step, weight): (&StepContext, &[f64; 3])| {
        let motion = predictions::step(effects, drive, step).into_array();
        [0, 1, 2].map(|c| motion[c] * weight[c])
    };
    DVector::from_vec(steps.iter().zip(weights).flat_map(of_step).collect())
}

/// Returns the probabilities of no reading and of readings on a grid, at every step.
fn readings(effects: &EffectChain, steps: &[StepContext], context: &FitContext) -> Vec<Vec<f64>> {
    let Some(sonar) = &context.baseline().sonar else { return Vec::new() };
    let [low, high] = sonar.range_cm();
    let cells = ((high - low) / GRID_CM) as usize;
    let of_step = |step: &StepContext| {
        let outcomes = effects.sensor(step).outcomes(sonar, &context.rows.surroundings);
        let on_grid = (0..cells).map(|i| {
            let echo_cm = low + (i as f64 + 0.5) * GRID_CM;
            GRID_CM * libm::exp(outcomes.log_likelihood(Some(echo_cm)))
        });
        [libm::exp(outcomes.log_likelihood(None))].into_iter().chain(on_grid).collect()
    };
    steps.iter().map(of_step).collect()
}

/// Returns half of Jeffreys' divergence of two discrete distributions.
fn divergence(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).filter(|(a, b)| **a > 0.0 && **b > 0.0).map(|(a, b)| 0.5 * (a - b) * libm::log(a / b)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Between two hypotheses that outcomes always tell apart, a run gives all that is open: ln 2 for equal ones.
    #[test]
    fn information_is_at_most_what_is_open() {
        let apart = |nats: f64| vec![vec![0.0, nats], vec![nats, 0.0]];
        assert_eq!(of_mixture(&[1.0, 1.0], &apart(0.0)), 0.0);
        assert!((of_mixture(&[1.0, 1.0], &apart(1e3)) - std::f64::consts::LN_2).abs() < 1e-12);
        let rising = [0.5, 1.0, 2.0, 8.0].map(|nats| of_mixture(&[1.0, 0.4], &apart(nats)));
        assert!(rising.is_sorted(), "{rising:?}");
    }

    #[test]
    fn what_a_rival_could_follow_does_not_count() {
        let difference = DVector::from_vec(vec![3.0, 4.0]);
        let none = DMatrix::zeros(2, 0);
        assert_eq!(beyond_open(&difference, &none), 12.5);
        // Along the difference itself, known to one hundredth of the noise or not at all.
        let along = |error: f64| DMatrix::from_columns(&[difference.normalize() * error]);
        assert!((beyond_open(&difference, &along(0.01)) - 12.5).abs() < 0.01);
        assert!((beyond_open(&difference, &along(1.0)) - 6.25).abs() < 1e-12);
        assert!(beyond_open(&difference, &along(1e3)) < 1e-4);
        // Across it nothing is lost.
        let across = DMatrix::from_columns(&[DVector::from_vec(vec![-4.0, 3.0]) * 10.0]);
        assert!((beyond_open(&difference, &across) - 12.5).abs() < 1e-9);
    }

    #[test]
    fn divergence_is_that_of_jeffreys() {
        assert_eq!(divergence(&[0.5, 0.5], &[0.5, 0.5]), 0.0);
        let nats = divergence(&[0.9, 0.1], &[0.1, 0.9]);
        assert!((nats - 0.8 * libm::log(9.0)).abs() < 1e-12, "{nats}");
    }
}
