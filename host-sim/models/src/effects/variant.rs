//! An effect as data: its id, its variants, their parameters and hooks.

use serde_json::{Map, Value};

use super::context::{CommandHistory, StepContext, Surroundings};
use super::parameter::Parameter;
use super::pose_increment::PoseIncrement;
use crate::sonar::{Outcomes, Perturbation, SensorLaw};
use mindgap_foundations::geometry::Pose;
use mindgap_logs::Robot;

/// Something that is there in reality and not in the simulator.
pub struct Effect {
    /// Its id in the table of docs/formats.md.
    pub id: &'static str,
    /// What people call it, without an article.
    pub name: &'static str,
    /// A sentence of what it is.
    pub what: &'static str,
    /// A sentence of how one checks it on the robot, with no more than a ruler, a scale, a film or a multimeter.
    pub check: &'static str,
    /// The functional forms in which it may show.
    pub variants: &'static [Variant],
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

/// A change to one stage of a step; parameters come in the order of [`Variant::parameters`].
pub enum Hook {
    /// To the commands that reach the motors, for every step of the history, by these commands alone.
    Commands(&'static (dyn Fn(&[f64], &StepContext, &mut CommandHistory) + Sync)),
    /// The same, by where and when too.
    CommandsHere(&'static (dyn Fn(&[f64], &StepContext, &mut CommandHistory) + Sync)),
    /// By how much the motion comes late.
    Delay(&'static (dyn Fn(&[f64], &StepContext) -> Late + Sync)),
    /// To the increment of the pose that the tracker sees, by this and commands alone.
    Motion(&'static (dyn Fn(&[f64], &StepContext, &mut PoseIncrement) + Sync)),
    /// The same, by where and when too.
    MotionHere(&'static (dyn Fn(&[f64], &StepContext, &mut PoseIncrement) + Sync)),
    /// To the sensor, by whether it heard an echo before and nothing else.
    Sensor(ChangeOfSensor),
    /// The same, by where and when too.
    SensorHere(ChangeOfSensor),
    /// To the textbook's ideal ray, as the first: what any real sensor has, and one that was learned from logs has already.
    Ray(ChangeOfSensor),
}

/// By how many steps the motion comes late, 0 and more.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Late {
    /// The drive, which does in a step what it would have done so much earlier.
    pub drive_steps: f64,
    /// The poses, which are told by rows and lie on straight lines between them.
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

impl Variant {
    /// The parameters with which it changes nothing.
    pub fn nominal(&self) -> Vec<f64> {
        self.parameters.iter().map(|p| p.nominal).collect()
    }

    /// Where fits start: all combinations of the parameters' guesses. `top_speed_cm_s` is the largest wheel speed that
    /// the logs command.
    pub fn initial_guesses(&self, top_speed_cm_s: f64) -> Vec<Vec<f64>> {
        self.parameters.iter().fold(vec![Vec::new()], |so_far, parameter| {
            let guesses = parameter.guesses(top_speed_cm_s);
            so_far.iter().flat_map(|start| guesses.iter().map(move |g| [start.as_slice(), &[*g]].concat())).collect()
        })
    }

    /// The parameters as the table of docs/formats.md names them.
    pub fn reported(&self, values: &[f64], robot: &Robot) -> Map<String, Value> {
        self.parameters.iter().zip(values).flat_map(|(p, value)| p.reported(*value, robot)).collect()
    }

    /// Between what the reported numbers lie, where the values lie between these ends.
    pub fn reported_between(&self, values: &[f64], ends: &[[f64; 2]], robot: &Robot) -> Map<String, Value> {
        let parameters = self.parameters.iter().zip(values).zip(ends);
        parameters.flat_map(|((p, value), ends)| p.reported_between(*value, *ends, robot)).collect()
    }

    /// Whether it changes what the robot does or how that is seen.
    pub fn moves(&self) -> bool {
        self.hooks.iter().any(|hook| hook.of_sensor().is_none())
    }

    /// Whether what it does to the motion follows from commands, wherever and whenever they are driven.
    pub fn moves_by_commands_alone(&self) -> bool {
        !self.hooks.iter().any(|hook| matches!(hook, Hook::CommandsHere(_) | Hook::MotionHere(_)))
    }

    /// Whether what it does to the sensor is the same wherever and whenever that is asked.
    pub fn senses_alike_everywhere(&self) -> bool {
        !self.hooks.iter().any(|hook| matches!(hook, Hook::SensorHere(_)))
    }

    /// Whether at these parameters all that it does at a step is to scatter readings more.
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

    /// Whether it is sought in the textbook's ideal ray alone.
    pub fn is_for_a_ray(&self) -> bool {
        self.hooks.iter().any(|hook| matches!(hook, Hook::Ray(_)))
    }

    /// Whether it changes what the sensor says.
    pub fn senses(&self) -> bool {
        self.hooks.iter().any(|hook| hook.of_sensor().is_some())
    }
}

impl Hook {
    /// What it changes of the sensor, if it is a change to that.
    pub fn of_sensor(&self) -> Option<ChangeOfSensor> {
        match self {
            Hook::Sensor(change) | Hook::SensorHere(change) | Hook::Ray(change) => Some(*change),
            Hook::Commands(_) | Hook::CommandsHere(_) | Hook::Delay(_) | Hook::Motion(_) | Hook::MotionHere(_) => None,
        }
    }
}

impl SensorState {
    /// The sensor of a robot at `robot` that no effect changes.
    pub fn nominal(robot: Pose) -> Self {
        SensorState { robot, yaw_rad: 0.0, perturbation: Perturbation::NONE }
    }

    /// What it may report by a law, where it is.
    pub fn outcomes(&self, law: &SensorLaw, surroundings: &Surroundings) -> Outcomes {
        let sensor = surroundings.sensor(&self.robot, self.yaw_rad);
        law.outcomes(&law.view(&surroundings.surfaces, &sensor, self.perturbation.width), &self.perturbation)
    }
}
