//! What a fan of rays from the sensor meets.
//!
//! The networks know the axis alone (D, α). A real beam is wide, and a wall that is met aslant mirrors sound on to
//! another, from which it comes back by the same way: seen from the sensor, that other wall lies behind the first as in
//! a mirror, at the length of the whole way.

use glam::DVec2;

use mindgap_foundations::geometry::{Hit, Pose, Wall, cast, direction};

/// Number of rays.
pub const RAYS: usize = DIRECT + MIRRORED.len();
/// Number of rays that come straight back from what they meet; they are the first.
pub const DIRECT: usize = 9;
/// The direct rays that are followed on to a second wall besides, in their order: three show where its nearest part is.
pub const MIRRORED: [usize; 3] = [2, AXIS, 6];
/// Offsets of the rays from the axis, degrees.
pub const FAN_DEG: [f64; RAYS] = [-20.0, -15.0, -10.0, -5.0, 0.0, 5.0, 10.0, 15.0, 20.0, -10.0, 0.0, 10.0];
/// The ray along the axis.
pub const AXIS: usize = DIRECT / 2;
/// A mirrored ray begins this far before the wall that mirrors it, so that it does not meet it again, cm.
pub const BEFORE_WALL_CM: f64 = 0.01;

/// What one ray meets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Length of its way, cm; infinite where there is nothing.
    pub distance_cm: f64,
    /// Incidence angle where its way ends, degrees, 0..=90.
    pub alpha_deg: f64,
}

/// A fan's rays, in the order of [`FAN_DEG`].
pub type Fan = [Ray; RAYS];

impl Ray {
    const NOTHING: Ray = Ray { distance_cm: f64::INFINITY, alpha_deg: 90.0 };
}

/// The fan of a sensor at `sensor` whose beam is `width` times as wide as [`FAN_DEG`].
pub fn fan_at(sides: &[Wall], sensor: &Pose, width: f64) -> Fan {
    let heading_rad = |place: usize| sensor.heading_rad + (FAN_DEG[place] * width).to_radians();
    let hits: [Option<Hit>; DIRECT] =
        std::array::from_fn(|place| cast(sides, sensor.position_cm, direction(heading_rad(place))));
    std::array::from_fn(|place| {
        let Some(first) = (if place < DIRECT { hits[place] } else { hits[MIRRORED[place - DIRECT]] }) else {
            return Ray::NOTHING;
        };
        if place < DIRECT {
            return Ray { distance_cm: first.distance_cm, alpha_deg: first.incidence_rad.abs().to_degrees() };
        }
        mirrored(sides, sensor.position_cm, heading_rad(place), &first)
    })
}

/// The ray that `first` mirrors on.
fn mirrored(sides: &[Wall], from_cm: DVec2, heading_rad: f64, first: &Hit) -> Ray {
    let way_cm = first.distance_cm - BEFORE_WALL_CM;
    let back_rad = heading_rad + std::f64::consts::PI;
    let on = direction(back_rad + 2.0 * first.incidence_rad);
    cast(sides, from_cm + direction(heading_rad) * way_cm, on).map_or(Ray::NOTHING, |second| Ray {
        distance_cm: way_cm + second.distance_cm,
        alpha_deg: second.incidence_rad.abs().to_degrees(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use mindgap_foundations::geometry::Rectangle;

    /// In a corner, at 30 degrees from the lower wall: on to the right one, as if that stood on behind the lower wall.
    #[test]
    fn a_mirrored_ray_is_as_long_as_its_way() {
        let room = Rectangle { low_cm: DVec2::ZERO, high_cm: DVec2::new(200.0, 100.0) }.edges();
        let fan = fan_at(&room, &Pose::new(100.0, 20.0, f64::to_radians(-30.0)), 0.0);
        let [first, .., on] = fan;
        assert!((first.distance_cm - 40.0).abs() < 1e-9 && (first.alpha_deg - 60.0).abs() < 1e-9, "{first:?}");
        assert!((on.distance_cm - 100.0 / libm::cos(f64::to_radians(30.0))).abs() < 0.05, "{on:?}");
        assert!((on.alpha_deg - 30.0).abs() < 1e-9, "{on:?}");
    }

    #[test]
    fn where_nothing_is_met_nothing_is_mirrored() {
        assert!(fan_at(&[], &Pose::new(0.0, 0.0, 0.0), 1.0).iter().all(|ray| *ray == Ray::NOTHING));
    }
}
