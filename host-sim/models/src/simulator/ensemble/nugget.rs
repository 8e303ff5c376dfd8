//! The nugget of the Gaussian process: what each command does beyond the smooth process over all of them, the same in every
//! run. Logs of a command determine its own nugget and no other.

use std::collections::BTreeMap;

use super::Held;
use super::basis::Weights;
use super::command_scale::{CommandScale, Percent};
use super::evidence::{Evidence, cell};
use super::noise::MotionNoise;
use mindgap_foundations::motion::Motion;

/// The nuggets of a robot, as far as logs determine them.
#[derive(Clone, Debug)]
pub struct Nuggets {
    /// The other noise beyond the process.
    pub noise: MotionNoise,
    /// The scale of the robot's commands.
    pub scale: CommandScale,
    /// By cell.
    logged: BTreeMap<[i32; 2], Logged>,
}

/// A cell with logs.
#[derive(Clone, Debug)]
struct Logged {
    /// Weights of the smooth process there.
    place: Weights,
    /// The logged motion.
    motion: Motion<f64>,
    /// Fraction of the difference that is the nugget's.
    share: Motion<f64>,
    /// Its remaining standard deviation.
    deviation: Motion<f64>,
}

/// What is known of a nugget along one axis, given the smooth process: it is `share` of what lies between `motion` and what
/// the process says in `place`, more or less `deviation`.
pub struct Known<'a> {
    /// 0..=1; zero of a command that was not logged.
    pub share: f64,
    /// Weights of nodes.
    pub place: &'a [(usize, f64)],
    /// In cm or degrees per step, as the deviation.
    pub motion: f64,
    /// Standard deviation.
    pub deviation: f64,
}

impl Nuggets {
    /// Computes them from [cells](super::evidence::by_cell) of evidence. Later evidence outranks that of training.
    pub fn new(cells: &[Evidence], noise: MotionNoise, held: Held) -> Self {
        let scale = held.scale();
        let logged = |e: &Evidence| {
            let (command, motion) = (e.percent(scale), held.motion(e.command.map(f64::from)));
            let nugget = Motion::from_fn(|axis| noise.nugget_variance(command, motion, axis));
            let share = Motion::from_fn(|axis| nugget[axis] / e.variance_about_process(&noise, held, axis));
            let deviation = nugget.zip_with(share, |nugget, share| (nugget * (1.0 - share)).max(0.0).sqrt());
            (cell(command), Logged { place: e.weights(scale), motion: e.motion(held), share, deviation })
        };
        Nuggets { noise, scale, logged: cells.iter().map(logged).collect() }
    }

    /// Returns what is known of a command's nugget, where the smooth process predicts this motion.
    pub fn known(&self, command: Percent, motion: Motion<f64>) -> Motion<Known<'_>> {
        let logged = self.logged.get(&cell(command));
        Motion::from_fn(|axis| match logged {
            Some(Logged { place, motion, share, deviation }) => {
                Known { share: share[axis], place, motion: motion[axis], deviation: deviation[axis] }
            }
            None => {
                let deviation = self.noise.nugget_variance(command, motion, axis).sqrt();
                Known { share: 0.0, place: &[], motion: 0.0, deviation }
            }
        })
    }
}
