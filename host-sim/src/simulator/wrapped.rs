//! The simulator's step with added effects round it: what they change follows the run's past, so nothing of it can be
//! worked out ahead.

use glam::DVec2;
use rand::RngExt;

use super::motion::{Motion, MotionNetworks};
use super::{Noise, Simulator};
use crate::chance::generator;
use crate::effects::chain::EffectChain;
use crate::effects::effect::{self, CommandHistory};
use crate::geometry::{Pose, Wall, cast};
use crate::logs::{Robot, Scene};
use crate::problem::{Problem, Result};
use crate::sonar::{SonarModel, fan_at};

/// AppliedEffect effects in a room.
pub(super) struct Wrapped<'s> {
    effects: EffectChain,
    robot: Robot,
    commands: [f64; 2],
    sides: Vec<Wall>,
    middle_cm: DVec2,
    /// There when an effect changes the sensor.
    sonar: Option<&'s SonarModel>,
    noise: Noise,
}

/// What a run has behind it.
#[derive(Clone, Debug, Default)]
pub(super) struct Past {
    commands: CommandHistory,
    /// The poses before the present one, the latest first.
    poses: [Option<Pose>; 2],
    faced: Option<[f64; 2]>,
    /// The last reading, and whether there was one; none before the first.
    echo: Option<Option<f64>>,
    steps: usize,
}

impl<'s> Wrapped<'s> {
    /// The effects added to a simulator, if there are any.
    ///
    /// # Errors
    /// When an effect changes a sensor of which the simulator does not know what is normal.
    pub fn of(simulator: &'s Simulator, scene: &Scene, noise: Noise) -> Result<Option<Self>> {
        if simulator.added.is_empty() {
            return Ok(None);
        }
        let effects = EffectChain::of(&simulator.added);
        let reference = simulator.reference.as_ref().and_then(|r| r.sonar.as_ref());
        if effects.senses() && reference.is_none() {
            return Err(Problem::new(
                "an added effect changes the sonar, and the simulator does not know its usual beam",
            ));
        }
        let sides = scene.sides();
        Ok(Some(Wrapped {
            sonar: reference.filter(|_| effects.senses()),
            effects,
            robot: simulator.robot,
            commands: simulator.commands.map(f64::from),
            middle_cm: effect::middle(&sides),
            sides,
            noise,
        }))
    }

    /// What a step does with a robot at `pose` under `command`, before scatter.
    pub fn motion(&self, past: &mut Past, pose: Pose, command: [f32; 2], networks: &MotionNetworks) -> Motion {
        past.commands.rotate_right(1);
        past.commands[0] = command.map(f64::from);
        let moment = self.moment(past, pose);
        let mut cells = [0; 3];
        let step = |now: [f64; 2], before: [f64; 2]| {
            let [low, high] = self.commands;
            let learned = networks.step([now[0], now[1], before[0], before[1]].map(|c| c.clamp(low, high) as f32));
            cells = learned.cells;
            let [forward_cm, lateral_cm, turn_rad] =
                [learned.forward_cm, learned.lateral_cm, learned.turn_rad].map(f64::from);
            effect::PoseIncrement { forward_cm, lateral_cm, turn_rad }
        };
        let motion = self.effects.wrap(&moment, step);
        past.poses = [Some(pose), past.poses[0]];
        past.steps += 1;
        Motion {
            forward_cm: motion.forward_cm as f32,
            lateral_cm: motion.lateral_cm as f32,
            turn_rad: motion.turn_rad as f32,
            cells,
        }
    }

    /// Whether readings are made here.
    pub fn senses(&self) -> bool {
        self.sonar.is_some()
    }

    /// The reading at `pose`, where the effects change the sensor; `draw` fixes what chance adds.
    pub fn echo_cm(&self, past: &mut Past, pose: Pose, draw: f32) -> Option<f32> {
        let sonar = self.sonar?;
        let moment = self.moment(past, pose);
        let changed = self.effects.sensor(&moment);
        let mut axis = self.robot.ultrasonic.pose_on(&changed.robot);
        axis.heading_rad += changed.yaw_rad;
        let fan = fan_at(&self.sides, &axis, sonar.fan_width * changed.width);
        let mut rng = generator(u64::from(draw.to_bits()), &[past.steps as u64]);
        let outcomes = sonar.outcomes(&fan, &changed.change, past.echo.flatten());
        let echo_cm = outcomes.draw(self.noise == Noise::Learned, || rng.random());
        past.faced = moment.faced;
        past.echo = Some(echo_cm);
        echo_cm.map(|cm| cm as f32)
    }

    fn moment(&self, past: &Past, pose: Pose) -> effect::StepContext {
        let sensor = self.robot.ultrasonic.pose_on(&pose);
        let hit = cast(&self.sides, sensor.position_cm, sensor.direction());
        effect::StepContext {
            elapsed_min: past.steps as f64 * self.robot.step_ms / 60_000.0,
            commands: past.commands,
            pose,
            earlier: past.poses,
            faced: hit.map(|hit| [hit.distance_cm, hit.incidence_rad]),
            faced_before: past.faced,
            echo_before: past.echo.map(|echo| echo.is_some()),
            middle_cm: self.middle_cm,
            track_cm: self.robot.track_cm,
        }
    }
}
