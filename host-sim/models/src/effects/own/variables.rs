//! The names that an expression may use: everything that is known of a step, with its unit.

use crate::effects::StepContext;
use mindgap_foundations::motion::Motion;

/// What an expression changes, which decides what it may look at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// A command.
    Command,
    /// The motion of a step.
    Motion,
    /// A reading.
    Reading,
    /// Whether an echo comes back.
    Echo,
}

/// What is known where an expression is evaluated.
pub struct Circumstances<'a> {
    /// The step, or the row at its beginning.
    pub step: &'a StepContext,
    /// Left and right command, now and before.
    pub commands: [[f64; 2]; 2],
    /// The motion that is predicted, as the effects before this one leave it.
    pub increment: Motion<f64>,
    /// The reading.
    pub echo_cm: f64,
}

/// A name and what it stands for.
pub struct Variable {
    /// Its name.
    pub name: &'static str,
    stages: &'static [Stage],
    /// Its value, where it is known.
    pub value: fn(&Circumstances) -> Option<f64>,
}

use Stage::{Command, Echo, Reading};

const ALWAYS: &[Stage] = &[Command, Stage::Motion, Reading, Echo];
/// A reading is made between two steps, where no one command is at work.
const DRIVING: &[Stage] = &[Command, Stage::Motion];

const fn variable(name: &'static str, stages: &'static [Stage], value: fn(&Circumstances) -> Option<f64>) -> Variable {
    Variable { name, stages, value }
}

/// All variables, as docs/reference/own-effects.md lists them.
pub static VARIABLES: &[Variable] = &[
    variable("left", DRIVING, |at| Some(at.commands[0][0])),
    variable("right", DRIVING, |at| Some(at.commands[0][1])),
    variable("previous_left", DRIVING, |at| Some(at.commands[1][0])),
    variable("previous_right", DRIVING, |at| Some(at.commands[1][1])),
    variable("v_cm_s", DRIVING, |at| Some(at.speed_cm_s(0))),
    variable("w_rad_s", DRIVING, |at| Some(at.turn_rate_rad_s(0))),
    variable("previous_v_cm_s", DRIVING, |at| Some(at.speed_cm_s(1))),
    variable("previous_w_rad_s", DRIVING, |at| Some(at.turn_rate_rad_s(1))),
    variable("forward_cm", &[Stage::Motion], |at| Some(at.increment.forward)),
    variable("lateral_cm", &[Stage::Motion], |at| Some(at.increment.lateral)),
    variable("turn_rad", &[Stage::Motion], |at| Some(at.increment.turn)),
    variable("echo_cm", &[Reading], |at| Some(at.echo_cm)),
    variable("elapsed_min", ALWAYS, |at| Some(at.step.elapsed_min)),
    variable("x_cm", ALWAYS, |at| Some(at.step.pose.position_cm.x)),
    variable("y_cm", ALWAYS, |at| Some(at.step.pose.position_cm.y)),
    variable("heading_rad", ALWAYS, |at| Some(at.step.pose.heading_rad)),
    variable("middle_x_cm", ALWAYS, |at| Some(at.step.middle_cm.x)),
    variable("middle_y_cm", ALWAYS, |at| Some(at.step.middle_cm.y)),
    variable("distance_cm", ALWAYS, |at| at.step.faced.map(|faced| faced[0])),
    variable("incidence_rad", ALWAYS, |at| at.step.faced.map(|faced| faced[1])),
    variable("previous_echo", ALWAYS, |at| at.step.echo_before.map(|echo| f64::from(u8::from(echo)))),
    variable("full_speed_cm_s", ALWAYS, |at| Some(at.step.robot.full_speed_cm_s)),
    variable("track_cm", ALWAYS, |at| Some(at.step.robot.track_cm)),
    variable("wheel_diameter_cm", ALWAYS, |at| Some(at.step.robot.wheel_diameter_cm)),
    variable("step_s", ALWAYS, |at| Some(at.step.step_s())),
];

impl Variable {
    /// The variables of a stage.
    pub fn known_in(stage: Stage) -> impl Iterator<Item = &'static Variable> {
        VARIABLES.iter().filter(move |variable| variable.stages.contains(&stage))
    }
}

impl<'a> Circumstances<'a> {
    /// Of a step.
    pub fn of_step(step: &'a StepContext, increment: Motion<f64>) -> Self {
        Circumstances { step, commands: [step.commands[0], step.commands[1]], increment, echo_cm: 0.0 }
    }

    /// Of the row at which a step begins.
    pub fn of_row(step: &'a StepContext, echo_cm: f64) -> Self {
        Circumstances { echo_cm, ..Circumstances::of_step(step, Motion::ZERO) }
    }

    /// The speed that commands ask for.
    fn speed_cm_s(&self, ago: usize) -> f64 {
        let [left, right] = self.commands[ago];
        self.step.wheel_speed_cm_s(0.5 * (left + right))
    }

    /// The turn rate that commands ask for.
    fn turn_rate_rad_s(&self, ago: usize) -> f64 {
        let [left, right] = self.commands[ago];
        self.step.wheel_speed_cm_s(right - left) / self.step.robot.track_cm
    }
}
