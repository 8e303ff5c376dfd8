//! Messages of ROS 2: what of them matters, decoded from CDR.

use byteorder::{BigEndian, LittleEndian};
use cdr_encoding::from_bytes;
use serde::Deserialize;
use serde::de::DeserializeOwned;

use crate::streams::heading_rad;
use mindgap_foundations::geometry::{Pose as PlanarPose, wrap_rad};

/// What a message says, in cm and rad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Decoded {
    /// Speed ahead, cm/s, and turn rate to the left, rad/s.
    Twist([f64; 2]),
    /// A pose; `None` where it is none.
    Pose(Option<PlanarPose>),
    /// A reading, cm; `None` where there was no echo.
    Range(Option<f64>),
}

/// What became of a message.
pub enum Message {
    /// What it says: for each frame the end of its name, its stamp (ms, if it has one) and the value.
    Of(Vec<(String, Option<f64>, Decoded)>),
    /// Its bytes are no message of its type.
    Broken,
    /// It is of another type.
    OfNoInterest,
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

/// Also the begin of a pose with covariance.
#[derive(Deserialize)]
struct PoseStamped {
    header: Header,
    pose: Pose,
}

/// The begin of one.
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

/// Coordinates beyond this are no robot's, m.
const FARTHEST_M: f64 = 1e4;

/// Decodes a message of a type.
pub fn decode(schema: &str, data: &[u8], sonar_yaw_rad: f64) -> Message {
    let one = |said: Option<(Option<f64>, Decoded)>| match said {
        Some((stamp_ms, value)) => Message::Of(vec![(String::new(), stamp_ms, value)]),
        None => Message::Broken,
    };
    match schema {
        "geometry_msgs/msg/Twist" => one(cdr::<Twist>(data).and_then(|twist| Some((None, twist.decoded()?)))),
        "geometry_msgs/msg/TwistStamped" => {
            one(cdr::<TwistStamped>(data).and_then(|m| Some((m.header.ms(), m.twist.decoded()?))))
        }
        "geometry_msgs/msg/PoseStamped" | "geometry_msgs/msg/PoseWithCovarianceStamped" => {
            one(cdr::<PoseStamped>(data).map(|m| (m.header.ms(), m.pose.decoded())))
        }
        "nav_msgs/msg/Odometry" => one(cdr::<Odometry>(data).map(|m| (m.header.ms(), m.pose.decoded()))),
        "tf2_msgs/msg/TFMessage" => cdr::<TfMessage>(data).map_or(Message::Broken, |message| {
            Message::Of(message.transforms.into_iter().map(TransformStamped::decoded).collect())
        }),
        "sensor_msgs/msg/Range" => one(cdr::<Range>(data).map(|m| (m.header.ms(), m.decoded()))),
        "sensor_msgs/msg/LaserScan" => one(cdr::<LaserScan>(data).map(|m| (m.header.ms(), m.decoded(sonar_yaw_rad)))),
        _ => Message::OfNoInterest,
    }
}

/// Plain CDR after its four bytes of encapsulation, of either byte order.
fn cdr<T: DeserializeOwned>(data: &[u8]) -> Option<T> {
    match data.split_first_chunk::<4>()? {
        ([0, 1, ..], body) => from_bytes::<T, LittleEndian>(body).ok().map(|(message, _)| message),
        ([0, 0, ..], body) => from_bytes::<T, BigEndian>(body).ok().map(|(message, _)| message),
        _ => None,
    }
}

impl Header {
    /// The stamp, ms; none where it was left at zero.
    fn ms(&self) -> Option<f64> {
        let Time { sec, nanosec } = self.stamp;
        (sec != 0 || nanosec != 0).then(|| 1e3 * f64::from(sec) + f64::from(nanosec) / 1e6)
    }
}

impl Twist {
    fn decoded(&self) -> Option<Decoded> {
        let [v, w] = [self.linear.x, self.angular.z];
        let is_one = v.abs() < FARTHEST_M && w.abs() < FARTHEST_M;
        is_one.then_some(Decoded::Twist([100.0 * v, w]))
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
    /// The beam nearest to a direction.
    fn decoded(&self, yaw_rad: f64) -> Decoded {
        let off_rad = |i: usize| {
            let beam_rad = f64::from(self.angle_min) + i as f64 * f64::from(self.angle_increment);
            wrap_rad(beam_rad - yaw_rad).abs()
        };
        let nearest = (0..self.ranges.len()).min_by(|a, b| off_rad(*a).total_cmp(&off_rad(*b)));
        // Beside the outermost beam the scanner looks nowhere.
        let nearest = nearest.filter(|i| off_rad(*i) <= f64::from(self.angle_increment).abs().max(0.05));
        let range = nearest.map(|i| self.ranges[i]).filter(|r| r.is_finite() && *r > 0.0);
        let range = range.filter(|r| (self.range_min..=self.range_max).contains(r));
        Decoded::Range(range.map(|r| 100.0 * f64::from(r)))
    }
}

fn planar(at: &Vector3, turned: &Quaternion) -> Option<PlanarPose> {
    let heading_rad = heading_rad(turned.x, turned.y, turned.z, turned.w)?;
    let is_near = at.x.abs() < FARTHEST_M && at.y.abs() < FARTHEST_M && at.z.is_finite();
    is_near.then(|| PlanarPose::new(100.0 * at.x, 100.0 * at.y, heading_rad))
}
