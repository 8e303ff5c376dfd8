//! The tracked marker is not above the middle of the axle.

use glam::DVec2;

use super::parameters;
use crate::effects::parameter::{Guesses, Report};
use crate::effects::{Effect, Hook, Parameter, Place, StepContext, Variant};
use mindgap_foundations::geometry::direction;

pub const EFFECT: Effect = Effect {
    id: "marker_offset",
    name: "marker off the axle",
    what: "The tracked marker does not sit over the middle of the axle, so turns on the spot look like motion.",
    in_logs: "Turns on the spot come with lateral motion in proportion to the turn.",
    imitated_by: &["turn_loss", "tracker_rotation"],
    check: "Measure from the marker to the middle of the axle with a ruler; turned on the spot by hand, the marker \
            draws a circle of that radius.",
    place: Some(Place::Tracker),
    needs_known_robot: false,
    variants: &[Variant {
        id: "rigid",
        parameters: Marker::PARAMETERS,
        hooks: &[
            Hook::Motion(&|v, context, increment| {
                let at_cm = Marker::read(v).on_the_robot_cm(context);
                let carried_cm = direction(increment.turn).rotate(at_cm) - at_cm;
                increment.forward += carried_cm.x;
                increment.lateral += carried_cm.y;
            }),
            Hook::SensorHere(&|v, context, sensor| {
                let at_cm = Marker::read(v).on_the_robot_cm(context);
                sensor.robot.position_cm -= direction(sensor.robot.heading_rad).rotate(at_cm);
            }),
        ],
    }],
};

/// Either way, in tracks: a marker farther off would not lie on the robot's body.
const OFFSET: Parameter = Parameter::new("cm", 0.0, [-1.3, 1.3]).prior_sd(0.35);

parameters! {
    Marker {
        /// How far ahead of the axle's middle.
        ahead: OFFSET.from(Guesses::At(&[0.17, -0.17])).report(Report::OfTrack("ahead_cm")),
        /// How far to its left.
        left: OFFSET.report(Report::OfTrack("left_cm")),
    }
}

impl Marker {
    fn on_the_robot_cm(&self, context: &StepContext) -> DVec2 {
        context.robot.track_cm * DVec2::new(self.ahead, self.left)
    }
}
