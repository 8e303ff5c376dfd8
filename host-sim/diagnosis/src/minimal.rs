//! The method in a few pages: a readable twin of the full diagnosis.
//!
//! A simulator predicts how far a robot drives forward per step, and logs say how far it drove. If the two differ, which of a few
//! known *effects* made the robot different? This module answers for one channel and three effects with nothing but least
//! squares. The full method asks the same of five channels and thirty effects; what it adds is listed at the end.
//!
//! # The method, step by step
//!
//! 1. **Residuals.** What an effect does to a robot shows in the residual r = logged − predicted of each [`Step`]. Noise of a
//!    known size hides it.
//! 2. **Split.** Every fourth run is held out. Effects are found on the other runs (*identification*) and have to prove
//!    themselves on these (*hold-out*).
//! 3. **Fit.** Each effect here is linear: r = X β + noise, with one to three coefficients β. Least squares solves (XᵀX) β = Xᵀr.
//!    Both sides are sums over steps, so the equations of all runs but one are a difference of sums.
//! 4. **Cross-validate.** The *score* of an explanation is the log-likelihood of each run under coefficients that were fitted to
//!    the *other* runs, in nats. Steps of one run share their circumstances, so runs, not steps, are the independent units. A
//!    useless coefficient gains nothing by fitting noise, since it is scored on noise that it has not seen.
//! 5. **Compare.** The *gain* of an effect is its score minus that of the null hypothesis, the simulator as it is. Each
//!    coefficient costs half the logarithm of the number of steps (Schwarz 1978). What one run in eight alone shows is not a
//!    property of the robot: the largest gains are replaced by the next one (a winsorized sum). An effect counts if its gain
//!    passes a gate, which is calibrated on robots without any effect.
//! 6. **Add.** Once an effect is chosen, the others are tried on top of it. A further effect has to gain more than a better form
//!    of the first one could, which is a small fraction of what that one explains.
//! 7. **Confirm.** The chosen effects have to gain strong evidence, three nats (20 to 1), on the held-out runs, which they are
//!    predicted without having seen. Otherwise there is no gap.
//! 8. **Report.** The size of each effect comes with the jackknife interval over runs: how much would it change without one of
//!    them?
//!
//! # What the full method adds
//!
//! - Five channels: forward, lateral, turn, whether the sonar returns an echo, and its reading ([`hypothesis`](super::hypothesis)).
//! - Effects that are not linear, in several functional forms each, fitted by maximum a posteriori with physical priors
//!   ([`fit`](super::fit)), and rivals that could take the place of each ([`slot`](super::slot)).
//! - A noise model with outliers ([`noise_model`](super::noise_model)), and weights for steps that repeat each other
//!   ([`repeats`](mindgap_learning::evaluation::repeats)).
//! - An omnibus regression that finds structure that no effect explains ([`omnibus`](super::omnibus)), the verdicts `unknown` and
//!   `partly_known`, probabilities, and the simulator's epistemic error ([`epistemic_error`](super::epistemic_error)).

use nalgebra::{DMatrix, DVector};

use super::calibration::Calibration;
use super::gain::Gain;
use super::verdict::Verdict;
use mindgap_foundations::statistics::summary::root_mean_square;
use mindgap_learning::evaluation::observations::{Observation, Observations};
use mindgap_models::effects::scales::HALF_SPEED;

/// One step of a robot.
#[derive(Clone, Copy, Debug)]
pub struct Step {
    /// Index of the run.
    pub run: usize,
    /// Forward motion that the simulator predicts, cm.
    pub predicted_cm: f64,
    /// Forward motion that was logged, cm.
    pub logged_cm: f64,
    /// Heading halfway through the step, rad.
    pub heading_rad: f64,
    /// Length of a step at the reference speed, [`HALF_SPEED`], cm; zero if the motors are off.
    pub reference_cm: f64,
}

/// An effect on forward motion that is linear in its coefficients.
pub struct Effect {
    /// Its id, as in the full method's catalogue.
    pub id: &'static str,
    /// Number of its coefficients.
    pub coefficients: usize,
    /// The change of a step per unit of each coefficient, cm.
    pub regressors: fn(&Step) -> Vec<f64>,
    /// The size that is reported, from the coefficients.
    pub size: fn(&[f64]) -> f64,
}

/// The effects that compete.
pub const EFFECTS: [Effect; 3] = [
    // Every step is longer or shorter by one factor.
    Effect { id: "drive_scale", coefficients: 1, regressors: |step| vec![step.predicted_cm], size: |b| 1.0 + b[0] },
    // Gravity pulls a driven robot downhill by a fraction of a step at the reference speed. The coefficients are its components
    // along x and y; what shows in forward motion is the part along the heading.
    Effect {
        id: "slope",
        coefficients: 2,
        regressors: |step| along(step.reference_cm, step),
        size: |b| libm::hypot(b[0], b[1]),
    },
    // Drag of a carpet: a mean, and a part that is largest against the nap. It points against the travel, forward or in reverse,
    // and a robot that hardly moves loses little.
    Effect {
        id: "carpet_nap",
        coefficients: 3,
        regressors: |step| {
            let half_cm = -0.5 * step.reference_cm.min(4.0 * step.predicted_cm.abs());
            [vec![half_cm * step.predicted_cm.signum()], along(half_cm, step)].concat()
        },
        size: |b| libm::hypot(b[1], b[2]),
    },
];

/// Returns the components along the heading of a distance along x and of one along y.
fn along(distance_cm: f64, step: &Step) -> Vec<f64> {
    let (sin, cos) = libm::sincos(step.heading_rad);
    vec![distance_cm * cos, distance_cm * sin]
}

/// What was found.
#[derive(Clone, Debug)]
pub struct Diagnosis {
    /// No gap, or a known one; the other verdicts need an omnibus test.
    pub verdict: Verdict,
    /// The effects in the order in which they were found.
    pub effects: Vec<Found>,
}

/// An effect that was found.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    /// Its id.
    pub id: &'static str,
    /// Its size, a factor or a fraction.
    pub size: f64,
    /// 95 % interval of the size.
    pub interval: [f64; 2],
}

/// One run in this many is held out.
const EVERY: usize = 4;
/// Residuals are clipped at this many standard deviations of the noise: a jump of the tracker says nothing about steps.
const FARTHEST: f64 = 4.0;
/// 95 % of a normal distribution lie within this many standard deviations.
const NORMAL_95: f64 = 1.96;

/// Reads the steps of logged rows.
pub fn steps(observations: &Observations) -> Vec<Step> {
    let step = |row: &Observation| {
        let (logged, predicted) = (row.motion?, row.expected?);
        Some(Step {
            run: row.run,
            predicted_cm: predicted.forward,
            logged_cm: logged.forward,
            heading_rad: row.context.pose.heading_rad + 0.5 * predicted.turn,
            reference_cm: if row.commands()[0] == [0.0; 2] { 0.0 } else { HALF_SPEED * row.context.reference_cm() },
        })
    };
    observations.rows.iter().filter_map(step).collect()
}

/// Diagnoses steps. `noise_cm` is the simulator's own noise, the standard deviation of a residual without any effect.
pub fn diagnose(steps: &[Step], noise_cm: f64, calibration: &Calibration) -> Diagnosis {
    // Split.
    let (held_out, fitted): (Vec<Step>, Vec<Step>) = steps.iter().partition(|step| step.run % EVERY == EVERY - 1);
    // Fit the null hypothesis, then add the best effect while its gain counts.
    let null = Explanation::fit(Vec::new(), &fitted, noise_cm);
    let mut best = null.clone();
    while best.effects.len() < EFFECTS.len() {
        let others = (0..EFFECTS.len()).filter(|effect| !best.effects.contains(effect));
        let fits = others.map(|effect| {
            let effects = best.effects.iter().copied().chain([effect]).collect();
            Explanation::fit(effects, &fitted, noise_cm)
        });
        let Some(next) = fits.max_by(|a, b| a.evidence().total_cmp(&b.evidence())) else { break };
        let form_error_nats = calibration.further_share * (best.evidence() - null.evidence());
        if !next.gain_over(&best).less(form_error_nats).passes(calibration.effect_nats) {
            break;
        }
        best = next;
    }
    // Confirm on held-out runs, and report.
    let confirmed_nats = best.nats(&held_out) - null.nats(&held_out);
    let is_known = !best.effects.is_empty() && confirmed_nats >= calibration.judgement.strong_nats;
    let effects = if is_known { best.found() } else { Vec::new() };
    Diagnosis { verdict: if is_known { Verdict::Known } else { Verdict::NoGap }, effects }
}

/// Effects fitted to steps. Without any effect it is the null hypothesis.
#[derive(Clone)]
struct Explanation {
    /// Indices of the effects.
    effects: Vec<usize>,
    /// Their coefficients, one effect after the other, fitted to all runs.
    coefficients: Vec<f64>,
    /// The coefficients fitted to all runs but one, for each run.
    without: Vec<Vec<f64>>,
    /// Log-likelihood of each run under the coefficients fitted to the others, in nats.
    cross_validated: Vec<f64>,
    /// Price of the coefficients, in nats.
    penalty: f64,
    /// Standard deviation of the residuals that remain, at least the simulator's noise.
    noise_cm: f64,
}

impl Explanation {
    /// Fits effects by least squares, with all runs and without each of them.
    fn fit(effects: Vec<usize>, steps: &[Step], noise_cm: f64) -> Self {
        let runs: Vec<&[Step]> = steps.chunk_by(|one, next| one.run == next.run).collect();
        let by_run: Vec<Equations> = runs.iter().map(|run| Equations::of(&effects, run)).collect();
        let all = by_run.iter().fold(Equations::zero(&effects), |sum, run| sum.plus(run, 1.0));
        let (coefficients, without) = (all.solution(), by_run.iter().map(|run| all.plus(run, -1.0).solution()));
        let without: Vec<Vec<f64>> = without.collect();
        let mut explanation = Explanation {
            penalty: 0.5 * coefficients.len() as f64 * libm::log(steps.len() as f64),
            cross_validated: Vec::new(),
            effects,
            coefficients,
            without,
            noise_cm,
        };
        let residuals = steps.iter().map(|step| explanation.residual_cm(step, &explanation.coefficients));
        explanation.noise_cm = root_mean_square(residuals).max(noise_cm);
        let scores = runs.iter().zip(&explanation.without).map(|(run, without)| explanation.nats_at(without, run));
        explanation.cross_validated = scores.collect();
        explanation
    }

    /// Returns logged minus predicted motion of a step at these coefficients.
    fn residual_cm(&self, step: &Step, coefficients: &[f64]) -> f64 {
        let explained = regressors(&self.effects, step).iter().zip(coefficients).map(|(x, b)| x * b).sum::<f64>();
        step.logged_cm - step.predicted_cm - explained
    }

    /// Returns the log-likelihood of steps at these coefficients, under normal noise.
    fn nats_at(&self, coefficients: &[f64], steps: &[Step]) -> f64 {
        let z = |step: &Step| (self.residual_cm(step, coefficients) / self.noise_cm).clamp(-FARTHEST, FARTHEST);
        steps.iter().map(|step| -0.5 * z(step) * z(step) - libm::log(self.noise_cm)).sum()
    }

    /// Returns the cross-validated score less the penalty.
    fn evidence(&self) -> f64 {
        self.cross_validated.iter().sum::<f64>() - self.penalty
    }

    /// Returns the gain over another explanation of the same steps.
    fn gain_over(&self, other: &Explanation) -> Gain {
        let by_run: Vec<f64> = self.cross_validated.iter().zip(&other.cross_validated).map(|(a, b)| a - b).collect();
        Gain::of(&by_run).less(self.penalty - other.penalty)
    }

    /// Returns the log-likelihood of steps that it was not fitted to.
    fn nats(&self, steps: &[Step]) -> f64 {
        self.nats_at(&self.coefficients, steps)
    }

    /// Reports the effects with jackknife intervals over runs (Efron and Tibshirani 1993, equation 11.5).
    fn found(&self) -> Vec<Found> {
        let mut first = 0;
        let found = |effect: &usize| {
            let effect = &EFFECTS[*effect];
            let own = first..first + effect.coefficients;
            first = own.end;
            let size = (effect.size)(&self.coefficients[own.clone()]);
            let changes = self.without.iter().map(|without| (effect.size)(&without[own.clone()]) - size);
            let reach = NORMAL_95 * (self.without.len() as f64 - 1.0).sqrt() * root_mean_square(changes);
            Found { id: effect.id, size, interval: [size - reach, size + reach] }
        };
        self.effects.iter().map(found).collect()
    }
}

/// Normal equations of least squares, XᵀX β = Xᵀr, which add up over steps.
struct Equations {
    xx: DMatrix<f64>,
    xr: DVector<f64>,
}

impl Equations {
    fn zero(effects: &[usize]) -> Self {
        let count = effects.iter().map(|effect| EFFECTS[*effect].coefficients).sum();
        Equations { xx: DMatrix::zeros(count, count), xr: DVector::zeros(count) }
    }

    fn of(effects: &[usize], steps: &[Step]) -> Self {
        let mut sum = Equations::zero(effects);
        for step in steps {
            let x = DVector::from_vec(regressors(effects, step));
            sum.xr += &x * (step.logged_cm - step.predicted_cm);
            sum.xx += &x * x.transpose();
        }
        sum
    }

    fn plus(&self, other: &Equations, sign: f64) -> Self {
        Equations { xx: &self.xx + sign * &other.xx, xr: &self.xr + sign * &other.xr }
    }

    /// Returns the coefficients, zero if the steps do not determine them.
    fn solution(&self) -> Vec<f64> {
        let solution = self.xx.clone().cholesky().map(|factor| factor.solve(&self.xr));
        solution.map_or_else(|| vec![0.0; self.xr.len()], |solution| solution.as_slice().to_vec())
    }
}

fn regressors(effects: &[usize], step: &Step) -> Vec<f64> {
    effects.iter().flat_map(|effect| (EFFECTS[*effect].regressors)(step)).collect()
}

#[cfg(test)]
mod tests;
