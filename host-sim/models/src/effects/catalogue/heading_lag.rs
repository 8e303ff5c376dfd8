//! The tracked heading lags behind the robot's.

use super::parameters;
use crate::effects::lagging_heading::ahead_of_tracked_rad;
use crate::effects::parameter::{Guesses, Report};
use crate::effects::{Effect, Hook, Parameter, Place, Variant};

pub const EFFECT: Effect = Effect {
    id: "heading_lag",
    name: "lagging heading",
    what: "The tracked heading lags behind the robot's: a filter in the tracker or in the compass smooths it.",
    in_logs: "In turns the robot moves to the inside of its heading; after a change of turn rate the heading moves on over several steps.",
    imitated_by: &["turn_lag", "marker_offset"],
    check: "Turn the robot on the spot, stop it at once, and watch the tracked heading: it moves on after the robot stands.",
    place: Some(Place::Tracker),
    needs_known_robot: false,
    variants: &[Variant {
        id: "first_order",
        parameters: HeadingLag::PARAMETERS,
        hooks: &[
            Hook::HeadingLag(&|v| HeadingLag::read(v).ms),
            Hook::SensorHere(&|v, context, sensor| {
                sensor.robot.heading_rad = ahead_of_tracked_rad(HeadingLag::read(v).ms, context);
            }),
        ],
    }],
};

parameters! {
    HeadingLag {
        /// Time constant, steps. Compasses and the filters of trackers take 50 to 500 ms; a heading that is late by more than a few
        /// steps is useless. It is negative for one that lags less than in the training logs.
        ms: Parameter::new("ms", 0.0, [-4.0, 4.0])
            .prior_sd(1.0)
            .from(Guesses::At(&[0.3]))
            .report(Report::Duration),
    }
}
