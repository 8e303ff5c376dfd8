//! The floor is tilted.

use super::{DIRECTIONS_DEG, distance_lost_cm, moving, parameters};
use crate::effects::parameter::{Guesses, Report};
use crate::effects::{Effect, Hook, Parameter, Place, StepContext, Variant};
use mindgap_foundations::geometry::direction;

pub const EFFECT: Effect = Effect {
    id: "slope",
    name: "slope",
    what: "The floor is tilted: the robot gains way downhill and loses it uphill.",
    in_logs: "Residuals depend on the heading: too long downhill, too short uphill, sideways drift across the slope.",
    imitated_by: &["carpet_nap", "tracker_rotation"],
    check: "Lay a spirit level on the floor in two directions, or see where a ball rolls.",
    place: Some(Place::Ground),
    needs_known_robot: false,
    variants: &[
        Variant {
            id: "drift",
            parameters: Drift::PARAMETERS,
            hooks: &[Hook::MotionHere(&|v, context, increment| {
                let Drift { direction_deg, loss } = Drift::read(v);
                let [left, right] = increment.arc().wheels_cm(context.robot.track_cm);
                let down_cm = loss * 0.5 * (left.abs() + right.abs());
                let drift_cm = direction(angle_rad(direction_deg, context, increment.turn)) * down_cm;
                increment.forward += drift_cm.x;
                increment.lateral += drift_cm.y;
            })],
        },
        Variant {
            id: "gain_and_slide",
            parameters: Slope::PARAMETERS,
            hooks: &[Hook::MotionHere(&|v, context, increment| {
                let Slope { direction_deg, loss, with_speed, sideways } = Slope::read(v);
                // A driven wheel yields downhill; a wheel at rest holds.
                let [left, right] = increment.arc().wheels_cm(context.robot.track_cm);
                let driven = moving(left.abs().max(right.abs()), context);
                let pull_cm = driven * loss * distance_lost_cm(with_speed, increment.forward, context);
                let down_cm = direction(angle_rad(direction_deg, context, increment.turn)) * pull_cm;
                increment.forward += down_cm.x;
                increment.lateral += sideways * down_cm.y;
            })],
        },
    ],
};

/// Direction of downhill; the bounds leave room to go round either way.
const DOWNHILL: Parameter =
    Parameter::new("deg", 0.0, [-360.0, 360.0]).from(Guesses::At(&DIRECTIONS_DEG)).report(Report::Direction);
/// Share of speed gained straight downhill. A tilt of 3 degrees costs an NXT robot 2 to 3 % at half power; at 0.6 it could
/// hardly climb.
const LOSS: Parameter = Parameter::new("", 0.0, [0.0, 0.6]).prior_sd(0.15).from(Guesses::At(&[0.05]));

parameters! {
    Drift {
        /// See [`DOWNHILL`].
        direction_deg: DOWNHILL,
        /// See [`LOSS`].
        loss: LOSS,
    }
}

parameters! {
    Slope {
        /// See [`DOWNHILL`].
        direction_deg: DOWNHILL,
        /// See [`LOSS`].
        loss: LOSS,
        /// Share of the gain that grows with speed; a force that a motor without regulation feels costs the rest at any
        /// speed.
        with_speed: Parameter::new("", 0.5, [0.0, 1.0]).prior_sd(0.5).report(Report::Hidden),
        /// Sideways slide as a multiple of the gain forward.
        sideways: Parameter::new("", 0.0, [0.0, 1.5]).prior_sd(0.7).from(Guesses::At(&[0.5])).report(Report::Hidden),
    }
}

/// Returns a direction of the world relative to the mean heading of a step.
fn angle_rad(direction_deg: f64, context: &StepContext, turn_rad: f64) -> f64 {
    direction_deg.to_radians() - context.pose.heading_rad - 0.5 * turn_rad
}
