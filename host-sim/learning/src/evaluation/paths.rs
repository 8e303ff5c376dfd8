//! Multi-step prediction error: the distance between the ends of open-loop predicted and logged paths, for the simulator
//! as it is, with the effects added, and from noise alone.

use glam::DVec2;
use rand_distr::{Distribution, StandardNormal};
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

/// What came of paths of one length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Paths {
    /// How far they end off.
    pub error: PathError,
    /// By how much nearer the effects bring them to their logged ends, as a share of what they would if it was they that the
    /// robot has: 95 % interval by bootstrap over blocks, none where there are too few. It is one where they would bring nothing
    /// nearer.
    pub nearer_ci95: Option<[f64; 2]>,
}

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

/// What paths are driven with.
pub struct Rollouts<'a> {
    /// The drive.
    pub drive: &'a MotionModel<'a>,
    /// The effects that the simulator has,
    pub before: &'a EffectChain,
    /// and these with those that were found.
    pub after: &'a EffectChain,
    /// How steps scatter that the latter leave: forward (cm), lateral (cm), turn (rad).
    pub scatter: [f64; 3],
}

/// How far one path ends off.
struct End {
    block: usize,
    /// Without the effects and with them.
    off_cm: [f64; 2],
    floor_cm: [f64; DRAWS],
    /// As `off_cm`, of paths that the robot might have driven if the effects were what it has.
    foretold_cm: [[f64; 2]; DRAWS],
}

/// Lengths of paths.
const LENGTHS: [usize; 5] = [1, 2, 5, 10, 25];
/// Paths drawn for the floor from each start, and as many that the effects foretell.
const DRAWS: usize = 8;
/// Added to the seed, so that these draws are not those of the bootstrap.
const STREAM: u64 = 3;
/// Of fewer blocks no interval is told: of three, one draw in nine is the same one three times.
const FEWEST_BLOCKS: usize = 4;

impl Rollouts<'_> {
    /// The paths of each length that the runs have; the noise follows from `seed`.
    pub fn paths(&self, logs: &Observations, seed: u64) -> Vec<Paths> {
        let stream = seed.wrapping_add(STREAM);
        let (mut floor, mut foretold) = (generator(stream, &[]), generator(stream, &[1]));
        let noise = [self.drive.scatter(), self.scatter].map(|scatter| Noise::of(self.drive, scatter));
        let of_length = |steps| {
            let starts = (0..logs.rows.len().saturating_sub(steps)).step_by(steps.div_ceil(2));
            let pieces = starts.map(|i| &logs.rows[i..=i + steps]).filter(|piece| is_unbroken(piece));
            let ends: Vec<End> = pieces.map(|piece| self.end(piece, &noise, [&mut floor, &mut foretold])).collect();
            (!ends.is_empty()).then(|| Paths::of(steps, &ends, seed))
        };
        LENGTHS.into_iter().filter_map(of_length).collect()
    }

    /// The noise is that of the drive, for the floor, and that which the effects leave.
    fn end(&self, piece: &[Observation], [assumed, own]: &[Noise; 2], [floor, foretold]: [&mut Generator; 2]) -> End {
        let Rollouts { drive, before, after, .. } = *self;
        let predicted = [before, after].map(|effects| end(effects, drive, piece, || [0.0; 3]));
        let off = |end: DVec2| predicted.map(|predicted| predicted.distance(end));
        let drawn =
            |noise: &Noise, rng: &mut Generator| [(); DRAWS].map(|()| off(noise.drawn(after, drive, piece, rng)));
        End {
            block: piece[0].block,
            off_cm: off(piece[piece.len() - 1].context.pose.position_cm),
            floor_cm: drawn(assumed, floor).map(|[_, after_cm]| after_cm),
            foretold_cm: drawn(own, foretold),
        }
    }
}

impl Paths {
    fn of(steps: usize, ends: &[End], seed: u64) -> Self {
        let [before_cm, after_cm] = [0, 1].map(|place| median(ends.iter().map(|end| end.off_cm[place])));
        let floor_cm = median(ends.iter().flat_map(|end| end.floor_cm));
        // Means count the few paths that an effect touches, and a wild row is no matter: no end, however far off, lies nearer to
        // one prediction than to another by more than they lie apart.
        let blocks: Vec<&[End]> = ends.chunk_by(|one, next| one.block == next.block).collect();
        let by_block =
            |nearer_cm: fn(&End) -> f64| blocks.iter().map(|ends| ends.iter().map(nearer_cm).sum()).collect();
        let (logged, foretold): (Vec<f64>, Vec<f64>) = (by_block(End::nearer_cm), by_block(End::foretold_nearer_cm));
        let share = |logged: f64, foretold: f64| Some(if foretold > 0.0 { logged / foretold } else { 1.0 });
        let told = blocks.len() >= FEWEST_BLOCKS;
        Paths {
            error: PathError { steps, before_cm, after_cm, floor_cm },
            nearer_ci95: told.then(|| bootstrap::interval(&logged, &foretold, seed, share)),
        }
    }
}

impl End {
    fn nearer_cm(&self) -> f64 {
        self.off_cm[0] - self.off_cm[1]
    }

    /// The mean of what is drawn.
    fn foretold_nearer_cm(&self) -> f64 {
        self.foretold_cm.iter().map(|[before, after]| before - after).sum::<f64>() / DRAWS as f64
    }
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
    /// Of steps that scatter so much; what they do beyond the drive's is the robot's own.
    fn of(drive: &MotionModel, scatter: [f64; 3]) -> Self {
        let (all, own) = (drive.scatter(), drive.process_noise_fraction());
        let tracker = [0, 1, 2].map(|c| all[c] * (1.0 - own[c] * own[c]).max(0.0).sqrt());
        let further = |c: usize| (scatter[c] * scatter[c] - all[c] * all[c]).max(0.0);
        let robot = [0, 1, 2].map(|c| libm::hypot(all[c] * own[c], further(c).sqrt()));
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
