//! The camera's scale changes with distance from the picture's middle.

use glam::DVec2;

use super::parameters;
use crate::effects::parameter::Guesses;
use crate::effects::{Effect, Hook, Parameter, Place, Variant};
use mindgap_foundations::geometry::direction;

pub const EFFECT: Effect = Effect {
    id: "lens_distortion",
    name: "lens distortion",
    what: "The camera's scale changes towards the edge of its picture.",
    in_logs: "Forward motion is off by a factor that changes with the distance from the middle of the picture.",
    imitated_by: &["tracker_scale"],
    check: "Lay a long ruler in the middle of the picture and along its edge: one length should have one tracked \
            length.",
    place: Some(Place::Tracker),
    needs_known_robot: false,
    variants: &[Variant {
        id: "quadratic",
        parameters: Lens::PARAMETERS,
        hooks: &[
            Hook::MotionHere(&|v, context, increment| {
                let lens = Lens::read(v);
                let start_cm = context.pose.position_cm;
                let heading = direction(context.pose.heading_rad);
                let translation_cm = heading.rotate(DVec2::new(increment.forward, increment.lateral));
                let end_cm = lens.undistorted(start_cm, context.middle_cm) + translation_cm;
                let seen_cm = lens.distorted(end_cm, context.middle_cm) - start_cm;
                let seen_cm = direction(-context.pose.heading_rad).rotate(seen_cm);
                (increment.forward, increment.lateral) = (seen_cm.x, seen_cm.y);
            }),
            Hook::SensorHere(&|v, context, sensor| {
                let seen_cm = sensor.robot.position_cm;
                sensor.robot.position_cm = Lens::read(v).undistorted(seen_cm, context.middle_cm);
            }),
        ],
    }],
};

parameters! {
    Lens {
        /// Scale gained a square metre of squared distance from the middle. Lenses are off by 1 to 3 % at a picture's edge,
        /// one to two metres out; fish-eyes by several times that.
        per_m2: Parameter::new("1/m2", 0.0, [-0.2, 0.2]).prior_sd(0.05).from(Guesses::At(&[0.01, -0.01])),
    }
}

impl Lens {
    fn distorted(&self, true_cm: DVec2, middle_cm: DVec2) -> DVec2 {
        let from_middle = true_cm - middle_cm;
        middle_cm + from_middle * self.scale(from_middle)
    }

    /// The inverse, by a few rounds of substitution.
    fn undistorted(&self, seen_cm: DVec2, middle_cm: DVec2) -> DVec2 {
        let seen = seen_cm - middle_cm;
        middle_cm + (0..ROUNDS).fold(seen, |r, _| seen / self.scale(r))
    }

    /// Kept within what a lens can do, so that places far outside of its picture stay finite.
    fn scale(&self, from_middle_cm: DVec2) -> f64 {
        let metres_squared = from_middle_cm.length_squared() * 1e-4;
        (1.0 + self.per_m2 * metres_squared).clamp(0.3, 3.0)
    }
}

/// Substitution gains a digit a round where the scale is off by a tenth.
const ROUNDS: usize = 6;
