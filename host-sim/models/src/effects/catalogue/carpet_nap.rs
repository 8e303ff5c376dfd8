//! Drag depends on the direction of travel.

use super::{DIRECTIONS_DEG, distance_lost_cm, parameters, pushed_cm};
use crate::effects::parameter::{Guesses, Report};
use crate::effects::{Effect, Hook, Parameter, Place, StepContext, Variant};
use mindgap_foundations::motion::Motion;

pub const EFFECT: Effect = Effect {
    id: "carpet_nap",
    name: "carpet nap",
    what: "Drag depends on the direction of travel, as on a carpet whose fibres lie one way.",
    in_logs: "Forward motion is shortest in one direction of travel and longest in the opposite one.",
    imitated_by: &["slope"],
    check: "Drive the same straight command in four directions and measure the ways with a ruler; stroke the carpet \
            by hand to feel its direction.",
    place: Some(Place::Ground),
    needs_known_robot: false,
    variants: &[
        Variant {
            id: "against_the_nap",
            parameters: Nap::PARAMETERS,
            hooks: &[Hook::MotionHere(&|v, context, increment| {
                let Nap { direction_deg, loss, with_speed, across } = Nap::read(v);
                let against = along(direction_deg, context, increment);
                let drag = across * 0.5 * (1.0 + against) + (1.0 - across) * against.max(0.0);
                let lost_cm = loss * drag * distance_lost_cm(with_speed, increment.forward, context);
                increment.forward = pushed_cm(increment.forward, -lost_cm, context);
            })],
        },
        Variant {
            id: "along_an_axis",
            parameters: Axis::PARAMETERS,
            hooks: &[Hook::MotionHere(&|v, context, increment| {
                let Axis { direction_deg, loss } = Axis::read(v);
                let left = 1.0 - loss * along(direction_deg, context, increment).abs();
                increment.forward *= left;
                increment.lateral *= left;
            })],
        },
    ],
};

/// Share of speed lost against the nap. Robot makers report 1 to 5 % of a path; a deep pile can take several times that.
const LOSS: Parameter = Parameter::new("", 0.0, [0.0, 0.6]).prior_sd(0.15).from(Guesses::At(&[0.05]));

parameters! {
    Nap {
        /// Direction of travel with the most drag; the bounds leave room to go round either way.
        direction_deg: Parameter::new("deg", 0.0, [-360.0, 360.0])
            .from(Guesses::At(&DIRECTIONS_DEG))
            .report(Report::Direction),
        /// See [`LOSS`].
        loss: LOSS,
        /// Share of the loss that grows with speed.
        with_speed: Parameter::new("", 0.5, [0.0, 1.0]).prior_sd(0.5).report(Report::Hidden),
        /// How softly the drag sets in with the direction: with one half of it is there across the nap.
        across: Parameter::new("", 0.5, [0.0, 1.0]).prior_sd(0.5).report(Report::Hidden),
    }
}

parameters! {
    Axis {
        /// Axis along which drag is largest, either way.
        direction_deg: Parameter::new("deg", 0.0, [-180.0, 180.0])
            .from(Guesses::At(&[0.0, 45.0, 90.0, -45.0]))
            .report(Report::Direction),
        /// See [`LOSS`].
        loss: LOSS,
    }
}

/// Cosine between the direction of travel and a direction of the world; reversing travels against the heading.
fn along(direction_deg: f64, context: &StepContext, increment: &Motion<f64>) -> f64 {
    let heading_rad = context.pose.heading_rad + 0.5 * increment.turn;
    libm::cos(heading_rad - direction_deg.to_radians()) * increment.forward.signum()
}
