//! What is not known about a robot, as a distribution over robots.
//!
//! A command that is held does the same in every step and every run, and mostly not quite what the networks say: a bias
//! that no chance stands for, since it adds up while the command is held. So the motion under a held command is a Gaussian
//! process over commands, one for each of forward, lateral and turn, whose covariance is that of [`basis`], and a
//! [`nugget`] of each command beside it; networks say how the first step of a command differs. Nothing of it is left out or
//! drawn at random, so that where no log has driven it is as wide as its prior, and goes on as the robot does and not as
//! networks happen to. What logs say is kept as
//! [`Evidence`]; a run of the robot adds some, and the networks stay as they are.
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
use serde::{Deserialize, Serialize};

pub use basis::PARTS;
pub use command_scale::CommandScale;
pub use evidence::Evidence;
pub use member::Member;
use mindgap_foundations::chance::derive;
pub use noise::MotionNoise;
pub use posterior::Posterior;

/// A distribution over robots as a simulator file holds it. Channels are forward (cm), lateral (cm) and turn (degrees), all
/// of one step.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Ensemble {
    /// Prior standard deviation of each part of the process ([`PARTS`]), for each channel.
    pub prior: [[f64; PARTS]; 3],
    /// What moves the robot beyond the process.
    pub noise: MotionNoise,
    /// What logs say.
    pub evidence: Vec<Evidence>,
}

/// What is said of commands that are held before logs are looked at.
pub trait HeldMotion: Sync {
    /// Forward (cm), lateral (cm) and turn (degrees) of a step.
    fn motion(&self, command: [f64; 2]) -> [f64; 3];

    /// How large the robot's commands are.
    fn scale(&self) -> CommandScale;
}

/// Mostly networks.
pub type Held<'a> = &'a dyn HeldMotion;

/// Robots of a distribution.
pub struct Robots {
    /// The one in the middle.
    pub mean: Member,
    /// Random ones, all as likely.
    pub drawn: Vec<Member>,
}

impl Ensemble {
    /// The robot in the middle and `count` drawn ones; none if the numbers allow for no robot. The evidence is relative to
    /// what networks say, which is `held`.
    pub fn robots(&self, held: Held, count: usize, seed: u64) -> Option<Robots> {
        let posterior = Posterior::new(self, held)?;
        let mean = posterior.mean();
        let is_changed = self.evidence.iter().any(|e| e.after_training);
        let trained = Arc::new(if is_changed { self.trained(held)?.mean() } else { mean.clone() });
        let draw = |robot: u64| posterior.draw(derive(seed, &[robot])).known_as(&trained);
        let drawn = (0..count as u64).into_par_iter().map(draw).collect();
        Some(Robots { mean: mean.known_as(&trained), drawn })
    }

    /// What the training logs alone say; none as for [`robots`](Self::robots).
    pub fn trained(&self, held: Held) -> Option<Posterior> {
        let evidence = self.evidence.iter().filter(|e| !e.after_training).copied().collect();
        Posterior::new(&Ensemble { evidence, ..self.clone() }, held)
    }

    /// Whether a file could have held this.
    pub fn is_sound(&self) -> bool {
        let sizes = self.prior.iter().flatten();
        let sound = |e: &Evidence| {
            e.command.iter().chain(&e.bias).all(|v| v.is_finite())
                && e.variance.iter().all(|v| v.is_finite() && *v > 0.0)
        };
        sizes.copied().all(|size| size.is_finite() && size >= 0.0)
            && self.noise.is_sound()
            && self.evidence.iter().all(sound)
    }
}

/// Of commands in percent.
impl<F: Fn([f64; 2]) -> [f64; 3] + Sync> HeldMotion for F {
    fn motion(&self, command: [f64; 2]) -> [f64; 3] {
        self(command)
    }

    fn scale(&self) -> CommandScale {
        CommandScale::PERCENT
    }
}
