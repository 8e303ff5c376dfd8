//! Predicted motions of a controller, computed ahead: it holds at most twelve different pairs of commands now and before,
//! so the motion networks are evaluated twelve times per controller, side by side, and not once per step.

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
use mindgap_foundations::motion::Motion;
use mindgap_logs::samples::MotionSample;

/// The three motion networks of a simulator, alone or with the corrections that logs give beyond them.
#[derive(Clone)]
pub struct MotionNetworks<'s> {
    /// In the order of the axes. The turn network's output is in degrees.
    networks: Box<[FoldedNetwork<f32, 4>; 3]>,
    residuals: Motion<&'s ResidualQuantiles>,
    scale: CommandScale,
    /// Weights of the correction, one per feature, and the factor that makes fractions of full speed of commands.
    correction: Option<(Box<Motion<[f32; FEATURES]>>, f32)>,
    /// The robot of the ensemble whose bias is added.
    member: Option<&'s Member>,
}

/// What one step does, before scatter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PredictedStep {
    /// The motion, in cm and radians.
    pub motion: Motion<f32>,
    /// Cells of the networks' residuals.
    pub cells: Motion<usize>,
}

/// The motions of a controller: for each tuple its first step, and every later one.
#[derive(Clone, Debug, PartialEq)]
pub struct MotionTable {
    first: [PredictedStep; TUPLES],
    steady: [PredictedStep; TUPLES],
    /// For each tuple, what a robot of the ensemble does beyond what training knew of it: effects act on the latter.
    bias: [Motion<f32>; TUPLES],
    /// For each tuple, factors on the residuals that are drawn per step and per held command.
    scatter: [Motion<[f32; 2]>; TUPLES],
    /// With added effects that depend on commands alone.
    transients: Option<Box<Transients>>,
}

/// Predictions for the first steps of each tuple, and for every later one, if the tuple before was held for as many steps as
/// an effect looks back.
pub(super) type Transients = [[PredictedStep; HISTORY]; TUPLES];

/// Left, right, previous left and previous right command.
pub type Speeds<S> = [S; 4];

const RADIANS_PER_DEGREE: f32 = std::f32::consts::PI / 180.0;

impl<'s> MotionNetworks<'s> {
    /// Returns the networks of a simulator.
    ///
    /// # Errors
    /// Names the network that is missing.
    pub fn of(simulator: &'s Simulator) -> Result<Self> {
        let learned: [&Learned<4>; 3] = [
            simulator.need(&simulator.forward, "forward")?,
            simulator.need(&simulator.lateral, "lateral")?,
            simulator.need(&simulator.turn, "turn")?,
        ];
        Ok(MotionNetworks {
            networks: Box::new(learned.map(|l| FoldedNetwork::fold(&l.network))),
            residuals: learned.map(|l| &l.residuals).into(),
            scale: CommandScale::of(simulator.commands),
            correction: None,
            member: None,
        })
    }

    /// Returns the networks with the misfit that `reference` knows of corrected: a robot that turns two degrees less than its
    /// network predicts does so in every step and every run, which no zero-mean scatter can represent.
    pub fn corrected(self, reference: Option<&MotionBias>) -> Self {
        let weight = |weights: &[f64], feature: usize| weights.get(feature).map_or(0.0, |w| *w as f32);
        let weights = |r: &MotionBias| {
            r.weights.each_ref().map(|weights| std::array::from_fn(|feature| weight(weights, feature)))
        };
        MotionNetworks { correction: reference.map(|r| (Box::new(weights(r)), r.scale.share())), ..self }
    }

    /// Returns the networks with the bias of one robot of the ensemble, which only [tables](Self::table) include.
    pub fn of_robot(self, member: &'s Member) -> Self {
        MotionNetworks { member: Some(member), ..self }
    }

    /// Returns the noise of each axis, to be scaled by the factors of [tables](Self::table). Residuals that last while a command
    /// is held mostly stand for what is not known of the robot; for a robot of the ensemble its own noise is known.
    pub fn residual_noise(&self) -> Motion<ResidualNoise> {
        if self.member.is_some() {
            return Motion::from_fn(|_| ResidualNoise::normal());
        }
        let noise = self.residuals.map(ResidualNoise::new);
        Motion { turn: noise.turn.times(RADIANS_PER_DEGREE), ..noise }
    }

    /// Predicts a step.
    pub fn step(&self, speeds: Speeds<f32>) -> PredictedStep {
        let motion = if self.rests(&speeds) { Motion::splat(0.0) } else { self.evaluate(speeds) };
        PredictedStep { motion, cells: self.cells(&speeds) }
    }

    /// Returns whether a robot stands still: its commands are and were zero. Logs hardly show it, since they hold driven robots,
    /// and networks do not know it. What is left of earlier commands behind a filter counts as zero below half a percent.
    pub fn rests(&self, speeds: &Speeds<f32>) -> bool {
        let [left, right, left_before, right_before] = speeds.map(f64::from);
        self.scale.is_rest([left, right]) && self.scale.is_rest([left_before, right_before])
    }

    /// Returns logged minus predicted motion of a step.
    pub fn residual(&self, logged: &MotionSample) -> Motion<f64> {
        logged.motion() - self.evaluate(logged.speeds.map(|v| v as f32)).map(f64::from)
    }

    /// Predicts the motion of a step, in cm and radians.
    #[inline(always)]
    pub fn evaluate<S: Binary32>(&self, speeds: Speeds<S>) -> Motion<S> {
        let mut motion = Motion::from(evaluate_all(&self.networks, speeds));
        motion.turn = motion.turn * motion.turn.constant(RADIANS_PER_DEGREE);
        if let Some((correction, share)) = &self.correction {
            let features = features(speeds, *share);
            for (sum, weights) in motion.iter_mut().zip(correction.iter()) {
                *sum = *sum + S::weighted_sum(sum.zero(), &features, weights);
            }
        }
        motion
    }

    /// Predicts the motions of a controller that starts from rest.
    pub fn table(&self, controller: &Controller) -> MotionTable {
        let mut steps = [[0.0; 4]; 2 * TUPLES];
        for tuple in 0..TUPLES {
            steps[tuple] = speeds(controller, tuple, true);
            steps[TUPLES + tuple] = speeds(controller, tuple, false);
        }
        let columns = Arch::new().dispatch(SideBySide { networks: self, steps: &steps });
        let step = |i: usize| {
            let motion = columns.each_ref().map(|column| if self.rests(&steps[i]) { 0.0 } else { column[i] });
            PredictedStep { motion, cells: self.cells(&steps[i]) }
        };
        let mut table = MotionTable {
            first: std::array::from_fn(step),
            steady: std::array::from_fn(|tuple| step(TUPLES + tuple)),
            bias: [Motion::splat(0.0); TUPLES],
            scatter: [Motion::splat([1.0; 2]); TUPLES],
            transients: None,
        };
        if let Some(member) = self.member {
            for tuple in 0..TUPLES {
                let (first, steady) = (&steps[tuple], &steps[TUPLES + tuple]);
                let command = [first[0], first[1]].map(f64::from);
                let (does, trained) = (member.motion(command), member.trained(command));
                let bias = single(does - self.motion(command));
                if !self.rests(first) {
                    table.first[tuple] = table.first[tuple].plus(bias).plus(first_step(member, first));
                }
                if !self.rests(steady) {
                    table.steady[tuple] = table.steady[tuple].plus(bias);
                    table.bias[tuple] = single(does - trained);
                }
                let scatter = member.scatter(command);
                let scatter = Motion { turn: scatter.turn.map(f64::to_radians), ..scatter };
                table.scatter[tuple] = scatter.map(|of| of.map(|v| v as f32));
            }
        }
        table
    }

    /// Predicts a step as training knew it: by the networks, and what their logs add.
    pub fn trained_step(&self, speeds: Speeds<f32>) -> PredictedStep {
        let (step, command) = (self.step(speeds), [speeds[0], speeds[1]].map(f64::from));
        let member = self.member.filter(|_| !self.rests(&speeds));
        member.map_or(step, |member| step.plus(single(member.trained(command) - self.motion(command))))
    }

    fn cells(&self, speeds: &Speeds<f32>) -> Motion<usize> {
        let context = motion_context(speeds);
        self.residuals.map(|residuals| residuals.cell(context))
    }
}

impl HeldMotion for MotionNetworks<'_> {
    fn motion(&self, [left, right]: [f64; 2]) -> Motion<f64> {
        self.evaluate([left, right, left, right].map(|c| c as f32)).map(f64::from).turn_in_degrees()
    }

    fn scale(&self) -> CommandScale {
        self.scale
    }
}

impl MotionTable {
    /// Returns the prediction for a step in which a tuple is held: its first step or a later one.
    pub fn step(&self, tuple: usize, first: bool) -> &PredictedStep {
        if first { &self.first[tuple] } else { &self.steady[tuple] }
    }

    /// Returns the part of that which no network predicts.
    pub fn bias(&self, tuple: usize) -> Motion<f32> {
        self.bias[tuple]
    }

    /// Returns factors on residuals while a tuple is held: those drawn per step, and those that last as long.
    #[inline(always)]
    pub fn scatter(&self, tuple: usize) -> &Motion<[f32; 2]> {
        &self.scatter[tuple]
    }

    /// Returns the table with predictions that include added effects, before the bias.
    pub(super) fn with_transients(self, transients: Option<Transients>) -> Self {
        MotionTable { transients: transients.map(Box::new), ..self }
    }

    /// Returns the predictions that include added effects, before the bias, where they are known ahead.
    pub(super) fn transients(&self) -> Option<&Transients> {
        self.transients.as_deref()
    }
}

impl PredictedStep {
    /// Returns the step with this motion added.
    pub fn plus(&self, more: Motion<f32>) -> Self {
        PredictedStep { motion: self.motion + more, cells: self.cells }
    }
}

/// Returns what the first step of a robot's command after another does beyond later ones.
fn first_step(member: &Member, speeds: &Speeds<f32>) -> Motion<f32> {
    let [left, right, left_before, right_before] = speeds.map(|c| c as i8);
    single(member.first_step([left, right], [left_before, right_before]))
}

/// Returns a motion of the ensemble, whose turn is in degrees, in single precision and radians.
fn single(motion_deg: Motion<f64>) -> Motion<f32> {
    motion_deg.turn_in_radians().map(|v| v as f32)
}

/// Returns the commands of a step in which a tuple is held, and of the step before it.
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

/// The steps of a controller, one per lane.
struct SideBySide<'a, 's> {
    networks: &'a MotionNetworks<'s>,
    steps: &'a [Speeds<f32>; 2 * TUPLES],
}

impl WithSimd for SideBySide<'_, '_> {
    type Output = Motion<[f32; 2 * TUPLES]>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let mut columns = [[0.0; 2 * TUPLES]; 4];
        for (i, speeds) in self.steps.iter().enumerate() {
            for (column, speed) in columns.iter_mut().zip(speeds) {
                column[i] = *speed;
            }
        }
        let mut motions = Motion::splat([0.0; 2 * TUPLES]);
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
