//! Multi-step prediction error: the distance between the ends of open-loop predicted and logged paths, for the simulator
//! as it is, with the effects added, and from noise alone.

use glam::DVec2;
use rand_distr::{Distribution, StandardNormal};
use serde::Serialize;

use super::observations::{Observation, Observations};
use super::predictions;
use crate::chance::{Generator, generator};
use crate::effects::StepContext;
use crate::effects::chain::EffectChain;
use crate::geometry::{Pose, direction};
use crate::simulator::baseline::MotionModel;
use crate::statistics::rounding;
use crate::statistics::summary::median;

/// The median distance between predicted and logged ends of paths.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PathError {
    /// Length of a path in steps.
    pub steps: usize,
    /// With the simulator as it is, cm.
    #[serde(serialize_with = "rounding::number")]
    pub before_cm: f64,
    /// With the effects added, cm.
    #[serde(serialize_with = "rounding::number")]
    pub after_cm: f64,
    /// From process and tracker noise alone, as for a perfect simulator, cm.
    #[serde(serialize_with = "rounding::number")]
    pub floor_cm: f64,
}

/// Lengths of paths.
const LENGTHS: [usize; 5] = [1, 2, 5, 10, 25];
/// Paths drawn for the floor from each start.
const DRAWS: usize = 8;
/// Added to the seed, so that these draws are not those of the bootstrap.
const STREAM: u64 = 3;

/// The error for each length of which the runs have paths: with the effects that the simulator has (first) and with
/// those that were found (second). The noise follows from `seed`.
pub fn open_loop(effects: [&EffectChain; 2], drive: &MotionModel, logs: &Observations, seed: u64) -> Vec<PathError> {
    let mut rng = generator(seed.wrapping_add(STREAM), &[]);
    LENGTHS.iter().filter_map(|steps| error(*steps, effects, drive, logs, &mut rng)).collect()
}

fn error(
    steps: usize,
    [before, after]: [&EffectChain; 2],
    drive: &MotionModel,
    logs: &Observations,
    rng: &mut Generator,
) -> Option<PathError> {
    let starts = (0..logs.rows.len().saturating_sub(steps)).step_by(steps.div_ceil(2));
    let pieces: Vec<&[Observation]> = starts.map(|i| &logs.rows[i..=i + steps]).filter(|p| is_unbroken(p)).collect();
    let ends = |effects: &EffectChain| -> Vec<DVec2> {
        pieces.iter().map(|piece| end(effects, drive, piece, || [0.0; 3])).collect()
    };
    let logged = pieces.iter().map(|piece| piece[steps].context.pose.position_cm);
    let predicted = ends(after);
    let noise = Noise::of(drive);
    let floor: Vec<f64> = pieces
        .iter()
        .zip(&predicted)
        .flat_map(|(piece, end)| {
            (0..DRAWS).map(|_| noise.drawn(after, drive, piece, rng).distance(*end)).collect::<Vec<_>>()
        })
        .collect();
    (!pieces.is_empty()).then(|| PathError {
        steps,
        before_cm: median(ends(before).iter().zip(logged.clone()).map(|(a, b)| a.distance(b))),
        after_cm: median(predicted.iter().zip(logged).map(|(a, b)| a.distance(b))),
        floor_cm: median(floor.into_iter()),
    })
}

/// Rows of one run without a gap between them.
fn is_unbroken(piece: &[Observation]) -> bool {
    piece.windows(2).all(|pair| pair[0].run == pair[1].run && pair[0].at + 1 == pair[1].at && pair[0].motion.is_some())
}

/// Where the robot ends that starts as the piece does and is given its commands.
fn end(
    effects: &EffectChain,
    drive: &MotionModel,
    piece: &[Observation],
    mut scatter: impl FnMut() -> [f64; 3],
) -> DVec2 {
    let mut pose = piece[0].context.pose;
    for row in &piece[..piece.len() - 1] {
        let motion = predictions::step(effects, drive, &StepContext { pose, ..row.context });
        let [forward, lateral, turn] = scatter();
        let way = [motion.forward_cm + forward, motion.lateral_cm + lateral].map(|w| w * row.stretch);
        pose = pose.compose(&Pose::new(way[0], way[1], (motion.turn_rad + turn) * row.stretch));
    }
    pose.position_cm
}

/// What scatters where nothing is wrong, as standard deviations: the robot's own adds up from step to step, the
/// tracker's is there at a path's two ends alone.
struct Noise {
    robot: [f64; 3],
    tracker_cm: [f64; 2],
    tracker_rad: f64,
}

impl Noise {
    fn of(drive: &MotionModel) -> Self {
        let (all, own) = (drive.scatter(), drive.process_noise_fraction());
        let tracker = [0, 1, 2].map(|c| all[c] * (1.0 - own[c] * own[c]).max(0.0).sqrt());
        let robot = [0, 1, 2].map(|c| all[c] * own[c]);
        // A step's residual has the tracker's error at both its ends; the heading's matters at the begin alone.
        Noise { robot, tracker_cm: [tracker[0], tracker[1]], tracker_rad: tracker[2] / 2f64.sqrt() }
    }

    /// The end of a path that the explained robot might have driven, as the tracker might have seen it.
    fn drawn(&self, effects: &EffectChain, drive: &MotionModel, piece: &[Observation], rng: &mut Generator) -> DVec2 {
        let driven = end(effects, drive, piece, || self.robot.map(|s| s * normal(rng)));
        let from = piece[0].context.pose.position_cm;
        let seen = DVec2::from(self.tracker_cm.map(|s| s * normal(rng)));
        from + direction(self.tracker_rad * normal(rng)).rotate(driven - from) + seen
    }
}

fn normal(rng: &mut Generator) -> f64 {
    StandardNormal.sample(rng)
}
