//! Bags written by the `mcap` crate, whole and broken.

use std::collections::BTreeMap;
use std::fs;
use std::io::Cursor;

use byteorder::LittleEndian;
use mcap::records::MessageHeader;
use mcap::{Compression, WriteOptions, Writer};
use proptest::prelude::*;
use serde::Serialize;

use super::*;

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
    let options = WriteOptions::new().compression(compression).chunk_size(Some(2000)).profile("ros2");
    let mut writer = Writer::with_options(Cursor::new(Vec::new()), options).expect("memory");
    let mut channels = BTreeMap::new();
    for (sequence, (topic, schema, s, data)) in messages.iter().enumerate() {
        let id = *channels.entry(*topic).or_insert_with(|| {
            let schema = writer.add_schema(schema, "ros2msg", b"").expect("a schema");
            writer.add_channel(schema, topic, "cdr", &BTreeMap::new()).expect("a channel")
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
    recording(&file, choice, 0.0)
}

fn refusal(bytes: &[u8]) -> String {
    read_with(bytes, &Choice::default()).expect_err("refused").to_string()
}

#[test]
fn every_compression_gives_the_same_recording() {
    for compression in [None, Some(Compression::Zstd), Some(Compression::Lz4)] {
        let recording = read_with(&drive(compression), &Choice::default()).expect("a recording");
        assert_eq!((recording.commands.samples.len(), recording.poses.len()), (100, 100));
        assert_eq!(recording.commands.samples[7].1, [20.0, 0.1]);
        let frame = recording.poses[50].expect("seen");
        // The stamp in the message rather than when it was logged.
        assert!((frame.t_ms - 1_002_500.0).abs() < 1e-3 && (frame.pose.position_cm.x - 50.0).abs() < 1e-9, "{frame:?}");
    }
}

#[test]
fn a_bag_that_is_cut_off_keeps_what_came_before() {
    let whole = drive(Some(Compression::Zstd));
    let recording = read_with(&whole[..whole.len() / 2], &Choice::default()).expect("a recording");
    assert!((10..100).contains(&recording.poses.len()), "{}", recording.poses.len());
    assert!(recording.sources[0].left_out[0].contains("cut off"), "{:?}", recording.sources);
    assert!(refusal(&whole[..20]).contains("ends before its first message"));
}

#[test]
fn what_cannot_be_read_is_refused_in_a_line() {
    assert!(refusal(b"").contains("ends before its first message"));
    assert!(refusal(b"SQLite format 3\0 and so on").contains("is no MCAP file"));
    let mut corrupt = drive(Some(Compression::Zstd));
    let name = corrupt.windows(4).position(|bytes| bytes == b"zstd").expect("a compressed chunk");
    corrupt[name + 40..name + 60].fill(0x55);
    assert!(refusal(&corrupt).contains("is corrupt"), "{}", refusal(&corrupt));
    let nothing = bag(None, &[("/chatter", "std_msgs/msg/String", 1.0, cdr(&"hello"))]);
    assert!(refusal(&nothing).contains("has no commands") && refusal(&nothing).contains("of interest are none"));
    let timeless: Vec<_> = (0..9)
        .flat_map(|_| [("/cmd_vel", TWIST, 0.0, twist(0.1, 0.0)), ("/pose", POSE, 0.0, pose(0.0, 0.0))])
        .collect();
    assert!(refusal(&bag(None, &timeless)).contains("the bag has no time"));
    let set_back: Vec<_> = (0..9)
        .map(|i| 100.0 + f64::from(if i < 6 { i } else { i - 6 }))
        .flat_map(|s| [("/cmd_vel", TWIST, s, twist(0.1, 0.0)), ("/pose", POSE, s, pose(s, s))])
        .collect();
    let refused = refusal(&bag(None, &set_back));
    assert!(
        refused.contains("/cmd_vel: the clock goes back from 105.000 s to 100.000 s: cut the recording"),
        "{refused}"
    );
    let topics: Vec<String> = (0..=MOST_TOPICS).map(|i| format!("/robot{i}/cmd_vel")).collect();
    let many: Vec<_> = topics.iter().map(|topic| (topic.as_str(), TWIST, 1.0, twist(0.1, 0.0))).collect();
    assert!(refusal(&bag(None, &many)).contains("more than 10000 topics"));
}

#[test]
fn two_robots_are_told_apart_by_the_user() {
    let messages = |robot: &'static str| {
        let topics: [&str; 2] = if robot == "a" { ["/a/cmd_vel", "/a/pose"] } else { ["/b/cmd_vel", "/b/pose"] };
        (0..9).flat_map(move |i| {
            let s = 5.0 + f64::from(i);
            [(topics[0], TWIST, s, twist(0.1, 0.0)), (topics[1], POSE, s, pose(s, 1.0))]
        })
    };
    let both = bag(None, &messages("a").chain(messages("b")).collect::<Vec<_>>());
    let refused = refusal(&both);
    assert!(refused.contains("could be several: /a/cmd_vel, /b/cmd_vel; --commands TOPIC"), "{refused}");
    let of_b = Choice { commands: Some("/b/cmd_vel".into()), ..Choice::default() };
    let recording = read_with(&both, &of_b).expect("one robot");
    assert!(recording.sources[1].name.ends_with("/b/pose"), "{:?}", recording.sources);
    let of_none = Choice { poses: Some("/c/pose".into()), ..of_b };
    let refused = read_with(&both, &of_none).expect_err("no such topic").to_string();
    assert!(refused.contains("/c/pose is no topic of poses") && refused.contains("/a/pose, /b/pose"), "{refused}");
}

#[test]
fn a_small_file_that_claims_to_hold_much_is_refused() {
    let mut bomb = drive(Some(Compression::Zstd));
    // Of a chunk's header the uncompressed size stands before its checksum and the name's length.
    let name = bomb.windows(4).position(|bytes| bytes == b"zstd").expect("a compressed chunk");
    bomb[name - 16..name - 8].copy_from_slice(&(1u64 << 40).to_le_bytes());
    let refused = refusal(&bomb);
    assert!(refused.contains("claims to hold 1099511627776 bytes"), "{refused}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]
    #[test]
    fn no_bytes_make_it_panic(
        compression in 0..3usize, changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..12),
        cut in prop::option::of(any::<prop::sample::Index>()),
    ) {
        let mut bytes = drive([None, Some(Compression::Zstd), Some(Compression::Lz4)][compression]);
        for (place, byte) in changes {
            let place = place.index(bytes.len());
            bytes[place] = byte;
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
