//! The drive takes longer to reach its speed.

use super::drive::Drive;
use super::parameters;
use crate::effects::context::HISTORY;
use crate::effects::parameter::{Guesses, Report};
use crate::effects::{Effect, Hook, Parameter, Variant};

pub const EFFECT: Effect = Effect {
    id: "inertia",
    name: "inertia",
    what: "The drive takes longer to reach the commanded speed.",
    check: "Film a start beside a ruler and mark the robot's place frame by frame: the way grows as a curve before \
            it grows as a line.",
    needs_known_robot: false,
    variants: &[
        Variant {
            id: "first_order_lag",
            parameters: Lag::PARAMETERS,
            hooks: &[Hook::Commands(&|v, context, commands| {
                let Lag { ms } = Lag::read(v);
                if ms == 0.0 {
                    return;
                }
                // The speed comes nearer to its command as exp(-t / ms): by the end of a step, and in the mean over it.
                let steps = ms / context.robot.step_ms;
                let missing = libm::exp(-1.0 / steps);
                let mean_missing = steps * (1.0 - missing);
                let mut speed = commands[HISTORY - 1];
                for command in commands[1..].iter().rev() {
                    speed = [0, 1].map(|m| command[m] + missing * (speed[m] - command[m]));
                }
                commands[0] = [0, 1].map(|m| commands[0][m] + mean_missing * (speed[m] - commands[0][m]));
                commands[1] = speed;
            })],
        },
        Variant {
            id: "drive_with_friction",
            parameters: SlowDrive::PARAMETERS,
            hooks: &[Hook::Commands(&|v, context, commands| {
                let SlowDrive { ms, friction } = SlowDrive::read(v);
                if ms > 0.0 {
                    let known = Drive::slower(0.0, friction, context);
                    known.imitate(&Drive::slower(ms, friction, context), commands);
                }
            })],
        },
    ],
};

/// Time that is added to the drive's time constant. An NXT motor takes about 50 ms, a skid-steered robot of half a tonne half a
/// second.
const ADDED_MS: Parameter =
    Parameter::new("ms", 0.0, [0.0, 800.0]).prior_sd(200.0).from(Guesses::At(&[40.0, 120.0, 200.0, 400.0]));

parameters! {
    Lag {
        /// See [`ADDED_MS`].
        ms: ADDED_MS,
    }
}

parameters! {
    SlowDrive {
        /// See [`ADDED_MS`].
        ms: ADDED_MS,
        /// The share of the reference speed whose command does no more than overcome the drive's dry friction, which helps it to
        /// stop and not to start. Of an NXT motor it is a twentieth.
        friction: Parameter::new("", 0.0, [0.0, 0.3])
            .prior_sd(0.1)
            .from(Guesses::At(&[0.05]))
            .report(Report::Hidden),
    }
}
