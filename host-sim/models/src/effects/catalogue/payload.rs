//! A load, off the middle.

use super::{distance_lost_cm, each_command, each_wheel, loaded, parameters, pushed_cm, scrubbing};
use crate::effects::context::CommandHistory;
use crate::effects::parameter::{Guesses, Report};
use crate::effects::scales::{HALF_SPEED, HALF_TURN_RATE_RAD_S};
use crate::effects::{Effect, Hook, Parameter, Place, StepContext, Variant};
use mindgap_foundations::motion::Motion;

pub const EFFECT: Effect = Effect {
    id: "payload",
    name: "payload",
    what: "A load that does not sit in the middle slows the robot, and one wheel more than the other.",
    in_logs: "The robot is slower at all speeds, slow to start, and bends to the loaded side.",
    imitated_by: &["motor_asymmetry", "drive_scale", "slope"],
    check: "Put a kitchen scale under each wheel in turn; take off what was added and drive the same commands again.",
    place: Some(Place::Body),
    // A textbook states no load, and what a load does to it is a drive scale, a weak motor, a lag and scrubbing.
    needs_known_robot: true,
    variants: &[
        Variant {
            id: "command",
            parameters: Load::PARAMETERS,
            hooks: &[Hook::Commands(&|v, _, commands| {
                let Load { loss, loss_other_wheel } = Load::read(v);
                let factors = by_side(loss, loss_other_wheel).map(|lost| 1.0 - lost);
                each_command(commands, |c, motor| c * factors[motor]);
            })],
        },
        Variant {
            id: "distance",
            parameters: Load::PARAMETERS,
            hooks: &[Hook::Motion(&|v, context, increment| {
                let Load { loss, loss_other_wheel } = Load::read(v);
                shorten(by_side(loss, loss_other_wheel), context, increment);
            })],
        },
        Variant {
            id: "heavy",
            parameters: HeavyLoad::PARAMETERS,
            hooks: &[
                Hook::Commands(&|v, _, commands| {
                    let HeavyLoad { loss, start_loss, .. } = HeavyLoad::read(v);
                    start_slowly(start_loss * loss.abs(), commands);
                }),
                Hook::Motion(&|v, context, increment| {
                    let HeavyLoad { loss, loss_other_wheel, turn_loss, loss_with_speed, .. } = HeavyLoad::read(v);
                    shorten(by_side(loss, loss_other_wheel), context, increment);
                    increment.turn = scrubbed_rad(increment.turn, turn_loss * loss.abs(), loss_with_speed, context);
                }),
            ],
        },
        Variant {
            id: "rolling_resistance",
            parameters: RollingLoad::PARAMETERS,
            hooks: &[
                Hook::Commands(&|v, _, commands| {
                    let RollingLoad { loss, start_loss, .. } = RollingLoad::read(v);
                    start_slowly(start_loss * loss.abs(), commands);
                }),
                Hook::Motion(&|v, context, increment| {
                    let RollingLoad { loss, loss_other_wheel, with_speed, .. } = RollingLoad::read(v);
                    let losses = by_side(loss, loss_other_wheel);
                    each_wheel(context, increment, |cm, wheel| {
                        pushed_cm(cm, -losses[wheel] * distance_lost_cm(with_speed, cm, context), context)
                    });
                }),
            ],
        },
        Variant {
            id: "motor_load",
            parameters: RollingLoad::PARAMETERS,
            hooks: &[Hook::Commands(&|v, context, commands| {
                let RollingLoad { loss, loss_other_wheel, with_speed, start_loss } = RollingLoad::read(v);
                start_slowly(start_loss * loss.abs(), commands);
                // To a motor, the torque of a load is a lower voltage, which is what a command sets.
                let (lost, reference) = (by_side(loss, loss_other_wheel), context.command_for(HALF_SPEED));
                each_command(commands, |c, motor| (c - lost[motor] * loaded(with_speed, c, reference)).max(0.0));
            })],
        },
    ],
};

/// Share of speed that the loaded left wheel loses; negative: the right one. 0.6 is a load that all but stops it.
const LOSS: Parameter =
    Parameter::new("", 0.0, [-0.6, 0.6]).prior_sd(0.2).from(Guesses::At(&[0.05, -0.05])).report(Report::SideAndLoss);
/// Loss of a change of speed as a multiple of the loss on the straight: a load that costs much at starts costs something
/// on the straight too, or it would be a slower motor.
const START_LOSS: Parameter =
    Parameter::new("", 0.0, [0.0, 6.0]).prior_sd(2.0).from(Guesses::At(&[1.0])).report(Report::Hidden);

parameters! {
    Load {
        /// See [`LOSS`].
        loss: LOSS,
        /// The other wheel's loss as a share of it: with none it would be a weaker motor, with all of it a scale.
        loss_other_wheel: Parameter::new("", 0.5, [0.15, 0.8]).prior_sd(0.3).report(Report::Hidden),
    }
}

parameters! {
    HeavyLoad {
        /// See [`LOSS`].
        loss: LOSS,
        /// The other wheel's loss as a share of it.
        loss_other_wheel: Parameter::new("", 0.5, [0.0, 0.8]).prior_sd(0.3).report(Report::Hidden),
        /// Loss of a turn of [`HALF_TURN_RATE_RAD_S`] as a multiple of it: tyres and castor that are pressed down scrub in turns.
        turn_loss: Parameter::new("", 0.0, [0.0, 6.0]).prior_sd(2.0).from(Guesses::At(&[2.0])).report(Report::Hidden),
        /// Share of that which grows with the rate of turn; dry friction costs the rest at any rate.
        loss_with_speed: Parameter::new("", 0.5, [0.0, 1.0]).prior_sd(0.5).report(Report::Hidden),
        /// See [`START_LOSS`].
        start_loss: START_LOSS,
    }
}

parameters! {
    RollingLoad {
        /// Share of speed lost at [half of the reference speed](HALF_SPEED); see [`LOSS`].
        loss: LOSS,
        /// The other wheel's loss as a share of it.
        loss_other_wheel: Parameter::new("", 0.5, [0.0, 0.8]).prior_sd(0.3).from(Guesses::At(&[0.2])).report(Report::Hidden),
        /// Share of the loss that grows with speed, as it does where tyres flex. Gears and hubs rub at any speed: with all of
        /// it it would be a weaker motor.
        with_speed: Parameter::new("", 0.3, [0.0, 0.75]).prior_sd(0.3).report(Report::Hidden),
        /// See [`START_LOSS`].
        start_loss: START_LOSS,
    }
}

/// Returns a turn after the loss of the fraction `lost` to scrubbing: partly of itself, partly of the reference turn.
fn scrubbed_rad(turn_rad: f64, lost: f64, loss_with_speed: f64, context: &StepContext) -> f64 {
    let reference_rad = HALF_TURN_RATE_RAD_S * context.step_s();
    let of_rad = loss_with_speed * turn_rad.abs() + (1.0 - loss_with_speed) * reference_rad;
    let lost_rad = lost * of_rad * scrubbing(turn_rad, context);
    if lost_rad.abs() < turn_rad.abs() { turn_rad - lost_rad } else { 0.0 }
}

/// Returns the losses of the left and the right wheel.
fn by_side(loss: f64, loss_other_wheel: f64) -> [f64; 2] {
    let (near, far) = (loss.abs(), loss.abs() * loss_other_wheel);
    if loss > 0.0 { [near, far] } else { [far, near] }
}

fn shorten(losses: [f64; 2], context: &StepContext, increment: &mut Motion<f64>) {
    each_wheel(context, increment, |cm, wheel| cm * (1.0 - losses[wheel]));
}

/// Delays the fraction `late` of every change of command to the next step.
fn start_slowly(late: f64, commands: &mut CommandHistory) {
    let late = late.min(1.0);
    let [now, before, ..] = commands;
    for (command, earlier) in now.iter_mut().zip(before) {
        *command += late * (*earlier - *command);
    }
}
