//! Applied effects around each simulated step. Where they depend on commands alone, the motions of a controller are computed
//! ahead; otherwise an effect may depend on the whole history of a run.

use std::array;

use mindgap_core::controller::Controller;
use rand::RngExt;

use super::beam::Beam;
use super::known_steps::KnownSteps;
use super::motion::{MotionNetworks, PredictedStep, Speeds, Transients, speeds};
use super::{Noise, Simulator};
use crate::effects::StepContext;
use crate::effects::chain::EffectChain;
use crate::effects::context::{RunHistory, Surroundings};
use crate::sonar::SensorLaw;
use mindgap_foundations::error::{Error, Result};
use mindgap_foundations::geometry::Pose;
use mindgap_foundations::motion::Motion;
use mindgap_foundations::random::generator;
use mindgap_logs::Scene;

/// Applied effects in an environment.
pub(super) struct EffectLayer {
    effects: EffectChain,
    surroundings: Surroundings,
    /// Least and largest command that the networks know.
    commands: [f64; 2],
    /// Whether an effect on the motion may depend on what the sensor faces: none of the catalogue does.
    looks: bool,
    /// Present when an effect changes the sensor.
    sonar: Option<SensorLaw>,
    /// Present when that change is the same everywhere.
    beam: Option<Beam>,
    noise: Noise,
}

/// The history of a run, on which effects depend.
#[derive(Clone, Debug, Default)]
pub(super) struct EffectMemory {
    history: RunHistory,
    steps: usize,
}

impl EffectMemory {
    /// Starts a step with this command.
    pub fn command(&mut self, command: [f32; 2]) {
        self.history.command(command.map(f64::from));
    }
}

impl EffectLayer {
    /// Returns the filter of a simulator and the effects applied to it, if there are any.
    ///
    /// # Errors
    /// When an effect changes a sensor whose normal behaviour the simulator does not know.
    pub fn of(simulator: &Simulator, scene: &Scene, noise: Noise) -> Result<Option<Self>> {
        let effects = simulator.chain();
        if effects.is_empty() {
            return Ok(None);
        }
        let law = simulator.drawn_law();
        if effects.senses() && law.is_none() {
            return Err(Error::new("an added effect changes the sonar, and the simulator does not know its usual law"));
        }
        let surroundings = Surroundings::new(&simulator.robot, scene);
        let anywhere = surroundings.context(&RunHistory::default(), 0.0, Pose::new(0.0, 0.0, 0.0));
        let sensor = |heard_before: bool| {
            let mut context = anywhere;
            context.echo_before = Some(heard_before);
            effects.sensor(&context)
        };
        let is_alike = noise == Noise::Learned && effects.senses() && effects.senses_alike_everywhere();
        let beam = match &law {
            Some(SensorLaw::Beam(model)) if is_alike => Beam::changed(model, &[true, false].map(sensor)),
            _ => None,
        };
        Ok(Some(EffectLayer {
            beam,
            sonar: law.filter(|_| effects.senses()),
            effects,
            surroundings,
            commands: simulator.commands.map(f64::from),
            looks: simulator.added.iter().any(|effect| effect.definition.is_some()),
            noise,
        }))
    }

    /// Predicts the step of a robot at `pose` under `command`, before noise; `trained` predicts a step without effects.
    pub fn motion(
        &self,
        memory: &mut EffectMemory,
        pose: Pose,
        command: [f32; 2],
        trained: impl FnMut(Speeds<f32>) -> PredictedStep,
    ) -> PredictedStep {
        memory.command(command);
        let context = if self.looks { self.context(memory, pose) } else { self.unseen(memory, pose) };
        let step = self.step(&context, trained);
        memory.history.was_at(Some(pose));
        memory.steps += 1;
        step
    }

    /// Predicts the motions of a controller that starts from rest, if they depend on its commands alone.
    pub fn transients(&self, controller: &Controller, networks: &MotionNetworks) -> Option<Transients> {
        // A sensor that asks for more looks back on where the robot was.
        if !self.effects.moves_by_commands_alone() || self.senses() && self.beam.is_none() {
            return None;
        }
        let anywhere = self.context(&EffectMemory::default(), Pose::new(0.0, 0.0, 0.0));
        let mut known = KnownSteps::new(networks);
        let of_tuple = |tuple: usize| {
            let [left, right, left_before, right_before] = speeds(controller, tuple, true).map(f64::from);
            array::from_fn(|steps| {
                let command = |ago: usize| if ago <= steps { [left, right] } else { [left_before, right_before] };
                let mut context = anywhere;
                context.commands = array::from_fn(command);
                self.step(&context, |speeds| known.step(speeds))
            })
        };
        Some(array::from_fn(of_tuple))
    }

    fn step(&self, context: &StepContext, mut trained: impl FnMut(Speeds<f32>) -> PredictedStep) -> PredictedStep {
        let mut cells = Motion::splat(0);
        let step = |now: [f64; 2], before: [f64; 2]| {
            let [low, high] = self.commands;
            let step = trained([now[0], now[1], before[0], before[1]].map(|c| c.clamp(low, high) as f32));
            cells = step.cells;
            step.motion.map(f64::from)
        };
        let motion = self.effects.wrap(context, step).map(|value| value as f32);
        PredictedStep { motion, cells }
    }

    /// Returns the effects with readings by another law, where effects change them.
    pub fn hearing_by(self, law: SensorLaw) -> Self {
        EffectLayer { sonar: self.sonar.map(|_| law), beam: None, ..self }
    }

    /// Returns whether readings are generated here.
    pub fn senses(&self) -> bool {
        self.sonar.is_some()
    }

    /// Returns what generates them for lanes of robots, where it can.
    pub fn beam(&self) -> Option<&Beam> {
        self.beam.as_ref()
    }

    /// Returns the reading at `pose`, where the effects change the sensor; `draw` seeds its noise.
    pub fn echo_cm(&self, memory: &mut EffectMemory, pose: Pose, draw: f32) -> Option<f32> {
        let law = self.sonar.as_ref()?;
        let context = self.context(memory, pose);
        let outcomes = self.effects.sensor(&context).outcomes(law, &self.surroundings);
        let mut rng = generator(u64::from(draw.to_bits()), &[memory.steps as u64]);
        let echo_cm = outcomes.draw(self.noise == Noise::Learned, || rng.random());
        memory.history.sensed(echo_cm);
        echo_cm.map(|cm| cm as f32)
    }

    fn context(&self, memory: &EffectMemory, pose: Pose) -> StepContext {
        self.surroundings.context(&memory.history, self.elapsed_ms(memory), pose)
    }

    fn unseen(&self, memory: &EffectMemory, pose: Pose) -> StepContext {
        self.surroundings.unseen(&memory.history, self.elapsed_ms(memory), pose)
    }

    fn elapsed_ms(&self, memory: &EffectMemory) -> f64 {
        memory.steps as f64 * self.surroundings.robot.step_ms
    }
}
