//! Multi-step prediction error: the distance between the ends of open-loop predicted and logged paths, for the simulator
//! as it is, with effects added, and from noise alone.

use glam::DVec2;
use rand_distr::{Distribution, StandardNormal};
use schemars::JsonSchema;
use serde::Serialize;

use super::observations::{Observation, Observations};
use super::predictions;
use mindgap_foundations::geometry::{Pose, direction};
use mindgap_foundations::random::{Generator, generator};
use mindgap_foundations::statistics::summary::median;
use mindgap_foundations::statistics::{bootstrap, rounding};
use mindgap_models::effects::StepContext;
use mindgap_models::effects::chain::EffectChain;
use mindgap_models::simulator::baseline::MotionModel;

/// Open-loop paths of one length, compared with the logs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Paths {
    /// Distances between their predicted and logged ends.
    pub error: PathError,
    /// How much closer the effects bring the predicted ends to the logged ones, over how much closer they would bring them
    /// if they were the whole cause: 95 % interval by bootstrap over blocks. The ratio is one if the effects would bring
    /// nothing closer. `None` if there are too few blocks.
    pub improvement_ci95: Option<[f64; 2]>,
}

/// Median distances between predicted and logged ends of paths.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct PathError {
    /// Length of a path in steps.
    pub steps: usize,
    /// Error of the simulator as it is, cm.
    #[serde(serialize_with = "rounding::number")]
    pub before_cm: f64,
    /// Error with the effects added, cm.
    #[serde(serialize_with = "rounding::number")]
    pub after_cm: f64,
    /// Error of a perfect simulator, from process and tracker noise alone, cm.
    #[serde(serialize_with = "rounding::number")]
    pub floor_cm: f64,
}

/// The models that drive open-loop paths.
pub struct Rollouts<'a> {
    /// The simulator's model of motion.
    pub drive: &'a MotionModel<'a>,
    /// The effects that the simulator has already.
    pub before: &'a EffectChain,
    /// The same effects and those that were found.
    pub after: &'a EffectChain,
    /// Noise of a step beyond `after`, as standard deviations of forward (cm), lateral (cm) and turn (rad).
    pub noise: [f64; 3],
}

/// Distances between predicted and logged ends of one path. Pairs are without and with the effects that were found.
struct EndError {
    block: usize,
    logged_cm: [f64; 2],
    floor_cm: [f64; DRAWS],
    /// Distances to ends that were drawn from the model with the effects.
    drawn_cm: [[f64; 2]; DRAWS],
}

/// Lengths of paths in steps.
const LENGTHS: [usize; 5] = [1, 2, 5, 10, 25];
/// Paths drawn from each start for the floor, and as many for the predicted improvement.
const DRAWS: usize = 8;
/// Added to the seed, so that these draws are independent of those of the bootstrap.
const STREAM: u64 = 3;
/// With fewer blocks there is no interval: of three blocks, one resample in nine is the same block three times.
const FEWEST_BLOCKS: usize = 4;

impl Rollouts<'_> {
    /// Returns the paths of each length that occurs in the logs. `seed` fixes the noise.
    pub fn paths(&self, logs: &Observations, seed: u64) -> Vec<Paths> {
        let stream = seed.wrapping_add(STREAM);
        let (mut floor, mut drawn) = (generator(stream, &[]), generator(stream, &[1]));
        let noise = [self.drive.scatter().into_array(), self.noise].map(|noise| PathNoise::of(self.drive, noise));
        let of_length = |steps| {
            let starts = (0..logs.rows.len().saturating_sub(steps)).step_by(steps.div_ceil(2));
            let pieces = starts.map(|i| &logs.rows[i..=i + steps]).filter(|piece| is_contiguous(piece));
            let errors: Vec<EndError> =
                pieces.map(|piece| self.end_error(piece, &noise, [&mut floor, &mut drawn])).collect();
            (!errors.is_empty()).then(|| Paths::of(steps, &errors, seed))
        };
        LENGTHS.into_iter().filter_map(of_length).collect()
    }

    /// `assumed` is the simulator's noise, for the floor, and `fitted` the noise beyond the effects.
    fn end_error(
        &self,
        piece: &[Observation],
        [assumed, fitted]: &[PathNoise; 2],
        [floor, drawn]: [&mut Generator; 2],
    ) -> EndError {
        let Rollouts { drive, before, after, .. } = *self;
        let predicted = [before, after].map(|effects| end(effects, drive, piece, || [0.0; 3]));
        let distances = |end: DVec2| predicted.map(|predicted| predicted.distance(end));
        let draws = |noise: &PathNoise, rng: &mut Generator| {
            [(); DRAWS].map(|()| distances(noise.draw(after, drive, piece, rng)))
        };
        EndError {
            block: piece[0].block,
            logged_cm: distances(piece[piece.len() - 1].context.pose.position_cm),
            floor_cm: draws(assumed, floor).map(|[_, after_cm]| after_cm),
            drawn_cm: draws(fitted, drawn),
        }
    }
}

impl Paths {
    fn of(steps: usize, errors: &[EndError], seed: u64) -> Self {
        let [before_cm, after_cm] = [0, 1].map(|which| median(errors.iter().map(|error| error.logged_cm[which])));
        let floor_cm = median(errors.iter().flat_map(|error| error.floor_cm));
        // A mean counts the few paths that an effect touches. Wild rows do no harm: no end, however far away, is closer to
        // one prediction than to the other by more than the distance between the two.
        let blocks: Vec<&[EndError]> = errors.chunk_by(|one, next| one.block == next.block).collect();
        let by_block = |improvement_cm: fn(&EndError) -> f64| -> Vec<f64> {
            blocks.iter().map(|errors| errors.iter().map(improvement_cm).sum()).collect()
        };
        let (logged, predicted) = (by_block(EndError::improvement_cm), by_block(EndError::predicted_improvement_cm));
        let ratio = |logged: f64, predicted: f64| Some(if predicted > 0.0 { logged / predicted } else { 1.0 });
        Paths {
            error: PathError { steps, before_cm, after_cm, floor_cm },
            improvement_ci95: (blocks.len() >= FEWEST_BLOCKS)
                .then(|| bootstrap::interval(&logged, &predicted, seed, ratio)),
        }
    }
}

impl EndError {
    fn improvement_cm(&self) -> f64 {
        self.logged_cm[0] - self.logged_cm[1]
    }

    /// The mean over the draws.
    fn predicted_improvement_cm(&self) -> f64 {
        self.drawn_cm.iter().map(|[before, after]| before - after).sum::<f64>() / DRAWS as f64
    }
}

/// Returns whether rows follow each other within one run, each with a motion.
fn is_contiguous(piece: &[Observation]) -> bool {
    piece.windows(2).all(|pair| pair[0].run == pair[1].run && pair[0].at + 1 == pair[1].at && pair[0].motion.is_some())
}

/// Returns where a robot ends that starts with the piece's first pose and receives its commands.
fn end(
    effects: &EffectChain,
    drive: &MotionModel,
    piece: &[Observation],
    mut noise: impl FnMut() -> [f64; 3],
) -> DVec2 {
    let mut pose = piece[0].context.pose;
    for row in &piece[..piece.len() - 1] {
        let motion = predictions::step(effects, drive, &StepContext { pose, ..row.context });
        let [forward, lateral, turn] = noise();
        let way = [motion.forward + forward, motion.lateral + lateral].map(|w| w * row.duration_ratio);
        pose = pose.compose(&Pose::new(way[0], way[1], (motion.turn + turn) * row.duration_ratio));
    }
    pose.position_cm
}

/// Noise of a path, as standard deviations: process noise adds up from step to step, tracker noise affects both ends only.
struct PathNoise {
    process: [f64; 3],
    tracker_cm: [f64; 2],
    tracker_rad: f64,
}

impl PathNoise {
    /// Splits the noise of a step. What exceeds the drive's own noise is process noise.
    fn of(drive: &MotionModel, noise: [f64; 3]) -> Self {
        let (assumed, process) = (drive.scatter().into_array(), drive.process_noise_fraction().into_array());
        let tracker = [0, 1, 2].map(|c| assumed[c] * (1.0 - process[c] * process[c]).max(0.0).sqrt());
        let excess = |c: usize| (noise[c] * noise[c] - assumed[c] * assumed[c]).max(0.0);
        let process = [0, 1, 2].map(|c| libm::hypot(assumed[c] * process[c], excess(c).sqrt()));
        // A step's residual contains the tracker's error at both ends; of the heading only that at the beginning matters.
        PathNoise { process, tracker_cm: [tracker[0], tracker[1]], tracker_rad: tracker[2] / 2f64.sqrt() }
    }

    /// Draws the tracked end of a path of a robot with these effects.
    fn draw(&self, effects: &EffectChain, drive: &MotionModel, piece: &[Observation], rng: &mut Generator) -> DVec2 {
        let driven = end(effects, drive, piece, || self.process.map(|s| s * normal(rng)));
        let from = piece[0].context.pose.position_cm;
        let tracker_cm = DVec2::from(self.tracker_cm.map(|s| s * normal(rng)));
        from + direction(self.tracker_rad * normal(rng)).rotate(driven - from) + tracker_cm
    }
}

fn normal(rng: &mut Generator) -> f64 {
    StandardNormal.sample(rng)
}
