//! What a step does to the pose, as seen from the robot.

use glam::DVec2;

use mindgap_foundations::geometry::{Pose, direction};

/// The change of pose over a step in the robot's own frame at its begin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoseIncrement {
    /// Forward, cm.
    pub forward_cm: f64,
    /// To the left, cm.
    pub lateral_cm: f64,
    /// Counter-clockwise.
    pub turn_rad: f64,
}

impl PoseIncrement {
    /// From one pose to another.
    pub fn between(from: &Pose, to: &Pose) -> Self {
        let Pose { position_cm, heading_rad } = from.relative(to);
        PoseIncrement { forward_cm: position_cm.x, lateral_cm: position_cm.y, turn_rad: heading_rad }
    }

    /// The pose to which it leads.
    pub fn from(&self, pose: &Pose) -> Pose {
        pose.compose(&Pose::new(self.forward_cm, self.lateral_cm, self.turn_rad))
    }

    /// Scales translation and turn alike.
    pub fn scale(&mut self, factor: f64) {
        self.forward_cm *= factor;
        self.lateral_cm *= factor;
        self.turn_rad *= factor;
    }

    /// Rotates the translation and leaves the turn.
    pub fn rotate_translation(&mut self, angle_rad: f64) {
        let translation = direction(angle_rad).rotate(DVec2::new(self.forward_cm, self.lateral_cm));
        (self.forward_cm, self.lateral_cm) = (translation.x, translation.y);
    }

    /// Distances that the left and right wheel cover, for a distance of `track_cm` between them.
    pub fn wheels_cm(&self, track_cm: f64) -> [f64; 2] {
        let half = 0.5 * track_cm * self.turn_rad;
        [self.forward_cm - half, self.forward_cm + half]
    }

    /// Sets forward and turn from the distances that the wheels cover.
    pub fn set_wheels(&mut self, [left, right]: [f64; 2], track_cm: f64) {
        self.forward_cm = 0.5 * (left + right);
        self.turn_rad = (right - left) / track_cm;
    }
}
