//! Learns the noise of a robot from all steps of its logs: the robot's own part is drawn anew in each, the tracker's error at
//! the end of a step comes back with the other sign in the next one, a nugget is the same in all steps of a command, and so is
//! what a first step does beyond later ones.

use nalgebra::{Cholesky, DMatrix, DVector};
use rayon::prelude::*;

use super::holds::StepResidual;
use mindgap_foundations::motion::Axis;
use mindgap_foundations::statistics::maximise::{Bounds, climb};
use mindgap_models::simulator::ensemble::evidence::cell;
use mindgap_models::simulator::ensemble::noise::{MotionNoise, TERMS, is_slow, terms, weighed};
use mindgap_models::simulator::ensemble::{Held, Member};

/// Of the variance of residuals such shares are a step's and the tracker's, before anything is known.
const FIRST_STEP: f64 = 0.1;
const FIRST_TRACKER: f64 = 0.4;
/// What is sought: the terms of a step's, the tracker's and a first step's standard deviation, as shares of that of residuals,
/// and the two nuggets, as shares of what a step adds. Where a square is zero nothing shows which way to go, so that all
/// begin above.
const TRACKER: usize = TERMS;
const OF_FIRST: usize = TERMS + 1;
const NUGGETS: usize = TERMS + 2;
const BOUNDS: [Bounds; NUGGETS + 2] = {
    let mut bounds = [Bounds::new(0.0, 1.0); NUGGETS + 2];
    (bounds[NUGGETS], bounds[NUGGETS + 1]) = (Bounds::new(0.0, 5.0), Bounds::new(0.0, 5.0));
    bounds
};
const START: [f64; NUGGETS + 2] = [0.2, 0.2, 0.2, 0.6, 0.3, 0.5, 0.5];
/// The search ends after so many rounds, or where one gains less than this, in nats.
const ROUNDS: usize = 40;
const ENOUGH: f64 = 0.05;
/// Where the numbers have no inverse.
const LEAST_LIKELY: f64 = -1e9;
/// So many steps are looked at together: the time they take grows with the third power.
const TOGETHER: usize = 20;

/// Consecutive steps of a run and what they leave, about what the robot in the middle does.
struct Piece {
    steps: Vec<Step>,
    left: DVector<f64>,
}

/// What the noise of a step depends on.
struct Step {
    terms: [f64; TERMS],
    cell: [i32; 2],
    /// Which nugget is its command's.
    class: usize,
    is_first: bool,
    /// Variance that the tracker's error in heading adds.
    misheading: f64,
    /// The share of the tracker's error at its end that comes back in the next step.
    comes_back: f64,
}

/// What is assumed along one axis.
#[derive(Clone, Copy)]
struct Assumed {
    step: [f64; TERMS],
    tracker: f64,
    nugget: [f64; 2],
    /// Variance.
    first_step: f64,
}

/// What steps leave about the networks, before anything is known.
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

/// Pieces of runs, each looked at as a whole.
pub fn pieces(steps: &[StepResidual]) -> Vec<&[StepResidual]> {
    steps.chunk_by(|before, step| step.follows(before)).flat_map(|run| run.chunks(TOGETHER)).collect()
}

/// The noise under which the pieces are the most probable. `middle` is the robot in the middle by what others than this piece
/// and some more say, and `said` what networks say.
pub fn learn<'a>(pieces: &[&[StepResidual]], middle: impl Fn(usize) -> &'a Member, said: Held) -> MotionNoise {
    let mut noise = MotionNoise::default();
    // A heading that is tracked wrongly shows as lateral motion.
    for axis in [Axis::Turn, Axis::Forward, Axis::Lateral] {
        let piece = |(number, steps): (usize, &&[StepResidual])| Piece::new(steps, axis, &noise, middle(number), said);
        let of_axis: Vec<Piece> = pieces.iter().enumerate().map(piece).collect();
        let Assumed { step, tracker, nugget, first_step } = likeliest(&of_axis);
        (noise.step[axis], noise.tracker[axis], noise.nugget[axis]) = (step, tracker, nugget);
        noise.first_step[axis] = first_step.sqrt();
    }
    noise
}

/// What makes the pieces the most probable.
fn likeliest(pieces: &[Piece]) -> Assumed {
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
    /// Makes one of an axis; `noise` is what is known of the axes before.
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
                comes_back: if axis == Axis::Turn { 1.0 } else { libm::cos(does.turn.to_radians()) },
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
                1 => -assumed.tracker * self.steps[i.min(j)].comes_back,
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

    /// Steps of a robot that stands still but for noise, whose commands are held for twenty steps at most.
    #[test]
    fn the_noise_that_made_the_steps_is_found() {
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
        // So many steps tell that of first ones to a third, and the others to a tenth, by a search of other make.
        let is_near = |found: f64, true_one: f64, share: f64| (found / true_one - 1.0).abs() < share;
        assert!(is_near(found.step.turn[0], step, 0.25) && is_near(found.tracker.turn, tracker, 0.15), "{found:?}");
        assert!(is_near(found.first_step.turn, f64::sqrt(first_step), 0.3), "{found:?}");
        assert!(found.nugget.turn.into_iter().zip(nugget).all(|(f, t)| is_near(f, t, 0.25)), "{found:?}");
    }
}
