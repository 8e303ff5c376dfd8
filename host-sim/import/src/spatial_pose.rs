//! Poses in space.

use glam::{DQuat, DVec3};

/// A pose in space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpatialPose {
    /// Position, cm.
    pub at_cm: DVec3,
    /// Rotation from the body's frame to the outer one, of length one.
    pub rotation: DQuat,
}

impl SpatialPose {
    /// Returns this pose followed by another, which is given in its frame.
    pub fn compose(&self, other: &SpatialPose) -> SpatialPose {
        SpatialPose {
            at_cm: self.at_cm + self.rotation * other.at_cm,
            rotation: (self.rotation * other.rotation).normalize(),
        }
    }

    /// Interpolates between two poses.
    pub fn between(&self, other: &SpatialPose, share: f64) -> SpatialPose {
        // Of the two quaternions of a rotation, the nearer one is meant.
        let to = if self.rotation.dot(other.rotation) < 0.0 { -other.rotation } else { other.rotation };
        SpatialPose {
            at_cm: self.at_cm.lerp(other.at_cm, share),
            rotation: (self.rotation * (1.0 - share) + to * share).normalize(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::upright::Axis;

    #[test]
    fn interpolation_takes_the_shorter_way() {
        let at = |rad: f64, sign: f64| SpatialPose {
            at_cm: DVec3::ZERO,
            rotation: DQuat::from_xyzw(0.0, 0.0, libm::sin(rad / 2.0), libm::cos(rad / 2.0)) * sign,
        };
        let halfway = Axis::Z.on_floor(&at(3.0, 1.0).between(&at(3.2, -1.0), 0.5));
        assert!((halfway.heading_rad - 3.1).abs() < 1e-9, "{halfway:?}");
    }
}
