//! A simulated robot that is driven by the millisecond: for programs whose steps are their own.
//!
//! The motion networks say what a step of the simulator does. A command begins a step, which goes on in steps of the
//! simulator until the next command; a part of a step does that share of it.

use mindgap_core::folded::evaluate_all;
use rand::RngExt;

use super::Noise;
use super::effect_layer::EffectMemory;
use super::environment::Environment;
use super::motion::Motion;
use super::residuals::LEVELS;
use mindgap_foundations::geometry::{Pose, Wall, cast};
use mindgap_foundations::random::Generator;
use mindgap_logs::Scene;

/// Time between two looks whether the body touches something.
const TOUCH_MS: f64 = 5.0;

/// A simulated robot during a run.
pub struct SimulatedBody<'e> {
    environment: &'e Environment<'e>,
    sides: Vec<Wall>,
    pose: Pose,
    command: [f64; 2],
    /// The command before, while the step in which that still counts goes on.
    before: [f64; 2],
    step: Option<Step>,
    held_levels: [usize; 3],
    memory: EffectMemory,
    crashed: bool,
}

/// A step of the simulator that is under way.
struct Step {
    from: Pose,
    /// Way forward and to the left (cm) and turn to the left (rad) of the whole step.
    motion: [f64; 3],
    passed_ms: f64,
}

impl<'e> SimulatedBody<'e> {
    /// A robot at rest at the start of its environment.
    pub fn at_rest(environment: &'e Environment<'e>, scene: &Scene) -> Self {
        SimulatedBody {
            environment,
            sides: scene.sides(),
            pose: environment.start,
            command: [0.0, 0.0],
            before: [0.0, 0.0],
            step: None,
            held_levels: [0; 3],
            memory: EffectMemory::default(),
            crashed: false,
        }
    }

    /// Applies left and right command, -100..=100, for a duration. A robot that touches something stays there.
    pub fn drive(&mut self, command: [f64; 2], duration_ms: f64, rng: &mut Generator) {
        if command != self.command {
            self.before = std::mem::replace(&mut self.command, command);
            self.step = None;
            self.held_levels = std::array::from_fn(|_| rng.random_range(0..LEVELS));
        }
        let step_ms = self.environment.robot.step_ms;
        let mut left_ms = duration_ms;
        while left_ms > 0.0 && !self.crashed {
            let mut step = self.step.take().unwrap_or_else(|| self.begin(rng));
            let passed_ms = TOUCH_MS.min(left_ms).min(step_ms - step.passed_ms);
            step.passed_ms += passed_ms;
            left_ms -= passed_ms;
            let [forward_cm, lateral_cm, turn_rad] = step.motion.map(|whole| whole * step.passed_ms / step_ms);
            self.pose = step.from.compose(&Pose::new(forward_cm, lateral_cm, turn_rad));
            self.crashed = self.touches();
            if step.passed_ms < step_ms {
                self.step = Some(step);
            } else {
                self.before = command;
            }
        }
    }

    /// One reading of the ultrasonic sensor, cm; `None` if it produced no value.
    pub fn read_sonar(&mut self, rng: &mut Generator) -> Option<f64> {
        let environment = self.environment;
        let sonar = &environment.robot.ultrasonic;
        let range = |cm: f64| cm.clamp(sonar.min_cm, sonar.max_cm);
        if let Some(effects) = environment.effect_layer.as_ref().filter(|effects| effects.senses()) {
            return effects.echo_cm(&mut self.memory, self.pose, rng.random()).map(|cm| range(cm.into()));
        }
        let sensor = sonar.pose_on(&self.pose);
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

    /// Where it is.
    pub fn pose(&self) -> Pose {
        self.pose
    }

    /// Whether the body has touched a wall or an obstacle.
    pub fn crashed(&self) -> bool {
        self.crashed
    }

    fn begin(&mut self, rng: &mut Generator) -> Step {
        // A robot that stands goes on to stand: no log says so, since none is of a robot that is not driven.
        if [self.command, self.before] == [[0.0; 2]; 2] {
            return Step { from: self.pose, motion: [0.0; 3], passed_ms: 0.0 };
        }
        let environment = self.environment;
        let command = self.command.map(|c| c as f32);
        let Motion { forward_cm, lateral_cm, turn_rad, cells } = match &environment.effect_layer {
            Some(effects) => {
                effects.motion(&mut self.memory, self.pose, command, |speeds| environment.motion.trained_step(speeds))
            }
            None => {
                let before = self.before.map(|c| c as f32);
                environment.motion.step([command[0], command[1], before[0], before[1]])
            }
        };
        let mut motion = [forward_cm, lateral_cm, turn_rad].map(f64::from);
        if environment.noise == Noise::Learned {
            for (axis, sum) in motion.iter_mut().enumerate() {
                let level = rng.random_range(0..LEVELS);
                let noise = &environment.motion_noise[axis];
                *sum += f64::from(noise.residual(cells[axis], level, self.held_levels[axis], [1.0; 2]));
            }
        }
        Step { from: self.pose, motion, passed_ms: 0.0 }
    }

    fn touches(&self) -> bool {
        let at_cm = self.pose.position_cm;
        self.sides.iter().any(|side| side.nearest(at_cm).distance(at_cm) < self.environment.robot.body_radius_cm)
    }
}
