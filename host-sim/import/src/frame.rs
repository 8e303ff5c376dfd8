//! A frame of a camera: where the robot was seen, and when.

use mindgap_foundations::geometry::Pose;

/// A frame in which the robot was seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Time on the camera's clock, ms.
    pub t_ms: f64,
    /// The axle's middle, in the scene's frame.
    pub pose: Pose,
}

/// Frames farther apart than this, ms, leave a gap across which nothing is interpolated.
pub const GAP_MS: f64 = 250.0;
