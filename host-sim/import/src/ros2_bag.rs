//! Writes ROS 2 bags in MCAP: commands to drive a simulator with, and drives to look at in Foxglove, PlotJuggler or Rerun.

use std::collections::BTreeMap;
use std::io::Cursor;

use byteorder::LittleEndian;
use mcap::records::MessageHeader;
use mcap::{McapResult, WriteOptions, Writer};
use serde::Serialize;

use mindgap_foundations::geometry::Pose;

/// A bag in memory. Messages are written in the order of their times.
pub struct Bag {
    writer: Writer<Cursor<Vec<u8>>>,
    channel_by_topic: BTreeMap<String, u16>,
    messages: u32,
}

/// The content of a message.
pub enum Content<'a> {
    /// A commanded velocity, as `geometry_msgs/msg/Twist`.
    Twist {
        /// Forward speed, cm/s.
        forward_cm_s: f64,
        /// Turn rate to the left, rad/s.
        turn_rad_s: f64,
    },
    /// A pose on the floor, as `geometry_msgs/msg/PoseStamped`.
    Pose(Pose),
    /// Poses on the floor, each with its time in ms, as `nav_msgs/msg/Path`.
    Path(&'a [(f64, Pose)]),
    /// A pose seen from another, as `geometry_msgs/msg/Vector3Stamped`: metres ahead, metres to the left, radians to the left.
    Difference(Pose),
    /// A distance, cm, as `std_msgs/msg/Float64` in metres.
    Distance(f64),
    /// A text, as `std_msgs/msg/String`.
    Text(&'a str),
}

/// Name of the program in the headers of its bags.
const LIBRARY: &str = concat!("mindgap ", env!("CARGO_PKG_VERSION"));
/// Header of little-endian CDR.
const CDR: [u8; 4] = [0, 1, 0, 0];
/// Frame of all poses.
const FRAME: &str = "map";
/// Line between the definitions of a type and of those that it contains.
const RULE: &str = "================================================================================\n";

const HEADER: [&str; 2] = [
    "MSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n",
    "MSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n",
];
const VECTOR: &str = "MSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n";
const POSE: [&str; 3] = [
    "MSG: geometry_msgs/Pose\ngeometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n",
    "MSG: geometry_msgs/Point\nfloat64 x\nfloat64 y\nfloat64 z\n",
    "MSG: geometry_msgs/Quaternion\nfloat64 x\nfloat64 y\nfloat64 z\nfloat64 w\n",
];

#[derive(Serialize)]
struct Header {
    sec: i32,
    nanosec: u32,
    frame_id: &'static str,
}

#[derive(Serialize)]
struct PoseStamped {
    header: Header,
    position: [f64; 3],
    orientation: [f64; 4],
}

/// Returns whether a file is a bag that this program wrote, from its first bytes.
pub fn is_own(content: &[u8]) -> bool {
    const BEGINNING: usize = 64;
    let beginning = &content[..content.len().min(BEGINNING)];
    beginning.starts_with(mcap::MAGIC) && beginning.windows(LIBRARY.len()).any(|part| part == LIBRARY.as_bytes())
}

impl Default for Bag {
    fn default() -> Self {
        let options = WriteOptions::new().profile("ros2").library(LIBRARY).compression(None);
        let writer = Writer::with_options(Cursor::default(), options).expect("writing to memory does not fail");
        Bag { writer, channel_by_topic: BTreeMap::new(), messages: 0 }
    }
}

impl Bag {
    /// Adds a message at a time of the bag, ms.
    pub fn write(&mut self, topic: &str, t_ms: f64, content: &Content) {
        self.try_write(topic, t_ms, content).expect("writing to memory does not fail");
    }

    /// Returns the bytes of the bag.
    pub fn finish(mut self) -> Vec<u8> {
        self.writer.finish().expect("writing to memory does not fail");
        self.writer.into_inner().into_inner()
    }

    fn try_write(&mut self, topic: &str, t_ms: f64, content: &Content) -> McapResult<()> {
        let channel_id = match self.channel_by_topic.get(topic) {
            Some(channel) => *channel,
            None => self.channel(topic, content)?,
        };
        let time = (t_ms * 1e6) as u64;
        let header = MessageHeader { channel_id, sequence: self.messages, log_time: time, publish_time: time };
        self.messages += 1;
        self.writer.write_to_known_channel(&header, &content.encoded(t_ms))
    }

    fn channel(&mut self, topic: &str, content: &Content) -> McapResult<u16> {
        let (name, definition) = content.schema();
        let schema = self.writer.add_schema(name, "ros2msg", definition.as_bytes())?;
        let channel = self.writer.add_channel(schema, topic, "cdr", &BTreeMap::new())?;
        self.channel_by_topic.insert(topic.into(), channel);
        Ok(channel)
    }
}

impl Content<'_> {
    /// The name of the type and its definition.
    fn schema(&self) -> (&'static str, String) {
        const POSE_STAMPED: &str = "std_msgs/Header header\ngeometry_msgs/Pose pose\n";
        let of_poses = [&HEADER[..], &POSE].concat();
        let (name, fields, parts) = match self {
            Content::Twist { .. } => (
                "geometry_msgs/msg/Twist",
                "geometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular\n",
                vec![VECTOR.into()],
            ),
            Content::Pose(_) => ("geometry_msgs/msg/PoseStamped", POSE_STAMPED, owned(&of_poses)),
            Content::Path(_) => {
                let pose_stamped = format!("MSG: geometry_msgs/PoseStamped\n{POSE_STAMPED}");
                let parts = [vec![pose_stamped], owned(&of_poses)].concat();
                ("nav_msgs/msg/Path", "std_msgs/Header header\ngeometry_msgs/PoseStamped[] poses\n", parts)
            }
            Content::Difference(_) => {
                let fields = "std_msgs/Header header\ngeometry_msgs/Vector3 vector\n";
                ("geometry_msgs/msg/Vector3Stamped", fields, owned(&[&HEADER[..], &[VECTOR]].concat()))
            }
            Content::Distance(_) => ("std_msgs/msg/Float64", "float64 data\n", Vec::new()),
            Content::Text(_) => ("std_msgs/msg/String", "string data\n", Vec::new()),
        };
        (name, parts.iter().fold(fields.to_owned(), |text, part| text + RULE + part))
    }

    fn encoded(&self, t_ms: f64) -> Vec<u8> {
        match self {
            Content::Twist { forward_cm_s, turn_rad_s } => {
                cdr(&([forward_cm_s / 100.0, 0.0, 0.0], [0.0, 0.0, *turn_rad_s]))
            }
            Content::Pose(pose) => cdr(&PoseStamped::of(t_ms, pose)),
            Content::Path(poses) => {
                let poses: Vec<PoseStamped> = poses.iter().map(|(t_ms, pose)| PoseStamped::of(*t_ms, pose)).collect();
                cdr(&(Header::at(t_ms), poses))
            }
            Content::Difference(pose) => {
                let ahead_m = pose.position_cm / 100.0;
                cdr(&(Header::at(t_ms), [ahead_m.x, ahead_m.y, pose.heading_rad]))
            }
            Content::Distance(cm) => cdr(&(cm / 100.0)),
            Content::Text(text) => cdr(text),
        }
    }
}

impl Header {
    fn at(t_ms: f64) -> Self {
        let nanoseconds = (t_ms * 1e6) as u64;
        let (sec, nanosec) = (nanoseconds / 1_000_000_000, nanoseconds % 1_000_000_000);
        Header { sec: sec as i32, nanosec: nanosec as u32, frame_id: FRAME }
    }
}

impl PoseStamped {
    fn of(t_ms: f64, pose: &Pose) -> Self {
        let at_m = pose.position_cm / 100.0;
        let (sin, cos) = (libm::sin(pose.heading_rad / 2.0), libm::cos(pose.heading_rad / 2.0));
        PoseStamped { header: Header::at(t_ms), position: [at_m.x, at_m.y, 0.0], orientation: [0.0, 0.0, sin, cos] }
    }
}

fn owned(parts: &[&str]) -> Vec<String> {
    parts.iter().map(|part| (*part).to_owned()).collect()
}

fn cdr(content: &impl Serialize) -> Vec<u8> {
    let encoded = cdr_encoding::to_vec::<_, LittleEndian>(content).expect("numbers and texts have a form in CDR");
    [&CDR[..], &encoded].concat()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commands_are_read_back() {
        let mut bag = Bag::default();
        for (t_ms, forward_cm_s, turn_rad_s) in [(0.0, 25.0, -1.0), (400.0, 0.0, 0.0)] {
            bag.write("/cmd_vel", t_ms, &Content::Twist { forward_cm_s, turn_rad_s });
        }
        let bytes = bag.finish();
        assert!(is_own(&bytes) && !is_own(b"") && !is_own(mcap::MAGIC));
        let messages: Vec<mcap::Message> =
            mcap::MessageStream::new(&bytes).expect("a bag").map(|m| m.expect("a message")).collect();
        assert_eq!((messages.len(), messages[1].log_time), (2, 400_000_000));
        assert_eq!(messages[0].data[4..12], 0.25f64.to_le_bytes());
        assert_eq!(messages[0].data[44..52], (-1.0f64).to_le_bytes());
    }

    #[test]
    fn numbers_behind_texts_are_aligned() {
        let data = Content::Pose(Pose::new(150.0, 0.0, 0.0)).encoded(1500.0);
        assert_eq!(data[4..12], [1, 0, 0, 0, 0x00, 0x65, 0xcd, 0x1d], "one second and half of one in nanoseconds");
        assert_eq!((&data[12..16], &data[16..20]), (&4u32.to_le_bytes()[..], &b"map\0"[..]));
        assert_eq!(data[20..28], 1.5f64.to_le_bytes(), "16 bytes of header are a multiple of eight");
        assert_eq!(Content::Text("a").encoded(0.0)[4..], [2, 0, 0, 0, b'a', 0]);
    }
}
