//! The camera at the ceiling, averaged with the compass on the robot.

use std::f64::consts::TAU;

use glam::DVec2;

use super::hardware::Tracker;
use super::noise::{happens, normal};
use crate::chance::Generator;
use crate::geometry::{Pose, direction, wrap_rad};

impl Tracker {
    /// Where the robot at `pose` is seen, to two decimals, unless the frame is lost. The camera's angle was set by
    /// the compass when both were fitted, so their mean points along the compass's frame.
    pub fn see(&self, pose: &Pose, rng: &mut Generator) -> Option<Pose> {
        if happens(self.lost, rng) {
            return None;
        }
        let marker_cm = pose.position_cm + pose.direction().rotate(self.marker_cm);
        let noise_cm = DVec2::new(normal(rng), normal(rng)) * self.position_noise_cm;
        let seen_cm = self.through_lens(marker_cm) + noise_cm;
        let camera_rad = pose.heading_rad + self.marker_noise_rad * normal(rng);
        let compass_rad = self.compass(pose.heading_rad) + self.compass_noise_rad * normal(rng);
        let heading_rad = wrap_rad(camera_rad + wrap_rad(compass_rad - camera_rad) / 2.0);
        let heading_deg = two_decimals(heading_rad.to_degrees());
        Some(Pose::new(two_decimals(seen_cm.x), two_decimals(seen_cm.y), heading_deg.to_radians()))
    }

    /// A point of the floor as the picture's coordinates have it.
    fn through_lens(&self, point_cm: DVec2) -> DVec2 {
        let from_middle = point_cm - self.middle_cm;
        let bend = 1.0 + self.distortion_per_m2 * from_middle.length_squared() / 1e4;
        self.middle_cm + direction(self.turn_rad).rotate(from_middle) * (self.scale * bend)
    }

    /// The compass points along the earth's field and that of the iron on the robot together.
    fn compass(&self, heading_rad: f64) -> f64 {
        let field = direction(-heading_rad) + self.iron;
        (-libm::atan2(field.y, field.x)).rem_euclid(TAU)
    }
}

fn two_decimals(value: f64) -> f64 {
    (value * 100.0).round() / 100.0
}
