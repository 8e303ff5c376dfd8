//! The chain of applied effects around each simulated step. An effect may depend on the run's history, so the motion
//! of a controller cannot be computed in advance.

use rand::RngExt;

use super::motion::{Motion, MotionNetworks};
use super::{Noise, Simulator};
use crate::chance::generator;
use crate::effects::chain::EffectChain;
use crate::effects::context::{RunHistory, Surroundings};
use crate::effects::{PoseIncrement, StepContext};
use crate::error::{Error, Result};
use crate::geometry::Pose;
use crate::logs::Scene;
use crate::sonar::SonarModel;

/// Applied effects in an environment.
pub(super) struct EffectLayer<'s> {
    effects: EffectChain,
    surroundings: Surroundings,
    /// Least and largest command that the networks know.
    commands: [f64; 2],
    /// There when an effect changes the sensor.
    sonar: Option<&'s SonarModel>,
    noise: Noise,
}

/// What effects depend on: a run's history so far.
#[derive(Clone, Debug, Default)]
pub(super) struct EffectMemory {
    history: RunHistory,
    steps: usize,
}

impl<'s> EffectLayer<'s> {
    /// The effects applied to a simulator, if there are any.
    ///
    /// # Errors
    /// When an effect changes a sensor of which the simulator does not know what is normal.
    pub fn of(simulator: &'s Simulator, scene: &Scene, noise: Noise) -> Result<Option<Self>> {
        if simulator.added.is_empty() {
            return Ok(None);
        }
        let effects = EffectChain::of(&simulator.added);
        let model = simulator.reference.as_ref().and_then(|r| r.sonar.as_ref());
        if effects.senses() && model.is_none() {
            return Err(Error::new(
                "an added effect changes the sonar, and the simulator does not know its usual beam",
            ));
        }
        Ok(Some(EffectLayer {
            sonar: model.filter(|_| effects.senses()),
            effects,
            surroundings: Surroundings::new(&simulator.robot, scene),
            commands: simulator.commands.map(f64::from),
            noise,
        }))
    }

    /// Motion in a step of a robot at `pose` under `command`, before noise.
    pub fn motion(
        &self,
        memory: &mut EffectMemory,
        pose: Pose,
        command: [f32; 2],
        networks: &MotionNetworks,
    ) -> Motion {
        memory.history.command(command.map(f64::from));
        let context = self.context(memory, pose);
        let mut cells = [0; 3];
        let step = |now: [f64; 2], before: [f64; 2]| {
            let [low, high] = self.commands;
            let learned = networks.step([now[0], now[1], before[0], before[1]].map(|c| c.clamp(low, high) as f32));
            cells = learned.cells;
            let [forward_cm, lateral_cm, turn_rad] =
                [learned.forward_cm, learned.lateral_cm, learned.turn_rad].map(f64::from);
            PoseIncrement { forward_cm, lateral_cm, turn_rad }
        };
        let increment = self.effects.wrap(&context, step);
        memory.history.was_at(Some(pose));
        memory.steps += 1;
        Motion {
            forward_cm: increment.forward_cm as f32,
            lateral_cm: increment.lateral_cm as f32,
            turn_rad: increment.turn_rad as f32,
            cells,
        }
    }

    /// Whether readings are generated here.
    pub fn senses(&self) -> bool {
        self.sonar.is_some()
    }

    /// The reading at `pose`, where the effects change the sensor; `draw` fixes what chance adds.
    pub fn echo_cm(&self, memory: &mut EffectMemory, pose: Pose, draw: f32) -> Option<f32> {
        let sonar = self.sonar?;
        let context = self.context(memory, pose);
        let state = self.effects.sensor(&context);
        let fan = self.surroundings.fan(&state.robot, state.yaw_rad, sonar.fan_width * state.width);
        let mut rng = generator(u64::from(draw.to_bits()), &[memory.steps as u64]);
        let outcomes = sonar.outcomes(&fan, &state.perturbation);
        let echo_cm = outcomes.draw(self.noise == Noise::Learned, || rng.random());
        memory.history.sensed(echo_cm);
        echo_cm.map(|cm| cm as f32)
    }

    fn context(&self, memory: &EffectMemory, pose: Pose) -> StepContext {
        self.surroundings.context(&memory.history, memory.steps as f64 * self.surroundings.robot.step_ms, pose)
    }
}
