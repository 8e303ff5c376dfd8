//! Epistemic uncertainty about a robot, as a distribution over robots.
//!
//! A held command does the same in every step and every run, and mostly not quite what the networks predict: a bias, which
//! noise cannot represent since it adds up while the command is held. So the motion under a held command is a Gaussian
//! process over commands, one per axis, with the covariance of [`basis`] and a [`nugget`] for each command; the networks
//! predict how the first step of a command differs. The process is exact, so that it is as wide as its prior where no log has
//! driven, and extrapolates as the robot does and not as networks happen to. What logs contribute is kept as [`Evidence`]; a
//! run of the robot adds some, and the networks stay unchanged.
//!
//! Turns are in degrees throughout this module, as in its file and in the networks' files.
//!
//! [`Posterior`] is the distribution given all evidence, a [`Member`] one robot of it.

pub mod basis;
pub mod command_scale;
pub mod evidence;
pub mod member;
pub mod noise;
pub mod nugget;
pub mod posterior;

use std::sync::Arc;

use rayon::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

pub use basis::PARTS;
pub use command_scale::CommandScale;
pub use evidence::Evidence;
pub use member::Member;
use mindgap_foundations::motion::Motion;
use mindgap_foundations::random::derive;
pub use noise::MotionNoise;
pub use posterior::Posterior;

/// A distribution over robots as a simulator file holds it. Motions are those of one step.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Ensemble {
    /// Prior standard deviation of each part of the process, for each axis.
    pub prior: Motion<[f64; PARTS]>,
    /// The noise beyond the process.
    pub noise: MotionNoise,
    /// The evidence of logs.
    pub evidence: Vec<Evidence>,
}

/// A prediction for held commands, to which evidence is relative.
pub trait HeldMotion: Sync {
    /// Returns the motion of a step, its turn in degrees.
    fn motion(&self, command: [f64; 2]) -> Motion<f64>;

    /// Returns the scale of the robot's commands.
    fn scale(&self) -> CommandScale;
}

/// Mostly the networks.
pub type Held<'a> = &'a dyn HeldMotion;

/// Robots of a distribution.
pub struct Robots {
    /// The posterior mean.
    pub mean: Member,
    /// Random draws.
    pub drawn: Vec<Member>,
}

impl Ensemble {
    /// Returns the mean robot and `count` drawn ones; none if the numbers allow for no robot. The evidence is relative to
    /// `held`, the networks' prediction.
    pub fn robots(&self, held: Held, count: usize, seed: u64) -> Option<Robots> {
        let posterior = Posterior::new(self, held)?;
        let mean = posterior.mean();
        let is_changed = self.evidence.iter().any(|e| e.after_training);
        let trained = Arc::new(if is_changed { self.trained(held)?.mean() } else { mean.clone() });
        let draw = |robot: u64| posterior.draw(derive(seed, &[robot])).known_as(&trained);
        let drawn = (0..count as u64).into_par_iter().map(draw).collect();
        Some(Robots { mean: mean.known_as(&trained), drawn })
    }

    /// Returns the posterior of the training logs alone; none as for [`robots`](Self::robots).
    pub fn trained(&self, held: Held) -> Option<Posterior> {
        let evidence = self.evidence.iter().filter(|e| !e.after_training).copied().collect();
        Posterior::new(&Ensemble { evidence, ..self.clone() }, held)
    }

    /// Returns whether all numbers are possible.
    pub fn is_sound(&self) -> bool {
        let sizes = self.prior.iter().flatten();
        let sound = |e: &Evidence| {
            e.command.iter().chain(e.bias.iter()).all(|v| v.is_finite())
                && e.variance.iter().all(|v| v.is_finite() && *v > 0.0)
        };
        sizes.copied().all(|size| size.is_finite() && size >= 0.0)
            && self.noise.is_sound()
            && self.evidence.iter().all(sound)
    }
}

/// For commands in percent.
impl<F: Fn([f64; 2]) -> Motion<f64> + Sync> HeldMotion for F {
    fn motion(&self, command: [f64; 2]) -> Motion<f64> {
        self(command)
    }

    fn scale(&self) -> CommandScale {
        CommandScale::PERCENT
    }
}
