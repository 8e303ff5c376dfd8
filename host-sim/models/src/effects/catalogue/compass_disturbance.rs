//! The heading error depends on the heading.

use super::{DIRECTIONS_DEG, parameters};
use crate::effects::parameter::{Guesses, Report};
use crate::effects::{Effect, Hook, Parameter, Place, SensorState, StepContext, Variant};
use mindgap_foundations::geometry::wrap_rad;
use mindgap_foundations::motion::Motion;

pub const EFFECT: Effect = Effect {
    id: "compass_disturbance",
    name: "disturbed compass",
    what: "The error of the heading depends on the heading, as iron near a compass makes it.",
    in_logs: "Turns are off depending on the heading; the errors cancel over a full turn.",
    imitated_by: &["tracker_rotation", "track_width"],
    check: "Turn the robot on a disc with marks of 30 degrees and compare the reported headings.",
    place: Some(Place::Tracker),
    needs_known_robot: false,
    variants: &[
        // Iron on the robot gives one wave a turn (hard iron), what it magnetises two (soft iron).
        Variant {
            id: "hard_iron",
            parameters: Wave::PARAMETERS,
            hooks: &[
                Hook::MotionHere(&|v, context, increment| Wave::read(v).disturb(1.0, context, increment)),
                Hook::SensorHere(&|v, _, sensor| Wave::read(v).undo(1.0, sensor)),
            ],
        },
        Variant {
            id: "soft_iron",
            parameters: Wave::PARAMETERS,
            hooks: &[
                Hook::MotionHere(&|v, context, increment| Wave::read(v).disturb(2.0, context, increment)),
                Hook::SensorHere(&|v, _, sensor| Wave::read(v).undo(2.0, sensor)),
            ],
        },
    ],
};

parameters! {
    Wave {
        /// Largest error of the heading. Motors near a compass make 5 to 15 degrees; beyond 35 it points nowhere.
        deg: Parameter::new("deg", 0.0, [0.0, 35.0]).prior_sd(10.0).from(Guesses::At(&[3.0])),
        /// Phase of the wave; the bounds leave room to go round either way.
        phase_deg: Parameter::new("deg", 0.0, [-360.0, 360.0])
            .from(Guesses::At(&DIRECTIONS_DEG))
            .report(Report::Hidden),
    }
}

impl Wave {
    /// Error of the heading at a heading.
    fn error_rad(&self, waves: f64, heading_rad: f64) -> f64 {
        self.deg.to_radians() * libm::sin(waves * heading_rad - self.phase_deg.to_radians())
    }

    fn disturb(&self, waves: f64, context: &StepContext, increment: &mut Motion<f64>) {
        let here_rad = self.error_rad(waves, context.pose.heading_rad);
        let there_rad = self.error_rad(waves, context.pose.heading_rad + increment.turn);
        increment.rotate_translation(-here_rad);
        increment.turn += there_rad - here_rad;
    }

    fn undo(&self, waves: f64, sensor: &mut SensorState) {
        let heading_rad = sensor.robot.heading_rad;
        sensor.robot.heading_rad = wrap_rad(heading_rad - self.error_rad(waves, heading_rad));
    }
}
