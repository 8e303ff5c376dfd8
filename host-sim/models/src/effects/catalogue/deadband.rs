//! Friction in the drive: small commands move little or nothing.

use super::drive::Drive;
use super::{each_command, each_wheel, parameters};
use crate::effects::parameter::{Guesses, Report};
use crate::effects::scales::DEADBAND_EDGE;
use crate::effects::{Effect, Hook, Parameter, Place, Variant};

pub const EFFECT: Effect = Effect {
    id: "deadband",
    name: "deadband",
    what: "Friction in the drive keeps it from moving at small commands.",
    in_logs: "Small commands move the robot too little or not at all; large ones agree.",
    imitated_by: &["payload", "inertia"],
    check: "Raise the command in small steps from zero, on the floor, and note the one at which the wheels begin to \
            turn.",
    place: Some(Place::Motor),
    needs_known_robot: false,
    variants: &[
        Variant {
            id: "cut",
            parameters: Deadband::PARAMETERS,
            hooks: &[Hook::Commands(&|v, context, commands| {
                let edge = context.command_for(Deadband::read(v).break_away);
                let softness = context.command_for(DEADBAND_EDGE);
                if edge > 0.0 {
                    each_command(commands, |c, _| c * ((c - edge) / softness + 0.5).clamp(0.0, 1.0));
                }
            })],
        },
        Variant {
            id: "subtracted",
            parameters: Deadband::PARAMETERS,
            hooks: &[Hook::Commands(&|v, context, commands| {
                let edge = context.command_for(Deadband::read(v).break_away);
                each_command(commands, |c, _| (c - edge).max(0.0));
            })],
        },
        Variant {
            id: "stretched",
            parameters: Deadband::PARAMETERS,
            hooks: &[Hook::Commands(&|v, context, commands| {
                // A command for full speed still gives full speed.
                let edge = context.command_for(Deadband::read(v).break_away).min(MOST_OF_FULL);
                each_command(commands, |c, _| (c - edge).max(0.0) * 100.0 / (100.0 - edge));
            })],
        },
        Variant {
            id: "wheel",
            parameters: Deadband::PARAMETERS,
            hooks: &[Hook::Motion(&|v, context, increment| {
                let held_cm = Deadband::read(v).break_away * context.reference_cm();
                each_wheel(context, increment, |cm, _| (cm.abs() - held_cm).max(0.0).copysign(cm));
            })],
        },
        Variant {
            id: "friction",
            parameters: Deadband::PARAMETERS,
            hooks: &[Hook::Commands(&|v, context, commands| {
                let Deadband { break_away } = Deadband::read(v);
                if break_away > 0.0 {
                    // What keeps a drive from moving helps it to stop, too.
                    let known = Drive::slower(0.0, 0.0, context);
                    known.imitate(&Drive::slower(0.0, break_away, context), commands);
                }
            })],
        },
    ],
};

parameters! {
    Deadband {
        /// Share of the reference speed below whose command nothing moves. Real NXT motors on the ground break away at 12 to 16 %
        /// of full power.
        break_away: Parameter::new("", 0.0, [0.0, 0.5])
            .prior_sd(0.2)
            .from(Guesses::OfTopSpeed(&[0.04, 0.08, 0.14, 0.22, 0.3]))
            .report(Report::Command),
    }
}

/// Commands above which nothing may be lost leave something to stretch over.
const MOST_OF_FULL: f64 = 90.0;
