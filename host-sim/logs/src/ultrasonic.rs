//! Where a range sensor sits on the robot, and what it can report.

use glam::DVec2;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use mindgap_foundations::geometry::Pose;

/// Mounting and range of the ultrasonic sensor.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Ultrasonic {
    /// Distance ahead of the centre of the axle, cm.
    pub x_cm: f64,
    /// Distance to the left of the centre of the axle, cm.
    pub y_cm: f64,
    /// Direction of its axis, degrees counter-clockwise from straight ahead.
    pub yaw_deg: f64,
    /// Smallest reading, cm.
    pub min_cm: f64,
    /// Largest reading, cm.
    pub max_cm: f64,
}

impl Ultrasonic {
    pub(super) fn is_possible(&self) -> bool {
        let is_within = [self.x_cm, self.y_cm, self.yaw_deg, self.max_cm].iter().all(|v| v.abs() < 1e5);
        is_within && (0.0..self.max_cm).contains(&self.min_cm)
    }

    /// Its least and its largest reading, cm.
    pub fn range_cm(&self) -> [f64; 2] {
        [self.min_cm, self.max_cm]
    }

    /// Returns the pose of the sensor on a robot at `robot`; its heading is the direction of the axis.
    pub fn pose_on(&self, robot: &Pose) -> Pose {
        robot.compose(&Pose { position_cm: DVec2::new(self.x_cm, self.y_cm), heading_rad: self.yaw_deg.to_radians() })
    }
}
