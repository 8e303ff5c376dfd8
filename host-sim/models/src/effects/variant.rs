//! An effect as data: its id, its variants, their parameters and hooks.

use schemars::JsonSchema;
use serde::Serialize;
use serde_json::{Map, Value};

use super::context::{CommandHistory, StepContext, Surroundings};
use super::drive_filter::DriveFilter;
use super::parameter::{ACTS_ON, Parameter, Settings};
use crate::sonar::{Outcomes, Perturbation, SensorLaw};
use mindgap_foundations::geometry::Pose;
use mindgap_foundations::motion::Motion;
use mindgap_logs::Robot;

/// Something that is present in reality and missing from the simulator.
pub struct Effect {
    /// Its id in the table of docs/reference/catalogue.md.
    pub id: &'static str,
    /// What people call it, without an article.
    pub name: &'static str,
    /// What it is, in one sentence.
    pub what: &'static str,
    /// A sentence about the residuals that it leaves in logs; empty for a user's own effect.
    pub in_logs: &'static str,
    /// Ids of the effects that leave similar residuals.
    pub imitated_by: &'static [&'static str],
    /// How to check it on the robot, with no more than a ruler, scales, a video or a multimeter.
    pub check: &'static str,
    /// Where in the robot it sits; not known of a user's own effect.
    pub place: Option<Place>,
    /// Whether it is a change of a robot that was known without it. Against a textbook it does not compete.
    pub needs_known_robot: bool,
    /// The functional forms in which it may show.
    pub variants: &'static [Variant],
}

/// Where in the robot a cause sits, in the order in which a command passes through.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Place {
    /// Between the program and the motors.
    Link,
    /// In the motors and their control.
    Motor,
    /// At the rims.
    Wheel,
    /// Between wheels and floor.
    Ground,
    /// In the body that the wheels move.
    Body,
    /// In what tracks the robot.
    Tracker,
    /// In the range sensor.
    Sensor,
}

/// One functional form of an effect.
pub struct Variant {
    /// Unique among the variants of its effect, and stable: users' files hold it.
    pub id: &'static str,
    /// What is fitted.
    pub parameters: &'static [Parameter],
    /// What it changes.
    pub hooks: &'static [Hook],
}

/// A change to the sensor at a row, by parameters and circumstances.
pub type ChangeOfSensor = &'static (dyn Fn(&[f64], &StepContext, &mut SensorState) + Sync);

/// Changes the motion of a step, given the values of the parameters and the step's context.
pub type MotionHook = dyn Fn(&[f64], &StepContext, &mut Motion<f64>) + Sync;

/// A change to one stage of a step; parameters come in the order of [`Variant::parameters`].
pub enum Hook {
    /// To the commands that reach the motors, for every step of the history, by these commands alone.
    Commands(&'static (dyn Fn(&[f64], &StepContext, &mut CommandHistory) + Sync)),
    /// The same, by where and when too.
    CommandsHere(&'static (dyn Fn(&[f64], &StepContext, &mut CommandHistory) + Sync)),
    /// A dead time in the filter between commands and wheel speeds, steps.
    DeadTime(&'static (dyn Fn(&[f64]) -> f64 + Sync)),
    /// To that filter otherwise.
    Filter(&'static (dyn Fn(&[f64], &mut DriveFilter) + Sync)),
    /// Delays the motion.
    Delay(&'static (dyn Fn(&[f64]) -> Late + Sync)),
    /// A first-order lag of the heading that the tracker sees, steps.
    HeadingLag(&'static (dyn Fn(&[f64]) -> f64 + Sync)),
    /// To the motion that the tracker sees, by this and commands alone.
    Motion(&'static MotionHook),
    /// The same, by where and when too.
    MotionHere(&'static MotionHook),
    /// To the sensor, by whether it heard an echo before and nothing else.
    Sensor(ChangeOfSensor),
    /// The same, by where and when too.
    SensorHere(ChangeOfSensor),
    /// To the textbook's ideal ray, as the first: what any real sensor has, and one that was learned from logs has already.
    Ray(ChangeOfSensor),
}

/// Delay of the motion in steps, at least 0.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Late {
    /// Delay of the drive.
    pub drive_steps: f64,
    /// Delay of the tracked poses, which are interpolated linearly between rows.
    pub poses_steps: f64,
}

/// The sensor at a row, as effects leave it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SensorState {
    /// Where the robot is when the reading is made.
    pub robot: Pose,
    /// Rotation of the sensor's axis to the left of where it is mounted.
    pub yaw_rad: f64,
    /// How the sensor itself differs, and what becomes of the echoes.
    pub perturbation: Perturbation,
}

impl Effect {
    /// Returns whether it may sit there; a user's own effect may, if it changes the same.
    pub fn may_sit_in(&self, place: Place) -> bool {
        let senses_only = || self.variants.iter().all(|variant| variant.senses() && !variant.moves());
        self.place.map_or_else(|| senses_only() == (place == Place::Sensor), |own| own == place)
    }
}

impl Variant {
    /// Returns the values at which it changes nothing.
    pub fn nominal(&self) -> Vec<f64> {
        self.parameters.iter().map(|p| p.nominal).collect()
    }

    /// Returns where fits start: all combinations of the parameters' guesses. `top_speed` is the largest wheel speed
    /// that the logs command, as a share of the reference speed.
    pub fn initial_guesses(&self, top_speed: f64) -> Vec<Vec<f64>> {
        self.parameters.iter().fold(vec![Vec::new()], |so_far, parameter| {
            let guesses = parameter.guesses(top_speed);
            so_far.iter().flat_map(|start| guesses.iter().map(move |g| [start.as_slice(), &[*g]].concat())).collect()
        })
    }

    /// Returns its settings at these values, as files hold them.
    pub fn settings(&self, values: &[f64], robot: &Robot) -> Settings {
        let settings = self.parameters.iter().zip(values).flat_map(|(p, value)| p.settings(*value, robot));
        settings.map(|(name, setting)| (name.into(), setting)).collect()
    }

    /// Returns the values of settings, if these are the variant's and no others, and each is possible.
    pub fn values(&self, settings: &Settings, robot: &Robot) -> Option<Vec<f64>> {
        let values = self.parameters.iter().map(|p| p.value(settings, robot)).collect::<Option<Vec<f64>>>()?;
        let count: usize = self.parameters.iter().map(|p| 1 + usize::from(p.setting().1)).sum();
        let named = settings.keys().filter(|name| *name != ACTS_ON).count();
        (count == named).then_some(values)
    }

    /// Returns the parameters as the table of docs/reference/effects.md names them.
    pub fn reported(&self, values: &[f64], robot: &Robot) -> Map<String, Value> {
        self.parameters.iter().zip(values).flat_map(|(p, value)| p.reported(*value, robot)).collect()
    }

    /// Returns whether it changes the motion or how that is tracked.
    pub fn moves(&self) -> bool {
        self.hooks.iter().any(|hook| hook.of_sensor().is_none())
    }

    /// Returns whether its influence on the motion depends on commands alone, not on place or time.
    pub fn moves_by_commands_alone(&self) -> bool {
        !self.hooks.iter().any(|hook| matches!(hook, Hook::CommandsHere(_) | Hook::MotionHere(_)))
    }

    /// Returns whether its influence on the sensor is the same at every place and time.
    pub fn senses_alike_everywhere(&self) -> bool {
        !self.hooks.iter().any(|hook| matches!(hook, Hook::SensorHere(_)))
    }

    /// Returns whether at these values it only widens the scatter of readings.
    pub fn only_widens_scatter(&self, values: &[f64], step: &StepContext) -> bool {
        let mut state = SensorState::nominal(step.pose);
        for hook in self.hooks {
            if let Some(change) = hook.of_sensor() {
                change(values, step, &mut state);
            }
        }
        let widened = state.perturbation.scatter_cm > 0.0;
        state.perturbation.scatter_cm = 0.0;
        widened && state == SensorState::nominal(step.pose) && !self.moves()
    }

    /// Returns whether it is a candidate only for the textbook's ideal ray.
    pub fn is_for_a_ray(&self) -> bool {
        self.hooks.iter().any(|hook| matches!(hook, Hook::Ray(_)))
    }

    /// Returns whether it delays commands in the filter. Networks that answer within a step contain the drive's lag, which a
    /// delay has to shift with the command and a filter before them cannot.
    pub fn delays_in_the_filter(&self) -> bool {
        self.hooks.iter().any(|hook| matches!(hook, Hook::DeadTime(_)))
    }

    /// Returns whether it changes the sensor.
    pub fn senses(&self) -> bool {
        self.hooks.iter().any(|hook| hook.of_sensor().is_some())
    }
}

impl Hook {
    /// Returns its change to the sensor, if it is one.
    pub fn of_sensor(&self) -> Option<ChangeOfSensor> {
        match self {
            Hook::Sensor(change) | Hook::SensorHere(change) | Hook::Ray(change) => Some(*change),
            Hook::Commands(_)
            | Hook::CommandsHere(_)
            | Hook::DeadTime(_)
            | Hook::Filter(_)
            | Hook::Delay(_)
            | Hook::HeadingLag(_)
            | Hook::Motion(_)
            | Hook::MotionHere(_) => None,
        }
    }
}

impl SensorState {
    /// Returns the sensor of a robot at `robot` without effects.
    pub fn nominal(robot: Pose) -> Self {
        SensorState { robot, yaw_rad: 0.0, perturbation: Perturbation::NONE }
    }

    /// Returns the possible readings by a law, at its place.
    pub fn outcomes(&self, law: &SensorLaw, surroundings: &Surroundings) -> Outcomes {
        let sensor = surroundings.sensor(&self.robot, self.yaw_rad);
        law.outcomes(&law.view(&surroundings.surfaces, &sensor, self.perturbation.width), &self.perturbation)
    }
}
