//! The tracker: a ceiling camera whose heading is averaged with that of the compass on the robot.

use std::f64::consts::TAU;

use glam::DVec2;

use super::hardware::Tracker;
use super::noise::{happens, normal};
use mindgap_foundations::geometry::{Pose, direction, wrap_rad};
use mindgap_foundations::random::Generator;

impl Tracker {
    /// Returns the tracked pose of a robot at `pose`, to two decimals; `None` for a lost frame. Without iron the compass would show
    /// the heading `needle_rad`. The camera was aligned with the compass when both were mounted, so the mean of their headings is
    /// in the compass's frame; averaged over time it is behind by `behind_rad`.
    pub fn see(&self, pose: &Pose, needle_rad: f64, behind_rad: f64, rng: &mut Generator) -> Option<Pose> {
        if happens(self.lost, rng) {
            return None;
        }
        let marker_cm = pose.position_cm + pose.direction().rotate(self.marker_cm);
        let blur_cm = self.blur_cm_per_m2 * (marker_cm - self.centre_cm).length_squared() / 1e4;
        let noise_cm = DVec2::new(normal(rng), normal(rng)) * (self.position_noise_cm + blur_cm);
        let seen_cm = self.through_lens(marker_cm) + noise_cm;
        let camera_rad = pose.heading_rad + self.marker_noise_rad * normal(rng);
        let compass_rad = self.compass(needle_rad) + self.compass_noise_rad * normal(rng);
        let heading_rad = wrap_rad(camera_rad + wrap_rad(compass_rad - camera_rad) / 2.0 - behind_rad);
        let heading_deg = two_decimals(heading_rad.to_degrees());
        Some(Pose::new(two_decimals(seen_cm.x), two_decimals(seen_cm.y), heading_deg.to_radians()))
    }

    /// Returns the heading of the compass needle after `tick_ms`, as it approaches the robot's.
    pub fn needle_after(&self, needle_rad: f64, heading_rad: f64, tick_ms: f64) -> f64 {
        if self.needle_ms == 0.0 {
            return heading_rad;
        }
        let lag_rad = wrap_rad(heading_rad - needle_rad);
        wrap_rad(needle_rad + lag_rad * (tick_ms / self.needle_ms).min(1.0))
    }

    /// Maps a point of the floor to the coordinates of the distorted picture.
    fn through_lens(&self, point_cm: DVec2) -> DVec2 {
        let from_centre = point_cm - self.centre_cm;
        let bend = 1.0 + self.distortion_per_m2 * from_centre.length_squared() / 1e4;
        self.centre_cm + direction(self.turn_rad).rotate(from_centre) * (self.scale * bend)
    }

    /// Returns the heading from the sum of the earth's field and that of iron on the robot.
    fn compass(&self, heading_rad: f64) -> f64 {
        let field = direction(-heading_rad) + self.iron;
        (-libm::atan2(field.y, field.x)).rem_euclid(TAU)
    }
}

fn two_decimals(value: f64) -> f64 {
    (value * 100.0).round() / 100.0
}
