//! Camera frames: timed poses of the robot.

use mindgap_foundations::geometry::Pose;

/// A camera frame that shows the robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Time on the camera's clock, ms.
    pub t_ms: f64,
    /// Pose of the centre of the axle, in the scene's frame.
    pub pose: Pose,
}

/// Frames farther apart than this, ms, leave a gap that is not interpolated.
pub const GAP_MS: f64 = 250.0;
