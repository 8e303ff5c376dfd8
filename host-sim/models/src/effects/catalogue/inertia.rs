//! The drive takes longer to reach its speed.

use super::drive::Drive;
use super::parameters;
use crate::effects::parameter::{Guesses, Report};
use crate::effects::{Effect, Hook, Parameter, Place, Variant};

pub const EFFECT: Effect = Effect {
    id: "inertia",
    name: "inertia",
    what: "The drive takes longer to reach the commanded speed.",
    in_logs: "After a change of the command the motion approaches its new value over several steps.",
    imitated_by: &["latency", "slip"],
    check: "Film a start beside a ruler and mark the robot's place frame by frame: the way grows as a curve before \
            it grows as a line.",
    place: Some(Place::Motor),
    needs_known_robot: false,
    variants: &[
        Variant {
            id: "first_order_lag",
            parameters: Lag::PARAMETERS,
            hooks: &[Hook::Filter(&|v, filter| filter.lag_steps += Lag::read(v).ms)],
        },
        Variant {
            id: "drive_with_friction",
            parameters: SlowDrive::PARAMETERS,
            hooks: &[Hook::Commands(&|v, context, commands| {
                let SlowDrive { ms, friction } = SlowDrive::read(v);
                if ms > 0.0 {
                    let known = Drive::slower(0.0, friction, context);
                    known.imitate(&Drive::slower(ms * context.robot.step_ms, friction, context), commands);
                }
            })],
        },
    ],
};

/// Time that is added to the drive's time constant, steps. An NXT motor takes about 50 ms, a skid-steered robot of half a tonne
/// half a second.
const ADDED: Parameter = Parameter::new("ms", 0.0, [-8.0, 8.0])
    .prior_sd(1.0)
    .from(Guesses::At(&[0.1, 0.3, 0.5, 1.0]))
    .report(Report::Duration);

parameters! {
    Lag {
        /// See [`ADDED`]. It is negative for a robot that answers faster than its simulator, whose drive filter it changes.
        ms: ADDED,
    }
}

parameters! {
    SlowDrive {
        /// See [`ADDED`].
        ms: Parameter { bounds: [0.0, 8.0], ..ADDED },
        /// The share of the reference speed whose command does no more than overcome the drive's dry friction, which helps it to
        /// stop and not to start. Of an NXT motor it is a twentieth.
        friction: Parameter::new("", 0.0, [0.0, 0.3])
            .prior_sd(0.1)
            .from(Guesses::At(&[0.05]))
            .report(Report::Hidden),
    }
}
