//! The surfaces that a fan of rays from the sensor hits.
//!
//! The networks know the axis alone (D, α). A real beam is wide, and a wall hit obliquely reflects sound specularly onto
//! another one, from which it returns along the same path. Seen from the sensor, the other wall lies behind the first as in
//! a mirror, at the length of the whole path.

use glam::DVec2;

use mindgap_foundations::geometry::{Hit, Pose, Wall, cast, direction};

/// Number of rays.
pub const RAYS: usize = DIRECT + MIRRORED.len();
/// Number of direct rays, which return from the first surface that they hit; they come first.
pub const DIRECT: usize = 9;
/// The direct rays that are also continued to a second wall, in order; three locate its nearest part.
pub const MIRRORED: [usize; 3] = [2, AXIS, 6];
/// Offsets of the rays from the axis, degrees.
pub const FAN_DEG: [f64; RAYS] = [-20.0, -15.0, -10.0, -5.0, 0.0, 5.0, 10.0, 15.0, 20.0, -10.0, 0.0, 10.0];
/// The ray along the axis.
pub const AXIS: usize = DIRECT / 2;
/// Distance in front of the mirroring wall at which a mirrored ray starts, so that it does not hit that wall again, cm.
pub const BEFORE_WALL_CM: f64 = 0.01;

/// The path of one ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Length of the path, cm; infinite if the ray hits nothing.
    pub distance_cm: f64,
    /// Incidence angle at the end of the path, degrees, 0..=90.
    pub alpha_deg: f64,
}

/// A fan's rays, in the order of [`FAN_DEG`].
pub type Fan = [Ray; RAYS];

impl Ray {
    const NOTHING: Ray = Ray { distance_cm: f64::INFINITY, alpha_deg: 90.0 };
}

/// Returns the fan of a sensor at `sensor` whose beam is `width` times as wide as [`FAN_DEG`].
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

/// Returns the ray after its specular reflection at `first`.
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

    /// In a corner, at 30 degrees to the lower wall: the ray continues to the right wall, as if that extended below the
    /// lower one.
    #[test]
    fn mirrored_ray_has_the_length_of_its_path() {
        let room = Rectangle { low_cm: DVec2::ZERO, high_cm: DVec2::new(200.0, 100.0) }.edges();
        let fan = fan_at(&room, &Pose::new(100.0, 20.0, f64::to_radians(-30.0)), 0.0);
        let [first, .., on] = fan;
        assert!((first.distance_cm - 40.0).abs() < 1e-9 && (first.alpha_deg - 60.0).abs() < 1e-9, "{first:?}");
        assert!((on.distance_cm - 100.0 / libm::cos(f64::to_radians(30.0))).abs() < 0.05, "{on:?}");
        assert!((on.alpha_deg - 30.0).abs() < 1e-9, "{on:?}");
    }

    #[test]
    fn rays_that_hit_nothing_are_not_mirrored() {
        assert!(fan_at(&[], &Pose::new(0.0, 0.0, 0.0), 1.0).iter().all(|ray| *ray == Ray::NOTHING));
    }
}
