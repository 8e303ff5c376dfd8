//! What each command does beyond the smooth process over all of them, the same in every run: the nugget of a Gaussian
//! process. Logs of a command tell its own, and nothing of another's.

use std::collections::BTreeMap;

use super::Held;
use super::basis::Weights;
use super::command_scale::{CommandScale, Percent};
use super::evidence::{Evidence, cell};
use super::noise::MotionNoise;

/// The nuggets of a robot, as far as logs tell them.
#[derive(Clone, Debug)]
pub struct Nuggets {
    /// What else moves the robot beyond the process.
    pub noise: MotionNoise,
    /// How large the robot's commands are.
    pub scale: CommandScale,
    /// By cell.
    logged: BTreeMap<[i32; 2], Logged>,
}

/// A cell of which there are logs.
#[derive(Clone, Debug)]
struct Logged {
    /// Where the smooth process says what they should have been.
    place: Weights,
    /// What they were.
    motion: [f64; 3],
    /// Of the difference this share is the nugget's.
    share: [f64; 3],
    /// Standard deviation that is left of it.
    deviation: [f64; 3],
}

/// What is known of a nugget in one channel, given the smooth process: it is `share` of what lies between `motion` and what
/// the process says in `place`, more or less `deviation`.
pub struct Known<'a> {
    /// 0..=1; zero of a command that was not logged.
    pub share: f64,
    /// Weights of nodes.
    pub place: &'a [(usize, f64)],
    /// In cm or degrees of a step, as the deviation.
    pub motion: f64,
    /// Standard deviation.
    pub deviation: f64,
}

impl Nuggets {
    /// As [cells](super::evidence::by_cell) of evidence tell them: what came after training outranks what was known in it.
    pub fn new(cells: &[Evidence], noise: MotionNoise, held: Held) -> Self {
        let scale = held.scale();
        let logged = |e: &Evidence| {
            let (command, motion) = (e.percent(scale), held.motion(e.command.map(f64::from)));
            let nugget = [0, 1, 2].map(|channel| noise.nugget_variance(command, motion, channel));
            let share = [0, 1, 2].map(|channel| nugget[channel] / e.variance_about_process(&noise, held, channel));
            let deviation = [0, 1, 2].map(|channel| (nugget[channel] * (1.0 - share[channel])).max(0.0).sqrt());
            (cell(command), Logged { place: e.weights(scale), motion: e.motion(held), share, deviation })
        };
        Nuggets { noise, scale, logged: cells.iter().map(logged).collect() }
    }

    /// What is known of a command's nugget, where the smooth process moves the robot so.
    pub fn known(&self, command: Percent, motion: [f64; 3]) -> [Known<'_>; 3] {
        let logged = self.logged.get(&cell(command));
        [0, 1, 2].map(|channel| match logged {
            Some(Logged { place, motion, share, deviation }) => {
                Known { share: share[channel], place, motion: motion[channel], deviation: deviation[channel] }
            }
            None => {
                let deviation = self.noise.nugget_variance(command, motion, channel).sqrt();
                Known { share: 0.0, place: &[], motion: 0.0, deviation }
            }
        })
    }
}
