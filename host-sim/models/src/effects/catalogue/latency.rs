//! Commands take effect late.

use super::parameters;
use crate::effects::context::HISTORY;
use crate::effects::parameter::Guesses;
use crate::effects::{Effect, Hook, Late, Parameter, StepContext, Variant};

pub const EFFECT: Effect = Effect {
    id: "latency",
    name: "latency",
    what: "Commands take effect late, by a fixed time.",
    check: "Film the robot together with the screen that sends the command, and count the frames from the command to \
            the first motion.",
    needs_known_robot: false,
    variants: &[
        Variant {
            id: "delay",
            parameters: Latency::PARAMETERS,
            hooks: &[Hook::Commands(&|v, context, commands| {
                // The command before holds for the first part of the step; what it did to the wheels is over by then.
                let steps = late_steps(v, context);
                let (whole, part) = (steps as usize, steps % 1.0);
                commands.rotate_left(whole);
                let [now, before, ..] = commands;
                *now = [0, 1].map(|m| (1.0 - part) * now[m] + part * before[m]);
            })],
        },
        Variant {
            id: "drive_delay",
            parameters: Latency::PARAMETERS,
            hooks: &[Hook::Delay(&|v, context| Late { drive_steps: late_steps(v, context), ..Late::default() })],
        },
        Variant {
            id: "pose_delay",
            parameters: Latency::PARAMETERS,
            hooks: &[Hook::Delay(&|v, context| Late { poses_steps: late_steps(v, context), ..Late::default() })],
        },
    ],
};

fn late_steps(values: &[f64], context: &StepContext) -> f64 {
    (Latency::read(values).ms / context.robot.step_ms).min((HISTORY - 2) as f64)
}

parameters! {
    Latency {
        /// Delay between a command and the wheels. A Bluetooth link to a brick takes 28 to 77 ms there and back, a camera's
        /// frames as much again; nobody steers a robot that is most of a second behind.
        ms: Parameter::new("ms", 0.0, [0.0, 800.0]).prior_sd(200.0).from(Guesses::At(&[40.0, 160.0, 360.0])),
    }
}
