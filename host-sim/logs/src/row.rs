//! One row of `run-*.csv` (docs/reference/formats.md).

use mindgap_foundations::geometry::Pose;

/// One row of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Row {
    /// Time since the start of the run, ms.
    pub t_ms: f64,
    /// Command of the left motor, set at this row and held until the next, -100..=100.
    pub left: f64,
    /// Command of the right motor, set at this row and held until the next, -100..=100.
    pub right: f64,
    /// Tracked pose of the centre of the axle; `None` if the tracker lost the robot.
    pub pose: Option<Pose>,
    /// Ultrasonic reading, cm; `None` if the sensor produced no value.
    pub echo_cm: Option<f64>,
    /// Rotation counter of the left motor, degrees.
    pub rot_left_deg: Option<f64>,
    /// Rotation counter of the right motor, degrees.
    pub rot_right_deg: Option<f64>,
    /// Battery voltage, millivolts.
    pub battery_mv: Option<f64>,
    /// Yaw rate measured on the robot, counter-clockwise positive, degrees per second.
    pub gyro_deg_s: Option<f64>,
}

impl Row {
    /// Returns the left and right command.
    pub fn command(&self) -> [f64; 2] {
        [self.left, self.right]
    }
}
