//! Motions worked out ahead: a controller holds at most twelve different pairs of commands now and before, so the
//! motion networks are asked twelve times a controller, side by side, and not once a step.

use mindgap_core::controller::{Controller, TUPLES};
use mindgap_core::folded::{FoldedNetwork, evaluate_all};
use mindgap_core::maths::Binary32;
use pulp::{Arch, Simd, WithSimd};

use super::ensemble::{CommandScale, HeldMotion, Member};
use super::nominal::MotionBias;
use super::nominal::motion_bias::{FEATURES, features};
use super::residuals::{ResidualNoise, ResidualQuantiles, motion_context};
use super::{Learned, Simulator};
use crate::effects::context::HISTORY;
use mindgap_foundations::error::Result;
use mindgap_foundations::lanes::Lanes;
use mindgap_logs::samples::MotionSample;

/// The three motion networks of a simulator, as they are or with what the logs say beyond them.
#[derive(Clone)]
pub struct MotionNetworks<'s> {
    /// Forward, lateral, turn.
    networks: Box<[FoldedNetwork<f32, 4>; 3]>,
    residuals: [&'s ResidualQuantiles; 3],
    scale: CommandScale,
    /// Weights of what is added, one a feature, and what makes shares of full speed of commands.
    correction: Option<(Box<[[f32; FEATURES]; 3]>, f32)>,
    /// The robot whose bias is added, of those that it may be.
    member: Option<&'s Member>,
}

/// What one step does, in the robot's own frame, before scatter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// Way forward, cm.
    pub forward_cm: f32,
    /// Way to the left, cm.
    pub lateral_cm: f32,
    /// Turn to the left.
    pub turn_rad: f32,
    /// Cells of the forward, lateral and turn networks' residuals.
    pub cells: [usize; 3],
}

/// The motions of a controller: for each tuple the step after it began, and every later one.
#[derive(Clone, Debug, PartialEq)]
pub struct MotionTable {
    first: [Motion; TUPLES],
    steady: [Motion; TUPLES],
    /// What a robot of a distribution does beyond what was known of it in training, for each tuple: effects act on that.
    bias: [MotionVector; TUPLES],
    /// Multiples of residuals in each step and for as long as it is held, of each channel.
    scatter: [[[f32; 2]; 3]; TUPLES],
    /// With added effects that depend on commands alone.
    transients: Option<Box<Transients>>,
}

/// Motions of the first steps of each tuple, and of every later one, if the tuple before was held for as many steps as an
/// effect looks back.
pub(super) type Transients = [[Motion; HISTORY]; TUPLES];

/// Way forward (cm), way to the left (cm) and turn (rad) of a step.
type MotionVector = [f32; 3];

/// Left, right, previous left and previous right command.
pub type Speeds<S> = [S; 4];

const RADIANS_PER_DEGREE: f32 = std::f32::consts::PI / 180.0;

impl<'s> MotionNetworks<'s> {
    /// The networks of a simulator.
    ///
    /// # Errors
    /// Names the one that is missing.
    pub fn of(simulator: &'s Simulator) -> Result<Self> {
        let learned: [&Learned<4>; 3] = [
            simulator.need(&simulator.forward, "forward")?,
            simulator.need(&simulator.lateral, "lateral")?,
            simulator.need(&simulator.turn, "turn")?,
        ];
        Ok(MotionNetworks {
            networks: Box::new(learned.map(|l| FoldedNetwork::fold(&l.network))),
            residuals: learned.map(|l| &l.residuals),
            scale: CommandScale::of(simulator.commands),
            correction: None,
            member: None,
        })
    }

    /// The networks with the misfit that `reference` knows of put right: a robot that turns two degrees less than its
    /// network says does so in every step and every run, which no zero-mean scatter stands for.
    pub fn corrected(self, reference: Option<&MotionBias>) -> Self {
        let weight = |weights: &[f64], feature: usize| weights.get(feature).map_or(0.0, |w| *w as f32);
        let weights = |r: &MotionBias| {
            [0, 1, 2].map(|network| std::array::from_fn(|feature| weight(&r.weights[network], feature)))
        };
        MotionNetworks { correction: reference.map(|r| (Box::new(weights(r)), r.scale.share())), ..self }
    }

    /// The networks with what one robot of a distribution does beyond them, in [tables](Self::table) alone.
    pub fn of_robot(self, member: &'s Member) -> Self {
        MotionNetworks { member: Some(member), ..self }
    }

    /// What chance adds to forward (cm), lateral (cm) and turn (rad), in multiples that [tables](Self::table) tell. Of what
    /// lasts while a command is held most stood for not knowing the robot: of one that is known its own chance is known.
    pub fn residual_noise(&self) -> [ResidualNoise; 3] {
        if self.member.is_some() {
            return [(); 3].map(|()| ResidualNoise::normal());
        }
        let noise = |channel: usize| ResidualNoise::new(self.residuals[channel]);
        [noise(0), noise(1), noise(2).times(RADIANS_PER_DEGREE)]
    }

    /// What is said of a step of a command that is held: forward (cm), lateral (cm) and turn (degrees).
    pub fn held(&self, command: [f64; 2]) -> [f64; 3] {
        let [left, right] = command.map(|c| c as f32);
        let [forward_cm, lateral_cm, turn_rad] = self.evaluate([left, right, left, right]).map(f64::from);
        [forward_cm, lateral_cm, turn_rad.to_degrees()]
    }

    /// What a step does.
    pub fn step(&self, speeds: Speeds<f32>) -> Motion {
        let [forward_cm, lateral_cm, turn_rad] = self.evaluate(speeds);
        Motion { forward_cm, lateral_cm, turn_rad, cells: self.cells(&speeds) }
    }

    /// Logged minus what is said of a step: forward (cm), lateral (cm) and turn (rad).
    pub fn residual(&self, logged: &MotionSample) -> [f64; 3] {
        let [forward_cm, lateral_cm, turn_rad] = self.evaluate(logged.speeds.map(|v| v as f32)).map(f64::from);
        [logged.forward_cm - forward_cm, logged.lateral_cm - lateral_cm, logged.turn_rad - turn_rad]
    }

    /// Way forward and to the left in cm and turn to the left in radians.
    #[inline(always)]
    pub fn evaluate<S: Binary32>(&self, speeds: Speeds<S>) -> [S; 3] {
        let mut motion = evaluate_all(&self.networks, speeds);
        motion[2] = motion[2] * motion[2].constant(RADIANS_PER_DEGREE);
        if let Some((correction, share)) = &self.correction {
            let features = features(speeds, *share);
            for (sum, weights) in motion.iter_mut().zip(correction.iter()) {
                *sum = *sum + S::weighted_sum(sum.zero(), &features, weights);
            }
        }
        motion
    }

    /// The motions of a controller that starts from rest.
    pub fn table(&self, controller: &Controller) -> MotionTable {
        let mut steps = [[0.0; 4]; 2 * TUPLES];
        for tuple in 0..TUPLES {
            steps[tuple] = speeds(controller, tuple, true);
            steps[TUPLES + tuple] = speeds(controller, tuple, false);
        }
        let [forward_cm, lateral_cm, turn_rad] = Arch::new().dispatch(SideBySide { networks: self, steps: &steps });
        let motion = |i: usize| Motion {
            forward_cm: forward_cm[i],
            lateral_cm: lateral_cm[i],
            turn_rad: turn_rad[i],
            cells: self.cells(&steps[i]),
        };
        let (first, steady) = (std::array::from_fn(motion), std::array::from_fn(|t| motion(TUPLES + t)));
        let mut table =
            MotionTable { first, steady, bias: [[0.0; 3]; TUPLES], scatter: [[[1.0; 2]; 3]; TUPLES], transients: None };
        if let Some(member) = self.member {
            for (tuple, first) in steps[..TUPLES].iter().enumerate() {
                let command = [first[0], first[1]].map(f64::from);
                let (does, trained) = (member.motion(command), member.trained(command));
                table.add(tuple, beyond(does, self.held(command)), first_step(member, first));
                table.bias[tuple] = beyond(does, trained);
                let [forward, lateral, turn] = member.scatter(command);
                table.scatter[tuple] = [forward, lateral, turn.map(f64::to_radians)].map(|of| of.map(|v| v as f32));
            }
        }
        table
    }

    /// A step as it was known in training: what networks say, and what their logs say beyond it.
    pub fn trained_step(&self, speeds: Speeds<f32>) -> Motion {
        let (step, command) = (self.step(speeds), [speeds[0], speeds[1]].map(f64::from));
        self.member.map_or(step, |member| step.plus(&beyond(member.trained(command), self.held(command))))
    }

    fn cells(&self, speeds: &Speeds<f32>) -> [usize; 3] {
        let context = motion_context(speeds);
        self.residuals.map(|residuals| residuals.cell(context))
    }
}

impl HeldMotion for MotionNetworks<'_> {
    fn motion(&self, command: [f64; 2]) -> [f64; 3] {
        self.held(command)
    }

    fn scale(&self) -> CommandScale {
        self.scale
    }
}

impl MotionTable {
    /// The motion of a step in which a tuple is held, its first step or a later one.
    pub fn motion(&self, tuple: usize, first: bool) -> &Motion {
        if first { &self.first[tuple] } else { &self.steady[tuple] }
    }

    /// What of that no network says: way forward (cm), way to the left (cm) and turn (rad).
    pub fn bias(&self, tuple: usize) -> &[f32; 3] {
        &self.bias[tuple]
    }

    /// Multiples of residuals while a tuple is held: in each step, and for as long, of each channel.
    #[inline(always)]
    pub fn scatter(&self, tuple: usize) -> &[[f32; 2]; 3] {
        &self.scatter[tuple]
    }

    /// The table with what added effects make of the motions, before the bias.
    pub(super) fn with_transients(self, transients: Option<Transients>) -> Self {
        MotionTable { transients: transients.map(Box::new), ..self }
    }

    /// What added effects make of the motions, before the bias, where that is known ahead.
    pub(super) fn transients(&self) -> Option<&Transients> {
        self.transients.as_deref()
    }

    fn add(&mut self, tuple: usize, bias: MotionVector, first_step: MotionVector) {
        self.steady[tuple] = self.steady[tuple].plus(&bias);
        self.first[tuple] = self.first[tuple].plus(&bias).plus(&first_step);
    }
}

impl Motion {
    /// The motion with more of it: way forward (cm), way to the left (cm) and turn (rad).
    pub fn plus(&self, more: &[f32; 3]) -> Self {
        let [forward_cm, lateral_cm, turn_rad] = *more;
        Motion {
            forward_cm: self.forward_cm + forward_cm,
            lateral_cm: self.lateral_cm + lateral_cm,
            turn_rad: self.turn_rad + turn_rad,
            cells: self.cells,
        }
    }
}

/// What a robot does beyond something that is known: forward and lateral in cm, turn in degrees.
fn beyond(does: [f64; 3], known: [f64; 3]) -> MotionVector {
    in_radians(std::array::from_fn(|channel| does[channel] - known[channel]))
}

/// What the first step of a robot's command after another does beyond later ones.
fn first_step(member: &Member, speeds: &Speeds<f32>) -> MotionVector {
    let [left, right, left_before, right_before] = speeds.map(|c| c as i8);
    in_radians(member.first_step([left, right], [left_before, right_before]))
}

fn in_radians([forward_cm, lateral_cm, turn_deg]: [f64; 3]) -> MotionVector {
    [forward_cm, lateral_cm, turn_deg.to_radians()].map(|v| v as f32)
}

/// The commands of a step in which a tuple is held, and of the step before it.
pub fn speeds(controller: &Controller, tuple: usize, first: bool) -> Speeds<f32> {
    let command = |tuple: usize| [controller.tuples[tuple].left, controller.tuples[tuple].right].map(f32::from);
    let [left, right] = command(tuple);
    let [left_before, right_before] = match (first, tuple) {
        (true, 0) => [0.0; 2],
        (true, _) => command(tuple - 1),
        (false, _) => [left, right],
    };
    [left, right, left_before, right_before]
}

/// The steps of a controller, one a lane.
struct SideBySide<'a, 's> {
    networks: &'a MotionNetworks<'s>,
    steps: &'a [Speeds<f32>; 2 * TUPLES],
}

impl WithSimd for SideBySide<'_, '_> {
    type Output = [[f32; 2 * TUPLES]; 3];

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let mut columns = [[0.0; 2 * TUPLES]; 4];
        for (i, speeds) in self.steps.iter().enumerate() {
            for (column, speed) in columns.iter_mut().zip(speeds) {
                column[i] = *speed;
            }
        }
        let mut motions = [[0.0; 2 * TUPLES]; 3];
        for from in (0..2 * TUPLES).step_by(Lanes::<S>::WIDTH) {
            let mut speeds = [Lanes::splat(simd, 0.0); 4];
            for (speed, column) in speeds.iter_mut().zip(&columns) {
                *speed = Lanes::load(simd, &column[from..]);
            }
            let motion = self.networks.evaluate(speeds);
            for (column, lanes) in motions.iter_mut().zip(motion) {
                lanes.store(&mut column[from..]);
            }
        }
        motions
    }
}
