//! Decodes the relevant parts of ROS 2 messages from CDR.

use byteorder::{BigEndian, LittleEndian};
use cdr_encoding::from_bytes;
use serde::Deserialize;
use serde::de::DeserializeOwned;

use crate::streams::heading_rad;
use mindgap_foundations::geometry::{Pose as PlanarPose, wrap_rad};

/// The content of a message, in cm and rad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Decoded {
    /// Forward speed, cm/s, and turn rate to the left, rad/s.
    Twist([f64; 2]),
    /// A pose; `None` if it is invalid.
    Pose(Option<PlanarPose>),
    /// A reading, cm; `None` if there was no echo.
    Range(Option<f64>),
}

/// The result of decoding a message.
pub enum Message {
    /// For each frame, the suffix of the stream's name, the stamp (ms, if any) and the value.
    Decoded(Vec<(String, Option<f64>, Decoded)>),
    /// The bytes are not a message of the stated type.
    Undecodable,
    /// The message is of an irrelevant type.
    Ignored,
}

#[derive(Deserialize)]
struct Time {
    sec: i32,
    nanosec: u32,
}

#[derive(Deserialize)]
struct Header {
    stamp: Time,
    frame_id: String,
}

#[derive(Deserialize)]
struct Vector3 {
    x: f64,
    y: f64,
    z: f64,
}

#[derive(Deserialize)]
struct Quaternion {
    x: f64,
    y: f64,
    z: f64,
    w: f64,
}

#[derive(Deserialize)]
struct Twist {
    linear: Vector3,
    angular: Vector3,
}

#[derive(Deserialize)]
struct TwistStamped {
    header: Header,
    twist: Twist,
}

#[derive(Deserialize)]
struct Pose {
    position: Vector3,
    orientation: Quaternion,
}

/// Also decodes the prefix of a PoseWithCovarianceStamped.
#[derive(Deserialize)]
struct PoseStamped {
    header: Header,
    pose: Pose,
}

/// The prefix of an Odometry message.
#[derive(Deserialize)]
struct Odometry {
    header: Header,
    #[serde(rename = "child_frame_id")]
    _child_frame_id: String,
    pose: Pose,
}

#[derive(Deserialize)]
struct TransformStamped {
    header: Header,
    child_frame_id: String,
    translation: Vector3,
    rotation: Quaternion,
}

#[derive(Deserialize)]
struct TfMessage {
    transforms: Vec<TransformStamped>,
}

#[derive(Deserialize)]
struct Range {
    header: Header,
    #[serde(rename = "radiation_type")]
    _radiation_type: u8,
    #[serde(rename = "field_of_view")]
    _field_of_view: f32,
    min_range: f32,
    max_range: f32,
    range: f32,
}

#[derive(Deserialize)]
struct LaserScan {
    header: Header,
    angle_min: f32,
    #[serde(rename = "angle_max")]
    _angle_max: f32,
    angle_increment: f32,
    #[serde(rename = "time_increment")]
    _time_increment: f32,
    #[serde(rename = "scan_time")]
    _scan_time: f32,
    range_min: f32,
    range_max: f32,
    ranges: Vec<f32>,
}

/// Sanity limit on coordinates and speeds, m or m/s.
const MAX_COORDINATE_M: f64 = 1e4;

/// Decodes a message of type `schema`.
pub fn decode(schema: &str, data: &[u8], sonar_yaw_rad: f64) -> Message {
    let single = |content: Option<(Option<f64>, Decoded)>| match content {
        Some((stamp_ms, value)) => Message::Decoded(vec![(String::new(), stamp_ms, value)]),
        None => Message::Undecodable,
    };
    match schema {
        "geometry_msgs/msg/Twist" => single(cdr::<Twist>(data).and_then(|twist| Some((None, twist.decoded()?)))),
        "geometry_msgs/msg/TwistStamped" => {
            single(cdr::<TwistStamped>(data).and_then(|m| Some((m.header.ms(), m.twist.decoded()?))))
        }
        "geometry_msgs/msg/PoseStamped" | "geometry_msgs/msg/PoseWithCovarianceStamped" => {
            single(cdr::<PoseStamped>(data).map(|m| (m.header.ms(), m.pose.decoded())))
        }
        "nav_msgs/msg/Odometry" => single(cdr::<Odometry>(data).map(|m| (m.header.ms(), m.pose.decoded()))),
        "tf2_msgs/msg/TFMessage" => cdr::<TfMessage>(data).map_or(Message::Undecodable, |message| {
            Message::Decoded(message.transforms.into_iter().map(TransformStamped::decoded).collect())
        }),
        "sensor_msgs/msg/Range" => single(cdr::<Range>(data).map(|m| (m.header.ms(), m.decoded()))),
        "sensor_msgs/msg/LaserScan" => {
            single(cdr::<LaserScan>(data).map(|m| (m.header.ms(), m.decoded(sonar_yaw_rad))))
        }
        _ => Message::Ignored,
    }
}

/// Decodes plain CDR of either byte order, after its four-byte encapsulation header.
fn cdr<T: DeserializeOwned>(data: &[u8]) -> Option<T> {
    match data.split_first_chunk::<4>()? {
        ([0, 1, ..], body) => from_bytes::<T, LittleEndian>(body).ok().map(|(message, _)| message),
        ([0, 0, ..], body) => from_bytes::<T, BigEndian>(body).ok().map(|(message, _)| message),
        _ => None,
    }
}

impl Header {
    /// Returns the stamp, ms, or `None` if it is zero.
    fn ms(&self) -> Option<f64> {
        let Time { sec, nanosec } = self.stamp;
        (sec != 0 || nanosec != 0).then(|| 1e3 * f64::from(sec) + f64::from(nanosec) / 1e6)
    }
}

impl Twist {
    fn decoded(&self) -> Option<Decoded> {
        let [v, w] = [self.linear.x, self.angular.z];
        let is_plausible = v.abs() < MAX_COORDINATE_M && w.abs() < MAX_COORDINATE_M;
        is_plausible.then_some(Decoded::Twist([100.0 * v, w]))
    }
}

impl Pose {
    fn decoded(&self) -> Decoded {
        Decoded::Pose(planar(&self.position, &self.orientation))
    }
}

impl TransformStamped {
    fn decoded(self) -> (String, Option<f64>, Decoded) {
        let plain = |frame: &str| frame.trim_start_matches('/').to_owned();
        let name = format!(":{}>{}", plain(&self.header.frame_id), plain(&self.child_frame_id));
        (name, self.header.ms(), Decoded::Pose(planar(&self.translation, &self.rotation)))
    }
}

impl Range {
    fn decoded(&self) -> Decoded {
        let is_echo =
            self.range.is_finite() && self.range > 0.0 && (self.min_range..=self.max_range).contains(&self.range);
        Decoded::Range(is_echo.then(|| 100.0 * f64::from(self.range)))
    }
}

impl LaserScan {
    /// Returns the reading of the beam nearest to a direction.
    fn decoded(&self, yaw_rad: f64) -> Decoded {
        let distance_rad = |i: usize| {
            let beam_rad = f64::from(self.angle_min) + i as f64 * f64::from(self.angle_increment);
            wrap_rad(beam_rad - yaw_rad).abs()
        };
        let nearest = (0..self.ranges.len()).min_by(|a, b| distance_rad(*a).total_cmp(&distance_rad(*b)));
        // A direction beyond the outermost beam is not covered.
        let nearest = nearest.filter(|i| distance_rad(*i) <= f64::from(self.angle_increment).abs().max(0.05));
        let range = nearest.map(|i| self.ranges[i]).filter(|r| r.is_finite() && *r > 0.0);
        let range = range.filter(|r| (self.range_min..=self.range_max).contains(r));
        Decoded::Range(range.map(|r| 100.0 * f64::from(r)))
    }
}

fn planar(at: &Vector3, rotation: &Quaternion) -> Option<PlanarPose> {
    let heading_rad = heading_rad(rotation.x, rotation.y, rotation.z, rotation.w)?;
    let is_plausible = at.x.abs() < MAX_COORDINATE_M && at.y.abs() < MAX_COORDINATE_M && at.z.is_finite();
    is_plausible.then(|| PlanarPose::new(100.0 * at.x, 100.0 * at.y, heading_rad))
}
