//! Reads intact and corrupt bags written by the `mcap` crate.

use std::collections::BTreeMap;
use std::fs;
use std::io::Cursor;

use ::mcap::records::MessageHeader;
use ::mcap::{Compression, WriteOptions, Writer};
use byteorder::LittleEndian;
use proptest::prelude::*;
use serde::Serialize;

use super::*;

mod containers;
mod own_motion;
mod ranges;

const TWIST: &str = "geometry_msgs/msg/Twist";
const POSE: &str = "geometry_msgs/msg/PoseStamped";

/// A message in little-endian CDR.
fn cdr(message: &impl Serialize) -> Vec<u8> {
    let body = cdr_encoding::to_vec::<_, LittleEndian>(message).expect("numbers and strings");
    [&[0, 1, 0, 0], body.as_slice()].concat()
}

fn twist(v_m_s: f64, w_rad_s: f64) -> Vec<u8> {
    cdr(&([v_m_s, 0.0, 0.0], [0.0, 0.0, w_rad_s]))
}

fn pose(s: f64, x_m: f64) -> Vec<u8> {
    let stamp = (s as i32, ((s - s.floor()) * 1e9) as u32);
    cdr(&((stamp, "map"), [x_m, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]))
}

/// A bag of messages: topic, type, time in s, bytes.
fn bag(compression: Option<Compression>, messages: &[(&str, &str, f64, Vec<u8>)]) -> Vec<u8> {
    bag_encoded("cdr", compression, messages)
}

fn bag_encoded(encoding: &str, compression: Option<Compression>, messages: &[(&str, &str, f64, Vec<u8>)]) -> Vec<u8> {
    let options = WriteOptions::new().compression(compression).chunk_size(Some(2000)).profile("ros2");
    let mut writer = Writer::with_options(Cursor::new(Vec::new()), options).expect("memory");
    let mut channels = BTreeMap::new();
    for (sequence, (topic, schema, s, data)) in messages.iter().enumerate() {
        let id = *channels.entry((*topic, *schema)).or_insert_with(|| {
            let schema = writer.add_schema(schema, "ros2msg", b"").expect("a schema");
            writer.add_channel(schema, topic, encoding, &BTreeMap::new()).expect("a channel")
        });
        let log_time = (s * 1e9) as u64;
        let header = MessageHeader { channel_id: id, sequence: sequence as u32, log_time, publish_time: log_time };
        writer.write_to_known_channel(&header, data).expect("memory");
    }
    writer.finish().expect("memory");
    writer.into_inner().into_inner()
}

/// A drive straight ahead.
fn drive(compression: Option<Compression>) -> Vec<u8> {
    let messages = (0..100).flat_map(|i| {
        let s = 1000.0 + 0.05 * f64::from(i);
        [
            ("/cmd_vel", TWIST, s, twist(0.2, 0.1)),
            ("/robot/pose", POSE, s + 0.01, pose(s, 0.01 * f64::from(i))),
            ("/goal_pose", POSE, s, pose(s, 9.0)),
        ]
    });
    bag(compression, &messages.collect::<Vec<_>>())
}

fn read_with(bytes: &[u8], choice: &Choice) -> Result<Recording> {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("drive.mcap");
    fs::write(&file, bytes).expect("a file");
    recordings(&[file], choice, &[], |_| ()).remove(0)
}

/// Reads a bag of files with the given names in a folder.
fn read_folder(files: &[(&str, Vec<u8>)]) -> Result<Recording> {
    let folder = tempfile::tempdir().expect("a folder");
    files.iter().for_each(|(name, bytes)| fs::write(folder.path().join(name), bytes).expect("a file"));
    recordings(&[folder.path().into()], &Choice::default(), &[], |_| ()).remove(0)
}

/// The content of a bag of ROS 2: topic, type, time in s, bytes.
type Messages = Vec<(&'static str, &'static str, f64, Vec<u8>)>;

/// The messages of a drive straight ahead.
fn straight() -> Messages {
    let messages = (0..100).flat_map(|i| {
        let s = 1000.0 + 0.05 * f64::from(i);
        [("/cmd_vel", TWIST, s, twist(0.2, 0.1)), ("/robot/pose", POSE, s + 0.01, pose(s, 0.01 * f64::from(i)))]
    });
    messages.collect()
}

/// A range sensor that points in a direction.
fn sensor(name: &str, yaw_deg: f64) -> RangeSensor {
    RangeSensor { name: name.into(), x_cm: 0.0, y_cm: 0.0, yaw_deg, min_cm: 3.0, max_cm: 250.0 }
}

/// Reads messages of a robot with these range sensors.
fn read_of(messages: &Messages, choice: &Choice, sensors: &[RangeSensor]) -> Result<Recording> {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("drive.mcap");
    fs::write(&file, bag(None, messages)).expect("a file");
    recordings(&[file], choice, sensors, |_| ()).remove(0)
}

/// A stamp and a frame.
fn header(s: f64, frame: &str) -> ((i32, u32), &str) {
    ((s as i32, ((s - s.floor()) * 1e9) as u32), frame)
}

fn assert_straight(recording: &Recording) {
    assert_eq!((recording.commands.samples.len(), recording.poses.len()), (100, 100), "{:?}", recording.sources);
    assert_eq!(recording.commands.samples[7].1, [20.0, 0.1]);
    let x_cm: Vec<f64> = recording.poses.iter().map(|frame| frame.pose.position_cm.x).collect();
    assert!(x_cm.is_sorted() && (x_cm[99] - 99.0).abs() < 1e-9, "{x_cm:?}");
}

fn zstd(bytes: &[u8]) -> Vec<u8> {
    ::zstd::encode_all(bytes, 3).expect("memory")
}

/// Notes and what was not used, as text.
fn remarks(recording: &Recording) -> String {
    let of = |source: &Source| [source.guessed.clone(), source.unused.iter().map(LeftOut::line).collect()].concat();
    recording.sources.iter().flat_map(of).collect::<Vec<_>>().join("\n")
}

#[test]
fn simulated_time_at_any_rate_is_the_clock_of_all_topics() {
    // The simulation runs at half of real time: stamps advance by half of what the recorder counts.
    let simulated = |clock: bool| {
        let messages = (0..200).flat_map(|i| {
            let (s, logged) = (10.0 + 0.05 * f64::from(i), 1000.0 + 0.1 * f64::from(i));
            let time = (s as i32, ((s - s.floor()) * 1e9).round() as u32);
            [
                ("/cmd_vel", TWIST, logged, twist(0.2, 0.1)),
                ("/robot/pose", POSE, logged, pose(s, 0.01 * f64::from(i))),
                ("/clock", "rosgraph_msgs/msg/Clock", logged, cdr(&time)),
            ]
        });
        messages.filter(|(topic, ..)| clock || *topic != "/clock").collect::<Vec<_>>()
    };
    for clock in [true, false] {
        let recording = read_with(&bag(None, &simulated(clock)), &Choice::default()).expect("a recording");
        let (ms, _) = recording.commands.samples[100];
        assert!((ms - 15_000.0).abs() < 1.0, "{ms}");
        assert!(remarks(&recording).contains("at a real-time factor of 0.50"), "{}", remarks(&recording));
    }
}

#[test]
fn measured_velocities_are_never_commands() {
    let messages = |topic: &'static str, schema: &'static str| {
        let stamped = |s: f64| cdr(&(((s as i32, 0u32), "base"), [0.1, 0.0, 0.0], [0.0, 0.0, 0.1]));
        let moving = (0..50).flat_map(move |i| {
            let s = 1000.0 + f64::from(i);
            [(topic, schema, s, stamped(s)), ("/pose", POSE, s, pose(s, 0.01 * f64::from(i)))]
        });
        bag(None, &moving.collect::<Vec<_>>())
    };
    for (topic, schema) in [
        ("/odom/twist", "geometry_msgs/msg/TwistStamped"),
        ("/base/measured_velocity", "geometry_msgs/msg/TwistStamped"),
        ("/velocity", "geometry_msgs/msg/TwistWithCovarianceStamped"),
    ] {
        let refused = refusal(&messages(topic, schema));
        assert!(refused.contains("has no commands"), "{topic}: {refused}");
    }
    assert!(read_with(&messages("/twist", "geometry_msgs/msg/TwistStamped"), &Choice::default()).is_ok());
}

#[test]
fn what_is_not_modelled_or_not_used_is_reported() {
    let mut messages = straight();
    messages.iter_mut().filter(|(topic, ..)| *topic == "/cmd_vel").for_each(|(.., data)| {
        *data = cdr(&([0.3, 0.1, 0.0], [0.0, 0.0, 0.1]));
    });
    messages.push(("/ackermann_cmd", "ackermann_msgs/msg/AckermannDriveStamped", 1001.0, vec![0, 1, 0, 0]));
    messages.push(("/image", "sensor_msgs/msg/Image", 1001.0, vec![0, 1, 0, 0]));
    messages.push(("/goal", POSE, 1001.0, vec![0, 1, 0, 0]));
    let text = remarks(&read_with(&bag(None, &messages), &Choice::default()).expect("a recording"));
    for part in [
        "linear.y commands sideways motion of up to 10 cm/s, 25 % of the commanded travel",
        "1 messages of /ackermann_cmd: commands a steering angle",
        "1 messages of /image: messages of type sensor_msgs/msg/Image are not used",
        "1 messages of /goal: messages that are not geometry_msgs/msg/PoseStamped as stated",
    ] {
        assert!(text.contains(part), "{part} in {text}");
    }
    messages.push(("/cmd_vel", "geometry_msgs/msg/TwistStamped", 1002.0, vec![0, 1, 0, 0]));
    let refused = refusal(&bag_encoded("cdr", None, &messages));
    assert!(refused.contains("/cmd_vel has messages of several types"), "{refused}");
}

#[test]
fn readings_without_limits_are_judged_by_those_of_the_robot() {
    let range = |s: f64, limits: [f32; 2], m: f32| {
        let stamp = (s as i32, ((s - s.floor()) * 1e9) as u32);
        cdr(&((stamp, "sonar"), 0u8, 0.3f32, limits[0], limits[1], m))
    };
    let with = |limits: [f32; 2]| {
        let mut messages = straight();
        let readings = (0..4u8).map(|i| {
            let s = 1000.0 + f64::from(i);
            ("/range", "sensor_msgs/msg/Range", s, range(s, limits, [0.1, 1.5, 4.0, 0.02][usize::from(i)]))
        });
        messages.extend(readings);
        bag(None, &messages)
    };
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("drive.mcap");
    let sensor = sensor("ultrasonic", 0.0);
    let read = |limits| {
        fs::write(&file, with(limits)).expect("a file");
        let recording =
            recordings(std::slice::from_ref(&file), &Choice::default(), std::slice::from_ref(&sensor), |_| ())
                .remove(0);
        let recording = recording.expect("a recording");
        let echoes = recording.readings[0].samples.iter().filter(|reading| reading.1.is_some()).count();
        (echoes, remarks(&recording))
    };
    let (echoes, text) = read([0.0, 0.0]);
    assert!(echoes == 2 && text.contains("4 messages set no limits"), "{echoes} {text}");
    assert!(text.contains("those of robot.toml apply, 3 to 250 cm") && text.contains("2 rows (reading)"), "{text}");
    let (echoes, text) = read([0.2, 5.0]);
    assert!(echoes == 2 && text.contains("outside the limits that the messages state"), "{echoes} {text}");
}

fn refusal(bytes: &[u8]) -> String {
    read_with(bytes, &Choice::default()).expect_err("refused").to_string()
}

#[test]
fn all_compressions_give_the_same_recording() {
    for compression in [None, Some(Compression::Zstd), Some(Compression::Lz4)] {
        let recording = read_with(&drive(compression), &Choice::default()).expect("a recording");
        assert_eq!((recording.commands.samples.len(), recording.poses.len()), (100, 100));
        assert_eq!(recording.commands.samples[7].1, [20.0, 0.1]);
        let frame = recording.poses[50];
        // The stamp in the message takes precedence over the logging time.
        assert!((frame.t_ms - 1_002_500.0).abs() < 1e-3 && (frame.pose.position_cm.x - 50.0).abs() < 1e-9, "{frame:?}");
    }
}

#[test]
fn truncated_bag_is_read_up_to_the_cut() {
    let whole = drive(Some(Compression::Zstd));
    let recording = read_with(&whole[..whole.len() / 2], &Choice::default()).expect("a recording");
    assert!((10..100).contains(&recording.poses.len()), "{}", recording.poses.len());
    assert!(recording.sources[0].unused[0].reason.contains("cut off"), "{:?}", recording.sources);
    assert!(refusal(&whole[..20]).contains("ends before its first message"));
}

#[test]
fn unreadable_bags_are_rejected_in_one_line() {
    assert!(refusal(b"").contains("ends before its first message"));
    assert!(refusal(b"SQLite format 3\0 and so on").contains("is corrupt"));
    assert!(refusal(b"neither this nor that").contains("is not a bag"));
    let mut corrupt = drive(Some(Compression::Zstd));
    let name = corrupt.windows(4).position(|bytes| bytes == b"zstd").expect("a compressed chunk");
    corrupt[name + 40..name + 60].fill(0x55);
    assert!(refusal(&corrupt).contains("is corrupt"), "{}", refusal(&corrupt));
    let nothing = bag(None, &[("/chatter", "std_msgs/msg/String", 1.0, cdr(&"hello"))]);
    assert!(refusal(&nothing).contains("has no commands") && refusal(&nothing).contains("relevant topics are none"));
    let timeless: Vec<_> = (0..9)
        .flat_map(|_| [("/cmd_vel", TWIST, 0.0, twist(0.1, 0.0)), ("/pose", POSE, 0.0, pose(0.0, 0.0))])
        .collect();
    assert!(refusal(&bag(None, &timeless)).contains("the bag has no usable clock"));
    let set_back: Vec<_> = (0..9)
        .map(|i| 100.0 + f64::from(if i < 6 { i } else { i - 6 }))
        .flat_map(|s| [("/cmd_vel", TWIST, s, twist(0.1, 0.0)), ("/pose", POSE, s, pose(s, s))])
        .collect();
    let refused = refusal(&bag(None, &set_back));
    assert!(
        refused.contains("/cmd_vel: the clock goes back from 105.000 s to 100.000 s: cut the recording"),
        "{refused}"
    );
    let topics: Vec<String> = (0..=MAX_TOPICS).map(|i| format!("/robot{i}/cmd_vel")).collect();
    let many: Vec<_> = topics.iter().map(|topic| (topic.as_str(), TWIST, 1.0, twist(0.1, 0.0))).collect();
    assert!(refusal(&bag(None, &many)).contains("more than 10000 topics"));
}

#[test]
fn topics_of_two_robots_are_selected_by_the_user() {
    let messages = |robot: &'static str| {
        let topics: [&str; 2] = if robot == "a" { ["/a/cmd_vel", "/a/pose"] } else { ["/b/cmd_vel", "/b/pose"] };
        (0..9).flat_map(move |i| {
            let s = 5.0 + f64::from(i);
            [(topics[0], TWIST, s, twist(0.1, 0.0)), (topics[1], POSE, s, pose(s, 1.0))]
        })
    };
    let both = bag(None, &messages("a").chain(messages("b")).collect::<Vec<_>>());
    let refused = refusal(&both);
    assert!(refused.contains("could be any of /a/cmd_vel, /b/cmd_vel; select one with --commands TOPIC"), "{refused}");
    let of_b = Choice { commands: Some("/b/cmd_vel".into()), ..Choice::default() };
    let recording = read_with(&both, &of_b).expect("one robot");
    assert!(recording.sources[1].name.ends_with("/b/pose"), "{:?}", recording.sources);
    let of_none = Choice { poses: Some("/c/pose".into()), ..of_b };
    let refused = read_with(&both, &of_none).expect_err("no such topic").to_string();
    assert!(refused.contains("/c/pose is not a topic of poses") && refused.contains("/a/pose, /b/pose"), "{refused}");
}

#[test]
fn small_file_with_a_huge_claimed_size_is_rejected() {
    let mut bomb = drive(Some(Compression::Zstd));
    // In a chunk's header, the uncompressed size comes before the checksum and the length of the compression's name.
    let name = bomb.windows(4).position(|bytes| bytes == b"zstd").expect("a compressed chunk");
    bomb[name - 16..name - 8].copy_from_slice(&(1u64 << 40).to_le_bytes());
    let refused = refusal(&bomb);
    assert!(refused.contains("claims to contain 1099511627776 bytes"), "{refused}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]
    #[test]
    fn arbitrary_bytes_never_panic(
        compression in 0..3usize, changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..12),
        cut in prop::option::of(any::<prop::sample::Index>()),
    ) {
        let mut bytes = drive([None, Some(Compression::Zstd), Some(Compression::Lz4)][compression]);
        for (index, byte) in changes {
            let position = index.index(bytes.len());
            bytes[position] = byte;
        }
        if let Some(cut) = cut {
            bytes.truncate(cut.index(bytes.len()));
        }
        match read_with(&bytes, &Choice::default()) {
            Ok(recording) => prop_assert!(recording.commands.samples.len() <= 300),
            Err(error) => prop_assert_eq!(error.to_string().lines().count(), 1),
        }
    }
}
