//! Finds the axis that points upwards in a body's poses, and projects them to the floor.
//!
//! A robot on a floor turns about the upright axis and keeps its height. Motion capture often counts y upwards.

use glam::{DQuat, DVec3};

use super::frame::Frame;
use super::spatial_pose::SpatialPose;
use mindgap_foundations::geometry::Pose;
use mindgap_foundations::statistics::summary::median;

/// An axis of a tracker.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Axis {
    /// The x axis.
    X,
    /// The y axis.
    Y,
    /// The z axis.
    #[default]
    Z,
}

/// Share of the rotation that is about the upright axis.
const MIN_SHARE: f64 = 0.7;
/// Minimum rotation that shows an axis, rad.
const MIN_RAD: f64 = 1.0;
/// Ratio of the extent along the upright axis to that along either other one.
const MAX_EXTENT: f64 = 0.5;
/// Rotation between the poses that are compared, rad: smaller ones are mostly noise.
const PER_STEP_RAD: f64 = 0.1;

/// A robot moves at least this far along the floor, as a multiple of its movement across it.
const FLAT: f64 = 5.0;
/// Shorter movements do not show the floor, cm.
const MIN_MOVEMENT_CM: f64 = 10.0;

impl Axis {
    /// Finds the upright axis of poses; `None` if they do not show it.
    pub fn upright(poses: impl Iterator<Item = SpatialPose>) -> Option<Self> {
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let (mut turned, mut before): (DVec3, Option<DQuat>) = (DVec3::ZERO, None);
        for SpatialPose { at_cm, rotation } in poses {
            (low, high) = (low.min(at_cm), high.max(at_cm));
            let from = *before.get_or_insert(rotation);
            let change = rotation * from.inverse();
            let sines = change.xyz() * change.w.signum();
            if sines.length() > PER_STEP_RAD / 2.0 {
                turned += 2.0 * sines.abs();
                before = Some(rotation);
            }
        }
        let extent = high - low;
        let axes = [Axis::X, Axis::Y, Axis::Z];
        axes.into_iter().find(|axis| {
            let [up, a, b] = axis.floor().map(|(index, _)| index);
            let is_turned = turned[up] > MIN_RAD && turned[up] > MIN_SHARE * (turned.x + turned.y + turned.z);
            is_turned && extent[up] < MAX_EXTENT * extent[a].max(extent[b])
        })
    }

    /// Finds the upright axis from where a robot moves, for sources that count z or y upwards; z if it hardly moves.
    pub fn of_movement<'a>(poses: impl Iterator<Item = &'a SpatialPose> + Clone) -> Self {
        let [x, y, z] = [0, 1, 2].map(|axis| {
            let middle_cm = median(poses.clone().map(|pose| pose.at_cm[axis]));
            median(poses.clone().map(|pose| (pose.at_cm[axis] - middle_cm).abs()))
        });
        if x.max(z) > MIN_MOVEMENT_CM && z > (FLAT * y).max(1.0) { Axis::Y } else { Axis::Z }
    }

    /// Returns the name of the axis.
    pub fn name(self) -> &'static str {
        match self {
            Axis::X => "x",
            Axis::Y => "y",
            Axis::Z => "z",
        }
    }

    /// Projects a pose to the floor.
    pub fn on_floor(self, SpatialPose { at_cm, rotation }: &SpatialPose) -> Pose {
        let [up, x, y] = self.floor().map(|(index, sign)| move |vector: DVec3| sign * vector[index]);
        let [qz, qx, qy] = [up(rotation.xyz()), x(rotation.xyz()), y(rotation.xyz())];
        let sin = 2.0 * (rotation.w * qz + qx * qy);
        let cos = 1.0 - 2.0 * (qy * qy + qz * qz);
        Pose::new(x(*at_cm), y(*at_cm), libm::atan2(sin, cos))
    }

    /// Projects a pose at a time to the floor.
    pub fn frame(self, t_ms: f64, pose: &SpatialPose) -> Frame {
        Frame { t_ms, pose: self.on_floor(pose) }
    }

    /// Returns index and sign of the tracker's axes along the world's z, x and y.
    fn floor(self) -> [(usize, f64); 3] {
        match self {
            Axis::X => [(0, 1.0), (1, 1.0), (2, 1.0)],
            Axis::Y => [(1, 1.0), (0, 1.0), (2, -1.0)],
            Axis::Z => [(2, 1.0), (0, 1.0), (1, 1.0)],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A drive in a circle whose upright axis is `axis`.
    fn circle(axis: Axis) -> Vec<SpatialPose> {
        let circle = (0..100).map(|i| {
            let rad = 0.05 * f64::from(i);
            let (sin, cos) = libm::sincos(rad);
            let (half_sin, half_cos) = libm::sincos(rad / 2.0);
            let [up, x, y] = axis.floor();
            let mut place = DVec3::ZERO;
            (place[x.0], place[y.0], place[up.0]) = (x.1 * 50.0 * sin, y.1 * -50.0 * cos, 10.0);
            let mut part = DVec3::ZERO;
            part[up.0] = up.1 * half_sin;
            SpatialPose { at_cm: place, rotation: DQuat::from_xyzw(part.x, part.y, part.z, half_cos) }
        });
        circle.collect()
    }

    #[test]
    fn every_upright_axis_gives_the_same_drive() {
        for axis in [Axis::X, Axis::Y, Axis::Z] {
            let poses = circle(axis);
            assert_eq!(Axis::upright(poses.iter().copied()), Some(axis));
            let frame = axis.frame(0.0, &poses[20]);
            assert!((frame.pose.heading_rad - 1.0).abs() < 1e-9, "{frame:?}");
            assert!((frame.pose.position_cm.x - 50.0 * libm::sin(1.0)).abs() < 1e-9, "{frame:?}");
        }
    }

    #[test]
    fn poses_at_rest_show_no_axis() {
        assert_eq!(Axis::upright(circle(Axis::Y).into_iter().take(1)), None);
        assert_eq!(Axis::upright(std::iter::empty()), None);
    }

    #[test]
    fn robot_on_a_floor_of_x_and_z_is_projected_onto_it() {
        // Motion capture with y up: a robot at x, z that has turned by 0.3 rad about y.
        let poses: Vec<SpatialPose> = (0..50)
            .map(|i| SpatialPose {
                at_cm: DVec3::new(3.0 * f64::from(i), 20.0, -5.0 * f64::from(i)),
                rotation: DQuat::from_xyzw(0.0, libm::sin(0.15), 0.0, libm::cos(0.15)),
            })
            .collect();
        assert_eq!(Axis::of_movement(poses.iter()), Axis::Y);
        let pose = Axis::Y.on_floor(&poses[10]);
        assert!((pose.position_cm - glam::DVec2::new(30.0, 50.0)).length() < 1e-9, "{pose:?}");
        assert!((pose.heading_rad - 0.3).abs() < 1e-12, "{pose:?}");
        let level: Vec<SpatialPose> =
            poses.iter().map(|p| SpatialPose { at_cm: DVec3::new(p.at_cm.x, p.at_cm.z, 20.0), ..*p }).collect();
        assert_eq!(Axis::of_movement(level.iter()), Axis::Z);
    }
}
