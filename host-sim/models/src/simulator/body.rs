//! A simulated robot with millisecond resolution, for programs that have their own step length.
//!
//! The motion networks predict steps of the simulator. A command starts a step, and further ones follow until the next
//! command; a fraction of a step makes that fraction of its motion.

use mindgap_core::folded::evaluate_all;
use rand::RngExt;

use super::Noise;
use super::effect_layer::EffectMemory;
use super::environment::Environment;
use super::motion::PredictedStep;
use super::residuals::LEVELS;
use mindgap_foundations::geometry::{Pose, Wall, cast};
use mindgap_foundations::motion::{Axis, Motion};
use mindgap_foundations::random::Generator;
use mindgap_logs::Scene;

/// Time between two collision checks.
const TOUCH_MS: f64 = 5.0;

/// A simulated robot during a run.
pub struct SimulatedBody<'e> {
    environment: &'e Environment<'e>,
    sides: Vec<Wall>,
    state: BodyState,
}

/// The state of a simulated robot, which outlives its environment: a later one of the same simulator, scene and start resumes
/// the run.
#[derive(Clone, Debug)]
pub struct BodyState {
    pose: Pose,
    command: [f64; 2],
    /// The previous command, during the first step after a change.
    before: [f64; 2],
    step: Option<Step>,
    held_levels: Motion<usize>,
    memory: EffectMemory,
    crashed: bool,
}

/// A step of the simulator in progress.
#[derive(Clone, Debug)]
struct Step {
    from: Pose,
    /// The motion of the whole step.
    motion: Motion<f64>,
    passed_ms: f64,
}

impl BodyState {
    /// Returns the state of a robot at rest.
    pub fn at_rest(pose: Pose) -> Self {
        BodyState {
            pose,
            command: [0.0, 0.0],
            before: [0.0, 0.0],
            step: None,
            held_levels: Motion::splat(0),
            memory: EffectMemory::default(),
            crashed: false,
        }
    }

    /// Returns the pose.
    pub fn pose(&self) -> Pose {
        self.pose
    }

    /// Returns whether the body has touched a wall or an obstacle.
    pub fn crashed(&self) -> bool {
        self.crashed
    }
}

impl<'e> SimulatedBody<'e> {
    /// Returns a robot at rest at the start of its environment.
    pub fn at_rest(environment: &'e Environment<'e>, scene: &Scene) -> Self {
        SimulatedBody::resumed(environment, scene, BodyState::at_rest(environment.start))
    }

    /// Returns a robot in this state.
    pub fn resumed(environment: &'e Environment<'e>, scene: &Scene, state: BodyState) -> Self {
        SimulatedBody { environment, sides: scene.sides(), state }
    }

    /// Returns its state.
    pub fn into_state(self) -> BodyState {
        self.state
    }

    /// Applies left and right command, -100..=100, for a duration. A robot that touches something stays there.
    pub fn drive(&mut self, command: [f64; 2], duration_ms: f64, rng: &mut Generator) {
        if command != self.state.command {
            self.state.before = std::mem::replace(&mut self.state.command, command);
            self.state.step = None;
            self.state.held_levels = Motion::from_fn(|_| rng.random_range(0..LEVELS));
        }
        let step_ms = self.environment.robot.step_ms;
        let mut left_ms = duration_ms;
        while left_ms > 0.0 && !self.state.crashed {
            let mut step = self.state.step.take().unwrap_or_else(|| self.begin(rng));
            let passed_ms = TOUCH_MS.min(left_ms).min(step_ms - step.passed_ms);
            step.passed_ms += passed_ms;
            left_ms -= passed_ms;
            self.state.pose = step.motion.map(|whole| whole * step.passed_ms / step_ms).end(&step.from);
            self.state.crashed = self.touches();
            if step.passed_ms < step_ms {
                self.state.step = Some(step);
            } else {
                self.state.before = command;
            }
        }
    }

    /// One reading of the ultrasonic sensor, cm; `None` if it produced no value.
    pub fn read_sonar(&mut self, rng: &mut Generator) -> Option<f64> {
        let environment = self.environment;
        let mount = &environment.mount;
        let range = |cm: f64| cm.clamp(mount.min_cm, mount.max_cm);
        if let Some(effects) = environment.effect_layer.as_ref().filter(|effects| effects.senses()) {
            return effects.echo_cm(&mut self.state.memory, self.state.pose, rng.random()).map(|cm| range(cm.into()));
        }
        let sensor = mount.pose_on(&self.state.pose);
        let faced = cast(&self.sides, sensor.position_cm, sensor.direction())?;
        let context = [faced.distance_cm as f32, faced.incidence_rad.abs().to_degrees() as f32];
        let [probability, mut reading_cm] = evaluate_all(&environment.sonar, context);
        if rng.random::<f32>() >= probability {
            return None;
        }
        if environment.noise == Noise::Learned {
            reading_cm += environment.echo_residuals.residual(context, rng.random_range(0..LEVELS));
            if let Some(constant) = environment.constant_reading.filter(|c| rng.random::<f32>() < c.probability) {
                reading_cm = constant.value_cm;
            }
        }
        Some(range(reading_cm.into()))
    }

    /// Returns its pose.
    pub fn pose(&self) -> Pose {
        self.state.pose
    }

    /// Returns whether the body has touched a wall or an obstacle.
    pub fn crashed(&self) -> bool {
        self.state.crashed
    }

    fn begin(&mut self, rng: &mut Generator) -> Step {
        // A robot at rest stays at rest: logs do not show it, since they hold driven robots only.
        if [self.state.command, self.state.before] == [[0.0; 2]; 2] {
            return Step { from: self.state.pose, motion: Motion::ZERO, passed_ms: 0.0 };
        }
        let environment = self.environment;
        let command = self.state.command.map(|c| c as f32);
        let PredictedStep { motion, cells } = match &environment.effect_layer {
            Some(effects) => effects.motion(&mut self.state.memory, self.state.pose, command, |speeds| {
                environment.motion.trained_step(speeds)
            }),
            None => {
                let before = self.state.before.map(|c| c as f32);
                environment.motion.step([command[0], command[1], before[0], before[1]])
            }
        };
        let mut motion = motion.map(f64::from);
        if environment.noise == Noise::Learned {
            for axis in Axis::ALL {
                let level = rng.random_range(0..LEVELS);
                let noise = &environment.motion_noise[axis];
                motion[axis] += f64::from(noise.residual(cells[axis], level, self.state.held_levels[axis], [1.0; 2]));
            }
        }
        Step { from: self.state.pose, motion, passed_ms: 0.0 }
    }

    fn touches(&self) -> bool {
        let at_cm = self.state.pose.position_cm;
        self.sides.iter().any(|side| side.nearest(at_cm).distance(at_cm) < self.environment.robot.body_radius_cm)
    }
}
