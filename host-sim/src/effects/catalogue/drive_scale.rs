//! Both wheels cover more or less ground than commanded, by one factor.

use super::{each_command, parameters};
use crate::effects::parameter::Guesses;
use crate::effects::{Effect, Hook, Parameter, Variant};

pub const EFFECT: Effect = Effect {
    id: "drive_scale",
    name: "drive scale",
    what: "Both wheels cover more or less ground than commanded, by one factor: other tyres, another gear, another \
           battery.",
    check: "Command a straight metre and measure the way with a ruler; the wheel's diameter, measured with calipers, \
            should be the one in robot.toml.",
    variants: &[
        Variant {
            id: "distance",
            parameters: Scale::PARAMETERS,
            hooks: &[Hook::Motion(&|v, _, increment| increment.scale(Scale::read(v).factor))],
        },
        Variant {
            id: "command",
            parameters: Scale::PARAMETERS,
            hooks: &[Hook::Commands(&|v, _, commands| {
                let Scale { factor } = Scale::read(v);
                each_command(commands, |command, _| command * factor);
            })],
        },
    ],
};

parameters! {
    Scale {
        /// Factor on the distance covered. The two wheels that LEGO sells with the NXT, 43.2 and 56 mm, differ by 1.3;
        /// a regulated motor on a flat battery loses up to a third.
        factor: Parameter::new("", 1.0, [0.6, 1.5]).prior_sd(0.15).from(Guesses::At(&[1.03, 0.97])),
    }
}
