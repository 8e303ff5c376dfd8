//! Learns the noise of a robot: the robot's own part is drawn anew in each, the tracker's errors at both ends of a step
//! cancel in the next one, and a nugget is the same in all steps of a command.

use nalgebra::{Cholesky, DMatrix, DVector};

use super::holds::{StepResidual, stretches};
use crate::simulator::ensemble::noise::{MotionNoise, TERMS, terms};
use crate::simulator::ensemble::{Held, Member};

/// Sizes are sought by factors that get smaller, so often each.
const FACTORS: [f64; 6] = [10.0, 4.0, 2.0, 2.0, 1.4, 1.2];
/// The nugget is sought in such shares of what a step adds.
const NUGGET: [f64; 9] = [0.0, 0.05, 0.1, 0.2, 0.3, 0.45, 0.65, 1.0, 1.5];
/// That of first steps is sought up to so many times what later ones have, in such parts of it: finer than logs tell it.
const MOST_TIMES: u32 = 2;
const PARTS_OF_ONE: u32 = 20;
/// Sizes begin with such shares of the variance of residuals: mostly they are the tracker's.
const FIRST_STEP: f64 = 0.1;
const FIRST_TRACKER: f64 = 0.4;
/// Of a stretch no more steps than this are looked at: the time they take grows with the third power.
const MOST_STEPS: usize = 25;

/// The steps of one stretch, about what the robot in the middle does.
struct Stretch {
    terms: [f64; TERMS],
    left: DVector<f64>,
}

/// What is assumed of one channel.
#[derive(Clone, Copy)]
struct Assumed {
    step: [f64; TERMS],
    tracker: f64,
    nugget: f64,
}

/// What steps leave about the networks, before anything is known.
pub fn rough(steps: &[StepResidual]) -> MotionNoise {
    let mut noise = MotionNoise::default();
    for channel in 0..3 {
        let squares = steps.iter().map(|step| step.residual()[channel] * step.residual()[channel]);
        let variance = squares.sum::<f64>() / steps.len().max(1) as f64;
        noise.step[channel][0] = 2.0 * FIRST_STEP * variance;
        noise.tracker[channel] = FIRST_TRACKER * variance;
        noise.first_step[channel] = (FIRST_STEP * variance).sqrt();
    }
    noise
}

/// The noise under which the steps are the most probable, about the robot in the middle; `said` is what networks say.
pub fn learn(steps: &[StepResidual], middle: &Member, said: Held) -> MotionNoise {
    let mut noise = MotionNoise::default();
    for channel in 0..3 {
        let all = stretches(steps);
        let of = |steps: &&[StepResidual]| stretch(steps, channel, middle, said);
        let steady: Vec<Stretch> = all.iter().filter(|s| s[0].is_steady()).map(of).collect();
        let Assumed { step, tracker, nugget } = likeliest(&steady);
        (noise.step[channel], noise.tracker[channel], noise.nugget[channel]) = (step, tracker, nugget);
        let first: Vec<Stretch> = all.iter().filter(|s| !s[0].is_steady()).map(of).collect();
        noise.first_step[channel] = first_step(&first, &noise, channel);
    }
    noise
}

fn stretch(steps: &[StepResidual], channel: usize, middle: &Member, said: Held) -> Stretch {
    let command = steps[0].command();
    let (does, says) = (middle.motion(command), said(command));
    let off = |step: &StepResidual| step.residual()[channel] + step.known()[channel] + says[channel] - does[channel];
    let left = steps.iter().take(MOST_STEPS).map(off).collect::<Vec<f64>>();
    Stretch { terms: terms(does), left: DVector::from_vec(left) }
}

/// One size after the other.
fn likeliest(stretches: &[Stretch]) -> Assumed {
    let count: usize = stretches.iter().map(|s| s.left.len()).sum();
    let squares: f64 = stretches.iter().map(|s| s.left.norm_squared()).sum();
    let variance = squares / count.max(1) as f64;
    let mean_term = |term: usize| {
        let sum: f64 = stretches.iter().map(|s| s.terms[term] * s.left.len() as f64).sum();
        (sum / count.max(1) as f64).max(f64::EPSILON)
    };
    let step = std::array::from_fn(|term| FIRST_STEP * variance / mean_term(term) / TERMS as f64);
    let mut best = Assumed { step, tracker: FIRST_TRACKER * variance, nugget: 0.0 };
    let mut most = log_likelihood(stretches, &best);
    let mut better = |tried: Assumed, best: &mut Assumed| {
        let probable = log_likelihood(stretches, &tried);
        if probable > most {
            (*best, most) = (tried, probable);
        }
    };
    for factor in FACTORS {
        for by in [factor, 1.0 / factor] {
            for term in 0..TERMS {
                let mut tried = best;
                tried.step[term] *= by;
                better(tried, &mut best);
            }
            better(Assumed { tracker: best.tracker * by, ..best }, &mut best);
        }
        for nugget in NUGGET {
            better(Assumed { nugget, ..best }, &mut best);
        }
    }
    best
}

fn log_likelihood(stretches: &[Stretch], assumed: &Assumed) -> f64 {
    stretches.iter().map(|stretch| stretch.log_likelihood(assumed)).sum()
}

impl Stretch {
    fn log_likelihood(&self, assumed: &Assumed) -> f64 {
        let step: f64 = (0..TERMS).map(|term| assumed.step[term] * self.terms[term]).sum();
        let nugget = assumed.nugget * assumed.nugget * step;
        let size = self.left.len();
        let covariance = DMatrix::from_fn(size, size, |i, j| match i.abs_diff(j) {
            0 => step + nugget + 2.0 * assumed.tracker,
            1 => nugget - assumed.tracker,
            _ => nugget,
        });
        let Some(factor) = Cholesky::new(covariance) else { return f64::NEG_INFINITY };
        let spread: f64 = factor.l_dirty().diagonal().iter().map(|d| libm::log(*d)).sum();
        -spread - 0.5 * self.left.dot(&factor.solve(&self.left))
    }
}

/// The standard deviation that first steps have beyond later ones.
fn first_step(first: &[Stretch], noise: &MotionNoise, channel: usize) -> f64 {
    let known = |stretch: &Stretch| {
        let step: f64 = (0..TERMS).map(|term| noise.step[channel][term] * stretch.terms[term]).sum();
        let nugget = noise.nugget[channel];
        step * (1.0 + nugget * nugget) + 2.0 * noise.tracker[channel]
    };
    let squares: Vec<[f64; 2]> = first.iter().flat_map(|s| s.left.iter().map(|left| [left * left, known(s)])).collect();
    let typical = (squares.iter().map(|[_, known]| known).sum::<f64>() / squares.len().max(1) as f64).sqrt();
    let log_likelihood = |deviation: f64| {
        let of = |[square, known]: &[f64; 2]| {
            let variance = known + deviation * deviation;
            -0.5 * (libm::log(variance) + square / variance)
        };
        squares.iter().map(of).sum::<f64>()
    };
    let grid = (0..MOST_TIMES * PARTS_OF_ONE).map(|i| f64::from(i) / f64::from(PARTS_OF_ONE) * typical);
    let tried = grid.map(|deviation| (log_likelihood(deviation), deviation));
    tried.fold((f64::NEG_INFINITY, 0.0), |best, other| if other.0 > best.0 { other } else { best }).1
}
