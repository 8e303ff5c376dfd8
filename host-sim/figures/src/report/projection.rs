//! Parallel projection of a box in space.

use glam::{DVec2, DVec3};

/// A parallel projection of the unit box.
#[derive(Clone, Copy, Debug)]
pub struct Projection {
    across: DVec3,
    up: DVec3,
    toward: DVec3,
    /// Lengths of the box's edges.
    edges: DVec3,
    scale: f64,
    shift: DVec2,
}

impl Projection {
    /// The box with edges of given lengths seen from a direction: `azimuth_deg` from +x to +y, and `elevation_deg`
    /// above the floor; as large as fits between `low` and `high` of the sheet (right, down).
    pub fn fitted(edges: DVec3, azimuth_deg: f64, elevation_deg: f64, low: DVec2, high: DVec2) -> Self {
        let (azimuth, elevation) = (azimuth_deg.to_radians(), elevation_deg.to_radians());
        let flat = DVec3::new(libm::cos(azimuth), libm::sin(azimuth), 0.0);
        let toward = flat * libm::cos(elevation) + DVec3::Z * libm::sin(elevation);
        let across = DVec3::Z.cross(flat);
        let up = toward.cross(across);
        let plain = Projection { across, up, toward, edges, scale: 1.0, shift: DVec2::ZERO };
        let corners: Vec<DVec2> = (0..8_u32)
            .map(|i| plain.place(DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2))))
            .collect();
        let least = corners.iter().copied().fold(DVec2::INFINITY, DVec2::min);
        let most = corners.iter().copied().fold(DVec2::NEG_INFINITY, DVec2::max);
        let scale = ((high - low) / (most - least)).min_element();
        Projection { scale, shift: (low + high) / 2.0 - (least + most) / 2.0 * scale, ..plain }
    }

    /// Image of a point of the unit box: right and down.
    pub fn place(&self, point: DVec3) -> DVec2 {
        let p = point * self.edges;
        DVec2::new(self.across.dot(p), -self.up.dot(p)) * self.scale + self.shift
    }

    /// Depth of a point of the unit box; larger is nearer to the viewer.
    pub fn nearness(&self, point: DVec3) -> f64 {
        self.toward.dot(point * self.edges)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn view(azimuth_deg: f64, elevation_deg: f64) -> Projection {
        let edges = DVec3::new(1.2, 1.0, 0.7);
        Projection::fitted(edges, azimuth_deg, elevation_deg, DVec2::new(10.0, 20.0), DVec2::new(210.0, 180.0))
    }

    #[test]
    fn seen_from_the_front_x_is_near_y_is_right_and_z_is_up() {
        let view = view(0.0, 0.0);
        let at = |x, y, z| view.place(DVec3::new(x, y, z));
        assert!(at(0.5, 1.0, 0.5).x > at(0.5, 0.0, 0.5).x);
        assert!(at(0.5, 0.5, 1.0).y < at(0.5, 0.5, 0.0).y);
        assert!(view.nearness(DVec3::X) > view.nearness(DVec3::ZERO));
    }

    proptest! {
        #[test]
        fn the_whole_box_fits(azimuth in 0.0..360.0, elevation in 5.0..85.0, p in prop::array::uniform3(0.0..1.0)) {
            let at = view(azimuth, elevation).place(DVec3::from_array(p));
            prop_assert!(at.cmpge(DVec2::new(10.0, 20.0) - 1e-9).all() && at.cmple(DVec2::new(210.0, 180.0) + 1e-9).all());
        }
    }
}
