//! The fields of ROS messages, as far as they are needed; fields after the last needed one are omitted.

use serde::Deserialize;

/// A header, with its time in ms; zero if it was never set.
pub trait Header {
    fn stamp_ms(&self) -> f64;
    fn frame(&self) -> &str;
}

#[derive(Deserialize)]
pub struct Time {
    sec: u32,
    nanosec: u32,
}

/// The header of ROS 2.
#[derive(Deserialize)]
pub struct Ros2Header {
    stamp: Time,
    frame_id: String,
}

/// The header of ROS 1, which counts messages.
#[derive(Deserialize)]
pub struct Ros1Header {
    #[serde(rename = "seq")]
    _sequence: u32,
    stamp: Time,
    frame_id: String,
}

#[derive(Deserialize)]
pub struct Clock {
    pub clock: Time,
}

#[derive(Deserialize)]
pub struct Vector3 {
    pub x: f64,
    pub y: f64,
    pub z: f64,
}

#[derive(Deserialize)]
pub struct Quaternion {
    pub x: f64,
    pub y: f64,
    pub z: f64,
    pub w: f64,
}

#[derive(Deserialize)]
pub struct Twist {
    pub linear: Vector3,
    pub angular: Vector3,
}

#[derive(Deserialize)]
pub struct TwistStamped<H> {
    pub header: H,
    pub twist: Twist,
}

#[derive(Deserialize)]
pub struct Pose {
    pub position: Vector3,
    pub orientation: Quaternion,
}

/// Also the prefix of a PoseWithCovarianceStamped.
#[derive(Deserialize)]
pub struct PoseStamped<H> {
    pub header: H,
    pub pose: Pose,
}

#[derive(Deserialize)]
pub struct Odometry<H> {
    pub header: H,
    #[serde(rename = "child_frame_id")]
    _child_frame_id: String,
    pub pose: Pose,
}

#[derive(Deserialize)]
pub struct TransformStamped<H> {
    pub header: H,
    pub child_frame_id: String,
    pub translation: Vector3,
    pub rotation: Quaternion,
}

#[derive(Deserialize)]
pub struct TfMessage<H> {
    pub transforms: Vec<TransformStamped<H>>,
}

#[derive(Deserialize)]
pub struct Range<H> {
    pub header: H,
    #[serde(rename = "radiation_type")]
    _radiation_type: u8,
    #[serde(rename = "field_of_view")]
    _field_of_view: f32,
    pub min_range: f32,
    pub max_range: f32,
    pub range: f32,
}

#[derive(Deserialize)]
pub struct LaserScan<H> {
    pub header: H,
    pub angle_min: f32,
    #[serde(rename = "angle_max")]
    _angle_max: f32,
    pub angle_increment: f32,
    #[serde(rename = "time_increment")]
    _time_increment: f32,
    #[serde(rename = "scan_time")]
    _scan_time: f32,
    pub range_min: f32,
    pub range_max: f32,
    pub ranges: Vec<f32>,
}

#[derive(Deserialize)]
pub struct JointState<H> {
    pub header: H,
    pub name: Vec<String>,
    pub position: Vec<f64>,
}

#[derive(Deserialize)]
pub struct Imu<H> {
    pub header: H,
    #[serde(rename = "orientation")]
    _orientation: Quaternion,
    #[serde(rename = "orientation_covariance")]
    _orientation_covariance: [f64; 9],
    pub angular_velocity: Vector3,
    pub angular_velocity_covariance: [f64; 9],
    pub linear_acceleration: Vector3,
}

impl Time {
    pub fn ms(&self) -> f64 {
        1e3 * f64::from(self.sec) + f64::from(self.nanosec) / 1e6
    }
}

impl Header for Ros2Header {
    fn stamp_ms(&self) -> f64 {
        self.stamp.ms()
    }

    fn frame(&self) -> &str {
        &self.frame_id
    }
}

impl Header for Ros1Header {
    fn stamp_ms(&self) -> f64 {
        self.stamp.ms()
    }

    fn frame(&self) -> &str {
        &self.frame_id
    }
}
