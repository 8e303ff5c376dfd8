//! What a fan of rays from the sensor meets.
//!
//! The networks know the axis alone (D, α). A real beam is wide.

use crate::geometry::{Pose, Wall, cast, direction};

/// Number of rays.
pub const RAYS: usize = 9;
/// Offsets of the rays from the axis, degrees.
pub const FAN_DEG: [f64; RAYS] = [-20.0, -15.0, -10.0, -5.0, 0.0, 5.0, 10.0, 15.0, 20.0];
/// The ray along the axis.
pub const AXIS: usize = RAYS / 2;

/// What one ray meets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Distance, cm; infinite where there is nothing.
    pub distance_cm: f64,
    /// Incidence angle, degrees, 0..=90.
    pub alpha_deg: f64,
}

/// A fan's rays, in the order of [`FAN_DEG`].
pub type Fan = [Ray; RAYS];

/// The fan of a sensor at `sensor` whose beam is `width` times as wide as [`FAN_DEG`].
pub fn fan_at(sides: &[Wall], sensor: &Pose, width: f64) -> Fan {
    FAN_DEG.map(|offset| {
        let way = direction(sensor.heading_rad + (offset * width).to_radians());
        cast(sides, sensor.position_cm, way).map_or(Ray { distance_cm: f64::INFINITY, alpha_deg: 90.0 }, |hit| Ray {
            distance_cm: hit.distance_cm,
            alpha_deg: hit.incidence_rad.abs().to_degrees(),
        })
    })
}
