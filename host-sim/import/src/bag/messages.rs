//! Decodes the relevant parts of ROS messages: CDR of ROS 2, and the encoding of ROS 1.

mod fields;

use byteorder::{BigEndian, LittleEndian};
use cdr_encoding::from_bytes;
use glam::{DQuat, DVec3};
use roslibrust_serde_rosmsg::de::Deserializer as Ros1Deserializer;
use serde::de::DeserializeOwned;

use self::fields::{
    Clock, Header, Imu, JointState, LaserScan, Odometry, Pose, PoseStamped, Quaternion, Range, Ros1Header, Ros2Header,
    TfMessage, TransformStamped, Twist, TwistStamped, Vector3,
};
use crate::spatial_pose::SpatialPose;
use mindgap_foundations::geometry::wrap_rad;

/// The content of a message.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Decoded {
    /// A commanded or measured velocity.
    Twist {
        /// Forward speed, cm/s.
        ahead_cm_s: f64,
        /// Speed to the left, cm/s.
        left_cm_s: f64,
        /// Turn rate to the left, rad/s.
        turn_rad_s: f64,
    },
    /// A pose; `None` if it is invalid.
    Pose(Option<SpatialPose>),
    /// A reading.
    Range(Reading),
    /// The angle of a joint, rad.
    Angle(f64),
    /// What an IMU measures about its own axes.
    Inertial {
        /// Turn rates, rad/s.
        rate_rad_s: DVec3,
        /// Acceleration, which at rest points upwards, m/s².
        acceleration_m_s2: DVec3,
    },
    /// The time of a simulation, which is the stamp of the message.
    Clock,
}

/// A reading of a range sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reading {
    /// A distance within the limits that the message states, cm.
    Echo(f64),
    /// A distance in a message that states no limits, cm.
    Unlimited(f64),
    /// A distance outside the stated limits, cm.
    Outside(f64),
    /// No distance: zero, infinite or not a number, or a direction that the scan does not cover.
    None,
}

/// How messages are encoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Encoding {
    /// CDR, as in ROS 2.
    Cdr,
    /// The encoding of ROS 1.
    Ros1,
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

/// A message type that can be decoded.
#[derive(Clone, Copy)]
enum Known {
    Twist,
    TwistStamped,
    PoseStamped,
    Odometry,
    Transforms,
    Range,
    LaserScan,
    JointState,
    Imu,
    Clock,
}

/// A direction in which a laser scanner stands in for a range sensor.
pub struct Beam {
    /// Suffix of the stream's name.
    pub suffix: String,
    /// Direction, rad counter-clockwise from straight ahead.
    pub yaw_rad: f64,
}

/// Sanity limit on coordinates and speeds, m or m/s.
const MAX_COORDINATE_M: f64 = 1e4;

/// Returns a type's name as `package/msg/Type`, whatever its spelling: ROS 1 writes `package/Type`, DDS
/// `package::msg::dds_::Type_`.
pub fn full_name(schema: &str) -> String {
    let mut parts = schema.split(['/', ':']).filter(|part| !part.is_empty());
    match (parts.next(), parts.next_back()) {
        (Some(package), Some(name)) => format!("{package}/msg/{}", name.trim_end_matches('_')),
        _ => schema.to_owned(),
    }
}

/// Returns whether messages of a type, named by [`full_name`], can be decoded.
pub fn is_relevant(schema: &str) -> bool {
    known(schema).is_some()
}

fn known(schema: &str) -> Option<Known> {
    Some(match schema {
        "geometry_msgs/msg/Twist" => Known::Twist,
        "geometry_msgs/msg/TwistStamped" => Known::TwistStamped,
        "geometry_msgs/msg/PoseStamped" | "geometry_msgs/msg/PoseWithCovarianceStamped" => Known::PoseStamped,
        "nav_msgs/msg/Odometry" => Known::Odometry,
        "tf2_msgs/msg/TFMessage" | "tf/msg/tfMessage" => Known::Transforms,
        "sensor_msgs/msg/Range" => Known::Range,
        "sensor_msgs/msg/LaserScan" => Known::LaserScan,
        "sensor_msgs/msg/JointState" => Known::JointState,
        "sensor_msgs/msg/Imu" => Known::Imu,
        "rosgraph_msgs/msg/Clock" => Known::Clock,
        _ => return None,
    })
}

/// Decodes a message whose type is named by [`full_name`].
pub fn decode(schema: &str, encoding: Encoding, data: &[u8], beams: &[Beam]) -> Message {
    let Some(known) = known(schema) else { return Message::Ignored };
    let decoded = match encoding {
        Encoding::Cdr => decoded::<Cdr>(known, data, beams),
        Encoding::Ros1 => decoded::<Ros1>(known, data, beams),
    };
    decoded.map_or(Message::Undecodable, Message::Decoded)
}

/// An encoding of messages.
trait Format {
    /// The header that its messages have.
    type Header: Header + DeserializeOwned;

    fn parse<T: DeserializeOwned>(data: &[u8]) -> Option<T>;
}

struct Cdr;

impl Format for Cdr {
    type Header = Ros2Header;

    /// Decodes plain CDR of either byte order, after its four-byte encapsulation header.
    fn parse<T: DeserializeOwned>(data: &[u8]) -> Option<T> {
        match data.split_first_chunk::<4>()? {
            ([0, 1, ..], body) => from_bytes::<T, LittleEndian>(body).ok().map(|(message, _)| message),
            ([0, 0, ..], body) => from_bytes::<T, BigEndian>(body).ok().map(|(message, _)| message),
            _ => None,
        }
    }
}

struct Ros1;

impl Format for Ros1 {
    type Header = Ros1Header;

    fn parse<T: DeserializeOwned>(data: &[u8]) -> Option<T> {
        T::deserialize(&mut Ros1Deserializer::new(data, u32::try_from(data.len()).ok()?)).ok()
    }
}

fn decoded<F: Format>(known: Known, data: &[u8], beams: &[Beam]) -> Option<Vec<(String, Option<f64>, Decoded)>> {
    let single = |stamp_ms: Option<f64>, value| vec![(String::new(), stamp_ms, value)];
    let stamp = |header: &F::Header| Some(header.stamp_ms()).filter(|ms| *ms != 0.0);
    Some(match known {
        Known::Twist => single(None, F::parse::<Twist>(data)?.decoded()?),
        Known::TwistStamped => {
            let message = F::parse::<TwistStamped<F::Header>>(data)?;
            single(stamp(&message.header), message.twist.decoded()?)
        }
        Known::PoseStamped => {
            let message = F::parse::<PoseStamped<F::Header>>(data)?;
            single(stamp(&message.header), message.pose.decoded())
        }
        Known::Odometry => {
            let message = F::parse::<Odometry<F::Header>>(data)?;
            single(stamp(&message.header), message.pose.decoded())
        }
        Known::Transforms => {
            let transform = |transform: TransformStamped<F::Header>| {
                let value = Decoded::Pose(in_space(&transform.translation, &transform.rotation));
                (transform.frames(), stamp(&transform.header), value)
            };
            F::parse::<TfMessage<F::Header>>(data)?.transforms.into_iter().map(transform).collect()
        }
        Known::Range => {
            let message = F::parse::<Range<F::Header>>(data)?;
            // One topic may hold several sensors, each with its frame.
            vec![(of_part(message.header.frame()), stamp(&message.header), Decoded::Range(message.reading()))]
        }
        Known::LaserScan => {
            let message = F::parse::<LaserScan<F::Header>>(data)?;
            let stamp_ms = stamp(&message.header);
            let reading = |beam: &Beam| (beam.suffix.clone(), stamp_ms, Decoded::Range(message.reading(beam.yaw_rad)));
            beams.iter().map(reading).collect()
        }
        Known::JointState => {
            let message = F::parse::<JointState<F::Header>>(data)?;
            let stamp_ms = stamp(&message.header);
            let joints = message.name.iter().zip(&message.position).filter(|(_, rad)| rad.is_finite());
            joints.map(|(name, rad)| (of_part(name), stamp_ms, Decoded::Angle(*rad))).collect()
        }
        Known::Imu => {
            let message = F::parse::<Imu<F::Header>>(data)?;
            message.decoded().map(|value| (String::new(), stamp(&message.header), value)).into_iter().collect()
        }
        Known::Clock => single(Some(F::parse::<Clock>(data)?.clock.ms()), Decoded::Clock),
    })
}

impl Twist {
    fn decoded(&self) -> Option<Decoded> {
        let [ahead, left, turn_rad_s] = [self.linear.x, self.linear.y, self.angular.z];
        let is_plausible = ahead.abs() < MAX_COORDINATE_M && turn_rad_s.abs() < MAX_COORDINATE_M;
        // A sideways speed is only reported.
        let left_cm_s = if left.abs() < MAX_COORDINATE_M { 100.0 * left } else { 0.0 };
        is_plausible.then_some(Decoded::Twist { ahead_cm_s: 100.0 * ahead, left_cm_s, turn_rad_s })
    }
}

impl Pose {
    fn decoded(&self) -> Decoded {
        Decoded::Pose(in_space(&self.position, &self.orientation))
    }
}

impl<H: Header> TransformStamped<H> {
    /// Returns the suffix of the stream's name: parent and child frame.
    fn frames(&self) -> String {
        let plain = |frame: &str| frame.trim_start_matches('/').to_owned();
        of_part(&format!("{}>{}", plain(self.header.frame()), plain(&self.child_frame_id)))
    }
}

/// Returns the suffix of the name of a stream that is a part of its topic.
pub fn of_part(name: &str) -> String {
    format!(":{name}")
}

impl<H> Imu<H> {
    /// Returns what it measured; `None` if it has no gyro.
    fn decoded(&self) -> Option<Decoded> {
        let space = |v: &Vector3| DVec3::new(v.x, v.y, v.z);
        let rate_rad_s = space(&self.angular_velocity);
        // A variance of -1 stands for a quantity that is not measured.
        let is_measured = self.angular_velocity_covariance[0] != -1.0 && rate_rad_s.is_finite();
        let acceleration_m_s2 = space(&self.linear_acceleration);
        is_measured.then_some(Decoded::Inertial { rate_rad_s, acceleration_m_s2 })
    }
}

impl<H> Range<H> {
    fn reading(&self) -> Reading {
        Reading::of(self.range, [self.min_range, self.max_range])
    }
}

impl<H> LaserScan<H> {
    /// Returns the reading of the beam nearest to a direction.
    fn reading(&self, yaw_rad: f64) -> Reading {
        let distance_rad = |i: usize| {
            let beam_rad = f64::from(self.angle_min) + i as f64 * f64::from(self.angle_increment);
            wrap_rad(beam_rad - yaw_rad).abs()
        };
        let nearest = (0..self.ranges.len()).min_by(|a, b| distance_rad(*a).total_cmp(&distance_rad(*b)));
        // A direction beyond the outermost beam is not covered.
        let nearest = nearest.filter(|i| distance_rad(*i) <= f64::from(self.angle_increment).abs().max(0.05));
        nearest.map_or(Reading::None, |i| Reading::of(self.ranges[i], [self.range_min, self.range_max]))
    }
}

impl Reading {
    /// Judges a distance by limits, all in metres and in the precision of the message.
    fn of(range_m: f32, [min_m, max_m]: [f32; 2]) -> Self {
        let cm = 100.0 * f64::from(range_m);
        if !range_m.is_finite() || range_m == 0.0 || cm.abs() > 100.0 * MAX_COORDINATE_M {
            Reading::None
        } else if min_m >= max_m || min_m.is_nan() || max_m.is_nan() {
            // Drivers that never set the limits publish zeros.
            Reading::Unlimited(cm)
        } else if (min_m..=max_m).contains(&range_m) {
            Reading::Echo(cm)
        } else {
            Reading::Outside(cm)
        }
    }
}

fn in_space(at: &Vector3, rotation: &Quaternion) -> Option<SpatialPose> {
    let at_m = DVec3::new(at.x, at.y, at.z);
    let rotation = DQuat::from_xyzw(rotation.x, rotation.y, rotation.z, rotation.w);
    let is_plausible = at_m.abs().max_element() < MAX_COORDINATE_M && at_m.is_finite();
    let length2 = rotation.length_squared();
    (is_plausible && length2.is_finite() && length2 > 1e-6)
        .then(|| SpatialPose { at_cm: 100.0 * at_m, rotation: rotation.normalize() })
}
