//! The tyres lose grip when pushed.

use super::{each_command, each_wheel, parameters};
use crate::effects::context::CommandHistory;
use crate::effects::parameter::{Guesses, Report};
use crate::effects::scales::{GRIPPING_TURN_RAD, HALF_SLIP};
use crate::effects::{Effect, Hook, Parameter, Place, StepContext, Variant};

pub const EFFECT: Effect = Effect {
    id: "slip",
    name: "wheel slip",
    what: "The tyres lose grip when they are pushed hard.",
    in_logs: "Steps after large changes of the command, or at high speed, are too short.",
    imitated_by: &["inertia", "saturation"],
    check: "Clean the tyres and the floor and drive the same commands again; a chalk mark on a tyre shows in a film \
            whether it turns more than the robot moves.",
    place: Some(Place::Ground),
    needs_known_robot: false,
    variants: &[
        Variant {
            id: "fast",
            parameters: FastSlip::PARAMETERS,
            hooks: &[Hook::Commands(&|v, context, commands| {
                let FastSlip { onset, loss } = FastSlip::read(v);
                let onset = context.command_for(onset);
                each_command(commands, |c, _| c - loss * (c - onset).max(0.0));
            })],
        },
        Variant {
            id: "change",
            parameters: Slip::PARAMETERS,
            hooks: &[Hook::Commands(&|v, context, commands| {
                let Slip { onset, loss } = Slip::read(v);
                // A wheel that slips in a step has caught up at its end.
                lose_change(commands, 0, context.command_for(onset), |beyond| loss * beyond);
            })],
        },
        Variant {
            id: "distance",
            parameters: Slip::PARAMETERS,
            hooks: &[Hook::Motion(&|v, context, increment| {
                let Slip { onset, loss } = Slip::read(v);
                let [now, before, ..] = context.commands;
                each_wheel(context, increment, |cm, m| {
                    let change = context.share_of((now[m] - before[m]).abs());
                    let beyond = (change - onset).max(0.0);
                    cm * (1.0 - (loss * beyond).min(1.0))
                });
            })],
        },
        Variant {
            id: "growing",
            parameters: DraggingSlip::PARAMETERS,
            hooks: &[
                Hook::Commands(&|v, context, commands| {
                    let DraggingSlip { onset, loss, creep_ms, .. } = DraggingSlip::read(v);
                    let lost = growing(loss, context);
                    // What a tyre creeps does not make it slide.
                    lose_change(commands, 0, 0.0, |change| change * loss * creep_ms / context.robot.step_ms);
                    lose_change(commands, 0, context.command_for(onset), &lost);
                    lose_change(commands, 1, NOT_CAUGHT_UP * context.command_for(onset), &lost);
                }),
                Hook::Motion(&|v, _, increment| {
                    let DraggingSlip { loss, turn_drag_rad, .. } = DraggingSlip::read(v);
                    increment.turn -= loss * turn_drag_rad * libm::tanh(increment.turn / GRIPPING_TURN_RAD);
                }),
            ],
        },
    ],
};

/// Change of wheel speed from which the tyres slide, as a share of the reference speed. Rubber on a floor holds about half a
/// robot's weight, which an NXT reaches within 6 cm/s at the least: below that it would be a scale or a lag.
const ONSET: Parameter =
    Parameter::new("", 1.22, [0.146, 1.22]).scale(1.05).from(Guesses::At(&[0.195, 0.39, 0.68])).report(Report::Onset);

parameters! {
    FastSlip {
        /// Wheel speed from which the tyres slide; see [`ONSET`].
        onset: ONSET,
        /// Share lost of what lies beyond: what loses more than half is a limit.
        loss: Parameter::new("", 0.0, [0.0, 0.5]).prior_sd(0.3).from(Guesses::At(&[0.3])),
    }
}

parameters! {
    Slip {
        /// See [`ONSET`].
        onset: ONSET,
        /// Share lost of what lies beyond: all of it at the most.
        loss: Parameter::new("", 0.0, [0.0, 1.0]).prior_sd(0.5).from(Guesses::At(&[0.2, 0.4])),
    }
}

parameters! {
    DraggingSlip {
        /// See [`ONSET`].
        onset: Parameter::new("", 0.61, [0.146, 0.9])
            .prior_sd(0.49)
            .from(Guesses::At(&[0.29, 0.61]))
            .report(Report::Onset),
        /// Share lost of what lies far beyond: all of it at the most.
        loss: Parameter::new("", 0.0, [0.0, 1.0]).prior_sd(0.7).from(Guesses::At(&[0.3, 0.8])),
        /// Turn that a step loses for a loss of one: a tyre of little grip creeps where it is held back.
        turn_drag_rad: Parameter::new("rad", 0.0, [0.0, 0.1])
            .prior_sd(0.05)
            .from(Guesses::At(&[0.0, 0.05]))
            .report(Report::Hidden),
        /// Time by which the robot lags behind its wheels for a loss of one: a tyre creeps by some 5 cm/s at half its grip,
        /// and a grip of half the weight takes 10 to 40 ms for that.
        creep_ms: Parameter::new("ms", 0.0, [0.0, 80.0])
            .prior_sd(30.0)
            .from(Guesses::At(&[0.0, 30.0]))
            .report(Report::Hidden),
    }
}

/// A change of this many onsets is not caught up with at the end of its step.
const NOT_CAUGHT_UP: f64 = 2.5;

/// What is lost of a change of command that lies so far beyond the onset: little at first, then in proportion.
fn growing(loss: f64, context: &StepContext) -> impl Fn(f64) -> f64 + use<> {
    let half = context.command_for(HALF_SLIP);
    move |beyond| loss * beyond * beyond / (half + beyond)
}

/// Takes from the present command what the change of command `ago` steps ago loses beyond the onset.
fn lose_change(commands: &mut CommandHistory, ago: usize, onset: f64, lost: impl Fn(f64) -> f64) {
    let (to, from) = (commands[ago], commands[ago + 1]);
    for ((command, to), from) in commands[0].iter_mut().zip(to).zip(from) {
        let change = to - from;
        *command -= lost((change.abs() - onset).max(0.0)) * change.signum();
    }
}
