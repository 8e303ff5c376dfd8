//! Both wheels cover more or less ground than commanded, by one factor.

use super::drive::Drive;
use super::{each_command, parameters};
use crate::effects::parameter::{Guesses, Report};
use crate::effects::{Effect, Hook, Parameter, Place, Variant};

pub const EFFECT: Effect = Effect {
    id: "drive_scale",
    name: "drive scale",
    what: "Both wheels cover more or less ground than commanded, by one factor: other tyres, another gear, another \
           battery.",
    in_logs: "Forward motion and turns are off by one factor at all speeds.",
    imitated_by: &["saturation", "payload", "tracker_scale"],
    check: "Command a straight metre and measure the way with a ruler; the wheel's diameter, measured with calipers, \
            should be the one in robot.toml.",
    place: Some(Place::Wheel),
    needs_known_robot: false,
    variants: &[
        Variant {
            id: "distance",
            parameters: Scale::PARAMETERS,
            hooks: &[Hook::Motion(&|v, _, increment| *increment = increment.scaled(Scale::read(v).factor))],
        },
        Variant {
            id: "command",
            parameters: Scale::PARAMETERS,
            hooks: &[Hook::Commands(&|v, _, commands| {
                let Scale { factor } = Scale::read(v);
                each_command(commands, |command, _| command * factor);
            })],
        },
        Variant {
            id: "lever",
            parameters: LeverScale::PARAMETERS,
            hooks: &[
                Hook::Commands(&|v, context, commands| {
                    let LeverScale { factor, body_share } = LeverScale::read(v);
                    // A wheel that covers more ground per turn has less force, and moves more mass per turn.
                    if factor != 1.0 {
                        let loaded = Drive::loaded(factor * factor, body_share, context);
                        Drive::slower(0.0, 0.0, context).imitate(&loaded, commands);
                    }
                }),
                Hook::Motion(&|v, _, increment| *increment = increment.scaled(LeverScale::read(v).factor)),
            ],
        },
    ],
};

/// Factor on the distance covered. The two wheels that LEGO sells with the NXT, 43.2 and 56 mm, differ by 1.3; a regulated
/// motor on a flat battery loses up to a third, and a robot.toml with another gear is off by a factor of up to two.
const FACTOR: Parameter = Parameter::new("", 1.0, [0.5, 2.0]).prior_sd(0.2).from(Guesses::At(&[1.03, 0.97]));

parameters! {
    Scale {
        /// See [`FACTOR`].
        factor: FACTOR,
    }
}

parameters! {
    LeverScale {
        /// See [`FACTOR`].
        factor: FACTOR,
        /// Share of the drive's time constant that the robot's body makes; the motor's rotor makes the rest.
        body_share: Parameter::new("", 0.5, [0.0, 1.0]).prior_sd(0.3).report(Report::Hidden),
    }
}
