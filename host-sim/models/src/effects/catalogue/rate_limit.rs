//! The speed changes by a limited amount per second.

use super::parameters;
use crate::effects::drive_filter::MostChange;
use crate::effects::parameter::{ActsOn, Guesses, Report};
use crate::effects::{Effect, Hook, Parameter, Place, Variant};

pub const EFFECT: Effect = Effect {
    id: "rate_limit",
    name: "rate limit",
    what: "The speed changes by a limited amount per second: a ramp in the controller, or motors at their largest torque.",
    in_logs: "After a change of the command the motion approaches its new value at a constant rate: large changes take longer.",
    imitated_by: &["inertia", "slip"],
    check: "Film a start and a full reversal beside a ruler: with a ramp the reversal takes twice as long as the start. \
            Look for an acceleration limit in the settings of the base.",
    place: Some(Place::Motor),
    needs_known_robot: false,
    variants: &[
        Variant {
            id: "wheel",
            parameters: WheelRamp::PARAMETERS,
            hooks: &[Hook::Filter(&|v, filter| {
                let WheelRamp { steps } = WheelRamp::read(v);
                if steps > 0.0 {
                    filter.most_change = Some(MostChange::Wheel(per_step(steps)));
                }
            })],
        },
        Variant {
            id: "twist",
            parameters: TwistRamp::PARAMETERS,
            hooks: &[Hook::Filter(&|v, filter| {
                let TwistRamp { steps, turn_steps } = TwistRamp::read(v);
                if steps > 0.0 || turn_steps > 0.0 {
                    let changes = [steps, turn_steps].map(per_step);
                    filter.most_change = Some(MostChange::Twist(changes));
                }
            })],
        },
    ],
};

/// Steps in which speeds change by the reference speed. An NXT on rubber tyres takes a third of a step of 400 ms, a heavy robot
/// a few.
const RAMP: Parameter = Parameter::new("cm/s^2", 0.0, [0.0, 8.0]).prior_sd(1.5).from(Guesses::At(&[0.3, 1.0, 2.5]));
/// A ramp that takes less time than this share of a step is none: a limit has to be a number.
const LEAST_STEPS: f64 = 1e-3;

parameters! {
    /// Of each wheel.
    WheelRamp {
        /// See [`RAMP`].
        steps: RAMP.report(Report::RateLimit(ActsOn::Wheel)),
    }
}

parameters! {
    /// Of forward speed and turn rate, each by itself.
    TwistRamp {
        /// See [`RAMP`].
        steps: RAMP.report(Report::RateLimit(ActsOn::Twist)),
        /// The same of the turn.
        turn_steps: Parameter { unit: "deg/s^2", ..RAMP.report(Report::TurnRateLimit) },
    }
}

/// Returns the most by which a speed changes per step, as a share of the reference speed.
fn per_step(steps: f64) -> f64 {
    1.0 / steps.max(LEAST_STEPS)
}
