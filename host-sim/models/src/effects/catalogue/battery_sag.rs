//! The drive gets weaker during the run.

use super::{each_command, parameters};
use crate::effects::parameter::Guesses;
use crate::effects::{Effect, Hook, Parameter, Place, StepContext, Variant};

pub const EFFECT: Effect = Effect {
    id: "battery_sag",
    name: "battery sag",
    what: "The drive gets weaker during the run, as it does on a battery that empties.",
    in_logs: "Steps agree at the start of a run and get shorter with time, on both wheels alike.",
    imitated_by: &["drive_scale", "payload"],
    check: "Measure the battery's voltage under load with a multimeter before and after a run; then drive straight \
            for one second with it full and with it used, and compare both ways with a ruler.",
    place: Some(Place::Motor),
    needs_known_robot: false,
    variants: &[
        Variant {
            id: "command",
            parameters: Sag::PARAMETERS,
            hooks: &[Hook::CommandsHere(&|v, context, commands| {
                let left = Sag::read(v).left(context);
                each_command(commands, |command, _| command * left);
            })],
        },
        Variant {
            id: "distance",
            parameters: Sag::PARAMETERS,
            hooks: &[Hook::MotionHere(&|v, context, increment| {
                *increment = increment.scaled(Sag::read(v).left(context))
            })],
        },
    ],
};

parameters! {
    Sag {
        /// Share of speed lost per minute. A pack of six AA cells goes from 9 V to 7.2 V over its whole discharge, and
        /// speed is proportional to voltage; 0.9 is a pack that is empty after little more than a minute.
        loss_per_min: Parameter::new("1/min", 0.0, [0.0, 0.9]).prior_sd(0.4).from(Guesses::At(&[0.05, 0.25, 0.6])),
    }
}

impl Sag {
    /// The share of speed that is left.
    fn left(&self, context: &StepContext) -> f64 {
        (1.0 - self.loss_per_min * context.elapsed_min).max(0.0)
    }
}
