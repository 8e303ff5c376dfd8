//! Forward speed is lost in turns, on both wheels alike.

use super::{parameters, pushed_cm};
use crate::effects::parameter::{Guesses, Report};
use crate::effects::scales::HALF_SPEED;
use crate::effects::{Effect, Hook, Parameter, Place, StepContext, Variant};
use mindgap_foundations::motion::Motion;

pub const EFFECT: Effect = Effect {
    id: "turn_loss",
    name: "loss of way in turns",
    what: "Both wheels lose way in turns, more the sharper the turn is.",
    in_logs: "Forward motion is too short in proportion to the turn; straight steps agree.",
    imitated_by: &["track_width", "marker_offset"],
    check: "Command an arc of one metre and a straight metre, and measure both with a string along the track.",
    place: Some(Place::Ground),
    needs_known_robot: false,
    variants: &[
        Variant {
            id: "at_any_speed",
            parameters: TurnLoss::PARAMETERS,
            hooks: &[Hook::Motion(&|v, context, increment| {
                lose(increment, TurnLoss::read(v).tracks_per_rad * increment.turn.abs(), context);
            })],
        },
        Variant {
            id: "with_speed",
            parameters: TurnLoss::PARAMETERS,
            hooks: &[Hook::Motion(&|v, context, increment| {
                let speed = increment.forward.abs() / (HALF_SPEED * context.reference_cm());
                lose(increment, TurnLoss::read(v).tracks_per_rad * increment.turn.abs() * speed, context);
            })],
        },
        Variant {
            id: "dry",
            parameters: DryTurnLoss::PARAMETERS,
            hooks: &[Hook::Motion(&|v, context, increment| {
                let DryTurnLoss { tracks_per_rad, saturation_rad_s } = DryTurnLoss::read(v);
                let saturation_rad = saturation_rad_s * context.step_s();
                let turned_rad = saturation_rad * up_to_one(increment.turn.abs() / saturation_rad);
                lose(increment, tracks_per_rad * turned_rad, context);
            })],
        },
    ],
};

/// Way lost for each radian of turn, in tracks; of the second variant at [half of the reference speed](HALF_SPEED). A Create loses a
/// third of its track. A robot that loses half of it could hardly turn about a standing wheel.
const LOSS: Parameter = Parameter::new("cm/rad", 0.0, [0.0, 0.7])
    .prior_sd(0.35)
    .from(Guesses::At(&[0.09, 0.35]))
    .report(Report::OfTrack("cm_per_rad"));

parameters! {
    TurnLoss {
        /// See [`LOSS`].
        tracks_per_rad: LOSS,
    }
}

parameters! {
    DryTurnLoss {
        /// In turns slower than the rate below; see [`LOSS`].
        tracks_per_rad: LOSS,
        /// Rate of turn from which on what drags rubs with all that rests on it, as dry friction does.
        saturation_rad_s: Parameter::new("rad/s", 2.0, [0.3, 8.0]).prior_sd(2.0).report(Report::Hidden),
    }
}

/// Shortens the way forward by a number of tracks.
fn lose(increment: &mut Motion<f64>, tracks: f64, context: &StepContext) {
    increment.forward = pushed_cm(increment.forward, -tracks * context.robot.track_cm, context);
}

/// The number where it is small, and one where it is large; rounded between, since a robot does not turn alike all through a
/// step.
fn up_to_one(x: f64) -> f64 {
    x / libm::sqrt(libm::sqrt(1.0 + x * x * x * x))
}
