//! Forward speed is lost in turns, on both wheels alike.

use super::{LOADED_SPEED_CM_S, parameters, pushed_cm};
use crate::effects::parameter::Guesses;
use crate::effects::{Effect, Hook, Parameter, Variant};

pub const EFFECT: Effect = Effect {
    id: "turn_loss",
    name: "loss of way in turns",
    what: "Both wheels lose way in turns, more the sharper the turn is.",
    check: "Command an arc of one metre and a straight metre, and measure both with a string along the track.",
    variants: &[
        Variant {
            id: "at_any_speed",
            parameters: TurnLoss::PARAMETERS,
            hooks: &[Hook::Motion(&|v, context, increment| {
                let lost_cm = TurnLoss::read(v).cm_per_rad * increment.turn_rad.abs();
                increment.forward_cm = pushed_cm(increment.forward_cm, -lost_cm, context);
            })],
        },
        Variant {
            id: "with_speed",
            parameters: TurnLoss::PARAMETERS,
            hooks: &[Hook::Motion(&|v, context, increment| {
                let speed = increment.forward_cm.abs() / (LOADED_SPEED_CM_S * context.step_s());
                let lost_cm = TurnLoss::read(v).cm_per_rad * increment.turn_rad.abs() * speed;
                increment.forward_cm = pushed_cm(increment.forward_cm, -lost_cm, context);
            })],
        },
    ],
};

parameters! {
    TurnLoss {
        /// Way lost for each radian of turn; of the second variant at [the loaded speed](LOADED_SPEED_CM_S). A Create loses
        /// 7 cm. A robot that loses half its track could not turn about a standing wheel, and no small robot's track is
        /// wider than 30 cm.
        cm_per_rad: Parameter::new("cm/rad", 0.0, [0.0, 15.0]).prior_sd(4.0).from(Guesses::At(&[1.0, 4.0])),
    }
}
