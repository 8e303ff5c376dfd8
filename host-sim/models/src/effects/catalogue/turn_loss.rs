//! Forward speed is lost in turns, on both wheels alike.

use super::{LOADED_SPEED_CM_S, parameters, pushed_cm};
use crate::effects::parameter::{Guesses, Report};
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
        Variant {
            id: "dry",
            parameters: DryTurnLoss::PARAMETERS,
            hooks: &[Hook::Motion(&|v, context, increment| {
                let DryTurnLoss { cm_per_rad, most_from_rad_s } = DryTurnLoss::read(v);
                let most_from_rad = most_from_rad_s * context.step_s();
                let lost_cm = cm_per_rad * most_from_rad * up_to_one(increment.turn_rad.abs() / most_from_rad);
                increment.forward_cm = pushed_cm(increment.forward_cm, -lost_cm, context);
            })],
        },
    ],
};

/// Way lost for each radian of turn; of the second variant at [the loaded speed](LOADED_SPEED_CM_S). A Create loses 7 cm. A
/// robot that loses half its track could not turn about a standing wheel, and no small robot's track is wider than 30 cm.
const CM_PER_RAD: Parameter = Parameter::new("cm/rad", 0.0, [0.0, 15.0]).prior_sd(4.0).from(Guesses::At(&[1.0, 4.0]));

parameters! {
    TurnLoss {
        /// See [`CM_PER_RAD`].
        cm_per_rad: CM_PER_RAD,
    }
}

parameters! {
    DryTurnLoss {
        /// In turns slower than the rate below; see [`CM_PER_RAD`].
        cm_per_rad: CM_PER_RAD,
        /// Rate of turn from which on what drags rubs with all that rests on it, as dry friction does.
        most_from_rad_s: Parameter::new("rad/s", 2.0, [0.3, 8.0]).prior_sd(2.0).report(Report::Hidden),
    }
}

/// The number where it is small, and one where it is large; rounded between, since a robot does not turn alike all through a
/// step.
fn up_to_one(x: f64) -> f64 {
    x / libm::sqrt(libm::sqrt(1.0 + x * x * x * x))
}
