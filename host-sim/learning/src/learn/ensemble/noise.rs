//! Learns the noise of a robot from all steps of its logs. The process noise is independent in each step, the tracker's
//! error at the end of a step recurs with opposite sign in the next one, a nugget is the same in all steps of a command, and
//! the first step of a command has additional noise.

use nalgebra::{Cholesky, DMatrix, DVector};
use rayon::prelude::*;

use super::holds::StepResidual;
use mindgap_foundations::motion::Axis;
use mindgap_foundations::statistics::maximise::{Bounds, climb};
use mindgap_models::simulator::ensemble::evidence::cell;
use mindgap_models::simulator::ensemble::noise::{MotionNoise, TERMS, is_slow, terms, weighed};
use mindgap_models::simulator::ensemble::{Held, Member};

/// Initial shares of the variance of residuals: of a step, and of the tracker.
const FIRST_STEP: f64 = 0.1;
const FIRST_TRACKER: f64 = 0.4;
/// Indices of the parameters: the terms of the standard deviation of a step, those of the tracker and of a first step, as
/// shares of that of residuals; and the two nuggets, as shares of that of a step. The gradient vanishes at zero, so all
/// start above it.
const TRACKER: usize = TERMS;
const OF_FIRST: usize = TERMS + 1;
const NUGGETS: usize = TERMS + 2;
const BOUNDS: [Bounds; NUGGETS + 2] = {
    let mut bounds = [Bounds::new(0.0, 1.0); NUGGETS + 2];
    (bounds[NUGGETS], bounds[NUGGETS + 1]) = (Bounds::new(0.0, 5.0), Bounds::new(0.0, 5.0));
    bounds
};
const START: [f64; NUGGETS + 2] = [0.2, 0.2, 0.2, 0.6, 0.3, 0.5, 0.5];
/// The search ends after this many rounds, or when one gains less than [`ENOUGH`] nats.
const ROUNDS: usize = 40;
const ENOUGH: f64 = 0.05;
/// Log-likelihood of a covariance that is not positive definite.
const LEAST_LIKELY: f64 = -1e9;
/// Maximum number of steps of a piece: computation time grows with its cube.
const PIECE_STEPS: usize = 20;

/// Consecutive steps of a run and their residuals about the posterior mean.
struct Piece {
    steps: Vec<Step>,
    left: DVector<f64>,
}

/// The quantities that the noise of a step depends on.
struct Step {
    terms: [f64; TERMS],
    cell: [i32; 2],
    /// Index of the nugget of its command.
    class: usize,
    is_first: bool,
    /// Variance that the tracker's error in heading adds.
    misheading: f64,
    /// Share of the tracker's error at its end that recurs in the next step.
    recurring: f64,
}

/// Noise parameters along one axis.
#[derive(Clone, Copy)]
struct Assumed {
    step: [f64; TERMS],
    tracker: f64,
    nugget: [f64; 2],
    /// Additional variance of a first step.
    first_step: f64,
}

/// Returns a rough estimate of the noise from the residuals of the networks.
pub fn rough(steps: &[StepResidual]) -> MotionNoise {
    let mut noise = MotionNoise::default();
    for axis in Axis::ALL {
        let squares = steps.iter().map(|step| step.residual()[axis] * step.residual()[axis]);
        let variance = squares.sum::<f64>() / steps.len().max(1) as f64;
        noise.step[axis][0] = 2.0 * FIRST_STEP * variance;
        noise.tracker[axis] = FIRST_TRACKER * variance;
        noise.first_step[axis] = (FIRST_STEP * variance).sqrt();
    }
    noise
}

/// Cuts runs into pieces whose steps are treated jointly.
pub fn pieces(steps: &[StepResidual]) -> Vec<&[StepResidual]> {
    steps.chunk_by(|before, step| step.follows(before)).flat_map(|run| run.chunks(PIECE_STEPS)).collect()
}

/// Returns the noise of maximum likelihood. `middle` returns the posterior mean without the fold of a piece, and `said` the
/// predictions of the networks.
pub fn learn<'a>(pieces: &[&[StepResidual]], middle: impl Fn(usize) -> &'a Member, said: Held) -> MotionNoise {
    let mut noise = MotionNoise::default();
    // An error in the tracked heading appears as lateral motion, so the turn comes first.
    for axis in [Axis::Turn, Axis::Forward, Axis::Lateral] {
        let piece = |(number, steps): (usize, &&[StepResidual])| Piece::new(steps, axis, &noise, middle(number), said);
        let of_axis: Vec<Piece> = pieces.iter().enumerate().map(piece).collect();
        let Assumed { step, tracker, nugget, first_step } = most_likely(&of_axis);
        (noise.step[axis], noise.tracker[axis], noise.nugget[axis]) = (step, tracker, nugget);
        noise.first_step[axis] = first_step.sqrt();
    }
    noise
}

/// Returns the noise parameters that maximise the likelihood of the pieces.
fn most_likely(pieces: &[Piece]) -> Assumed {
    let steps = || pieces.iter().flat_map(|piece| &piece.steps);
    let count = steps().count().max(1) as f64;
    let variance = pieces.iter().map(|piece| piece.left.norm_squared()).sum::<f64>() / count;
    let mean_term = |term: usize| (steps().map(|step| step.terms[term]).sum::<f64>() / count).max(f64::EPSILON);
    let usual: [f64; TERMS] = std::array::from_fn(mean_term);
    let assumed = |at: &[f64]| {
        let share = |place: usize| at[place] * at[place] * variance;
        Assumed {
            step: std::array::from_fn(|term| share(term) / usual[term]),
            tracker: share(TRACKER),
            nugget: [at[NUGGETS], at[NUGGETS + 1]],
            first_step: share(OF_FIRST),
        }
    };
    let terms = |at: &[f64]| pieces.par_iter().map(|piece| piece.log_likelihood(&assumed(at))).collect();
    assumed(&climb(&BOUNDS, &START, ROUNDS, ENOUGH, terms).at)
}

impl Piece {
    /// Makes the piece for an axis; `noise` holds the results of the axes before.
    fn new(steps: &[StepResidual], axis: Axis, noise: &MotionNoise, middle: &Member, said: Held) -> Self {
        let step = |step: &StepResidual| {
            let command = step.command();
            let percent = said.scale().percent(command);
            let (does, says) = (middle.motion(command), said.motion(command));
            let left = step.residual()[axis] + step.known()[axis] + says[axis] - does[axis];
            let step = Step {
                terms: terms(does),
                cell: cell(percent),
                class: usize::from(is_slow(percent)),
                is_first: !step.is_steady(),
                misheading: noise.misheading_variance(does, axis),
                recurring: if axis == Axis::Turn { 1.0 } else { libm::cos(does.turn.to_radians()) },
            };
            (step, left)
        };
        let (steps, left): (Vec<Step>, Vec<f64>) = steps.iter().map(step).unzip();
        Piece { steps, left: DVector::from_vec(left) }
    }

    fn log_likelihood(&self, assumed: &Assumed) -> f64 {
        let own: Vec<f64> = self.steps.iter().map(|step| weighed(&assumed.step, &step.terms)).collect();
        let nuggets: Vec<f64> =
            self.steps.iter().zip(&own).map(|(step, own)| assumed.nugget[step.class] * own.sqrt()).collect();
        let size = self.steps.len();
        let covariance = DMatrix::from_fn(size, size, |i, j| {
            let (one, other) = (&self.steps[i], &self.steps[j]);
            let nugget = if one.cell == other.cell { nuggets[i] * nuggets[j] } else { 0.0 };
            let rest = match i.abs_diff(j) {
                0 => {
                    let first = if one.is_first { assumed.first_step } else { 0.0 };
                    own[i] + first + one.misheading + 2.0 * assumed.tracker
                }
                1 => -assumed.tracker * self.steps[i.min(j)].recurring,
                _ => 0.0,
            };
            nugget + rest
        });
        let Some(factor) = Cholesky::new(covariance) else { return LEAST_LIKELY };
        let spread: f64 = factor.l_dirty().diagonal().iter().map(|d| libm::log(*d)).sum();
        -spread - 0.5 * self.left.dot(&factor.solve(&self.left))
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use rand::RngExt;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;
    use mindgap_foundations::motion::Motion;
    use mindgap_foundations::random::generator;
    use mindgap_logs::samples::RowId;
    use mindgap_models::simulator::ensemble::CommandScale;
    use mindgap_models::simulator::ensemble::command_scale::Percent;
    use mindgap_models::simulator::ensemble::{Ensemble, PARTS, Posterior};
    use mindgap_models::simulator::nominal::MotionBias;

    const RUNS: usize = 80;
    const STEPS: usize = 60;

    /// The robot is at rest except for noise, and commands are held for at most twenty steps.
    #[test]
    fn noise_of_simulated_steps_is_recovered() {
        let (step, tracker, first_step, nugget) = (0.2, 0.5, 0.36, [0.65, 2.25]);
        let mut rng = generator(3, &[]);
        let none = MotionBias {
            scale: CommandScale::PERCENT,
            weights: Motion::default(),
            scatter: Motion::splat(1.0),
            precision: None,
        };
        let mut nuggets: BTreeMap<[i32; 2], f64> = BTreeMap::new();
        let mut steps = Vec::new();
        for run in 0..RUNS {
            let (mut command, mut before, mut left) = ([0.0; 2], [0.0; 2], 0);
            let mut normal = |deviation: f64| -> f64 {
                let drawn: f64 = StandardNormal.sample(&mut rng);
                deviation * drawn
            };
            let mut error = normal(f64::sqrt(tracker));
            for row in 0..STEPS {
                if left == 0 {
                    let mut rng = generator(4, &[run as u64, row as u64]);
                    (command, left) = ([0; 2].map(|_| f64::from(rng.random_range(-80..80))), rng.random_range(1..21));
                }
                left -= 1;
                let deviation = f64::sqrt(step);
                let drawn = normal(deviation * nugget[usize::from(is_slow(Percent(command)))]);
                let lasting = *nuggets.entry(cell(Percent(command))).or_insert(drawn);
                let next = normal(f64::sqrt(tracker));
                let first = if command == before { 0.0 } else { normal(f64::sqrt(first_step)) };
                let turn_deg = normal(deviation) + lasting + first + next - error;
                error = next;
                let speeds = [command[0], command[1], before[0], before[1]];
                let residual = Motion { turn: turn_deg.to_radians(), ..Motion::ZERO };
                steps.push(StepResidual::new(RowId { run, row }, speeds, residual, &none));
                before = command;
            }
        }
        let still =
            Ensemble { prior: Motion::splat([0.0; PARTS]), noise: MotionNoise::default(), evidence: Vec::new() };
        let said = |_: [f64; 2]| Motion::ZERO;
        let middle = Posterior::new(&still, &said).expect("a posterior").mean();
        let found = learn(&pieces(&steps), |_| &middle, &said);
        // These steps determine the noise of first steps to a third, and the others to a tenth, by an independent search.
        let is_near = |found: f64, true_one: f64, share: f64| (found / true_one - 1.0).abs() < share;
        assert!(is_near(found.step.turn[0], step, 0.25) && is_near(found.tracker.turn, tracker, 0.15), "{found:?}");
        assert!(is_near(found.first_step.turn, f64::sqrt(first_step), 0.3), "{found:?}");
        assert!(found.nugget.turn.into_iter().zip(nugget).all(|(f, t)| is_near(f, t, 0.25)), "{found:?}");
    }
}
