//! Reads bags in every container and compression, whole and damaged.

use super::*;

#[test]
fn compressed_files_and_messages_are_read() {
    let whole = bag(None, &straight());
    assert_straight(&read_with(&zstd(&whole), &Choice::default()).expect("a recording"));
    let compressed: Messages = straight().into_iter().map(|(t, ty, s, data)| (t, ty, s, zstd(&data))).collect();
    assert_straight(&read_with(&bag(None, &compressed), &Choice::default()).expect("a recording"));
    let cut = zstd(&whole);
    let refused = refusal(&cut[..cut.len() * 2 / 3]);
    assert!(refused.contains("cut off"), "{refused}");
    let bomb = zstd(&[&whole[..], &vec![0; 64 << 20]].concat());
    assert!(refusal(&bomb).contains("times its size"), "{}", refusal(&bomb));
    assert!(refusal(b"\x1f\x8b\x08 and so on").contains("decompress it with `gunzip`"));
}

#[test]
fn messages_in_any_order_and_both_spellings_of_types_are_read() {
    let spelt: Messages = straight()
        .into_iter()
        .map(|(t, ty, s, data)| (t, if ty == TWIST { "geometry_msgs/Twist" } else { ty }, s, data))
        .collect();
    let by_topic = |mut messages: Messages| {
        messages.sort_by_key(|(topic, ..)| *topic);
        messages
    };
    let reversed: Messages = straight().into_iter().rev().collect();
    let mut shuffled = straight();
    (0..200).for_each(|i| shuffled.swap(i, (i * 79 + 31) % 200));
    let mut chunks = straight();
    chunks.rotate_left(120);
    for messages in [spelt.clone(), by_topic(spelt), reversed, shuffled, chunks] {
        assert_straight(&read_with(&bag(Some(Compression::Zstd), &messages), &Choice::default()).expect("a recording"));
    }
}

#[test]
fn parts_of_a_folder_are_one_drive() {
    let messages = straight();
    let [first, second] = [&messages[..90], &messages[90..]].map(|part| bag(None, part));
    let text = "rosbag2_bagfile_information:\n  relative_file_paths: [d_0.mcap, d_1.mcap.zstd]\n";
    let described = read_folder(&[
        ("d_0.mcap", first.clone()),
        ("d_1.mcap.zstd", zstd(&second)),
        ("metadata.yaml", text.as_bytes().to_vec()),
    ]);
    assert_straight(&described.expect("a recording"));
    assert_straight(&read_folder(&[("d_0.mcap", first), ("d_1.mcap", second)]).expect("a recording"));
}

#[test]
fn static_transforms_of_the_first_file_hold_for_later_ones() {
    let transform = |parent: &str, child: &str, s: f64, x_m: f64| {
        let stamp = (s as i32, ((s - s.floor()) * 1e9) as u32);
        cdr(&vec![((stamp, parent), child, [x_m, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0])])
    };
    const TF: &str = "tf2_msgs/msg/TFMessage";
    let part = |from: i32, with_static: bool| {
        let fixed = ("/tf_static", TF, 1000.0, transform("marker", "base_link", 1000.0, -0.1));
        let moving = (from..from + 50).flat_map(|i| {
            let s = 1000.0 + 0.05 * f64::from(i);
            [
                ("/cmd_vel", TWIST, s, twist(0.2, 0.1)),
                ("/tf", TF, s, transform("world", "marker", s, 0.01 * f64::from(i))),
            ]
        });
        bag(None, &with_static.then_some(fixed).into_iter().chain(moving).collect::<Vec<_>>())
    };
    let folder = tempfile::tempdir().expect("a folder");
    let files = ["d_0.mcap", "d_1.mcap"].map(|name| folder.path().join(name));
    files
        .iter()
        .zip([part(0, true), part(50, false)])
        .for_each(|(file, bytes)| fs::write(file, bytes).expect("a file"));
    for (recording, first_cm) in recordings(&files, &Choice::default(), &[], |_| ()).into_iter().zip([-10.0, 40.0]) {
        let recording = recording.expect("a recording");
        let x_cm = recording.poses[0].pose.position_cm.x;
        assert!((x_cm - first_cm).abs() < 1e-9, "{x_cm} {first_cm}");
    }
}

#[test]
fn sqlite_bags_are_read_without_traces() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("a bag %20?.db3");
    let database = rusqlite::Connection::open(&file).expect("a database");
    database
        .execute_batch(
            "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, serialization_format TEXT NOT NULL,
             offered_qos_profiles TEXT NOT NULL);
             CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL, data BLOB NOT NULL);
             BEGIN;",
        )
        .expect("tables");
    let mut topics: Vec<&str> = Vec::new();
    for (topic, schema, s, data) in straight() {
        if !topics.contains(&topic) {
            topics.push(topic);
            database
                .execute("INSERT INTO topics VALUES(?, ?, ?, 'cdr', '')", (topics.len() as i64, topic, schema))
                .expect("a topic");
        }
        let id = topics.iter().position(|name| *name == topic).map_or(0, |at| at as i64 + 1);
        database
            .execute("INSERT INTO messages(topic_id, timestamp, data) VALUES(?, ?, ?)", (id, (s * 1e9) as i64, data))
            .expect("a message");
    }
    database.execute_batch("COMMIT").expect("written");
    drop(database);
    let read = |file: &Path| recordings(&[file.to_owned()], &Choice::default(), &[], |_| ()).remove(0);
    assert_straight(&read(&file).expect("a recording"));
    let bytes = fs::read(&file).expect("a file");
    let packed = folder.path().join("b.db3.zstd");
    fs::write(&packed, zstd(&bytes)).expect("a file");
    assert_straight(&read(&packed).expect("a recording"));
    assert_eq!(fs::read_dir(folder.path()).expect("a folder").count(), 2, "no files of SQLite are left");
    fs::write(&file, &bytes[..bytes.len() / 2]).expect("a file");
    match read(&file) {
        Ok(recording) => assert!(remarks(&recording).contains("cut off")),
        Err(error) => assert!(error.to_string().contains("is corrupt"), "{error}"),
    }
    let other = folder.path().join("other.db3");
    rusqlite::Connection::open(&other).and_then(|db| db.execute_batch("CREATE TABLE t(x)")).expect("a database");
    let refused = read(&other).expect_err("no bag").to_string();
    assert!(refused.contains("without the tables of a ROS 2 bag"), "{refused}");
}

/// A message of ROS 1: numbers in little-endian order without padding, strings with their length.
fn ros1(header: Option<(u32, f64, &str)>, numbers: &[f64]) -> Vec<u8> {
    let mut bytes = Vec::new();
    if let Some((sequence, s, frame)) = header {
        for number in [sequence, s as u32, ((s - s.floor()) * 1e9) as u32, frame.len() as u32] {
            bytes.extend(number.to_le_bytes());
        }
        bytes.extend(frame.as_bytes());
    }
    numbers.iter().for_each(|number| bytes.extend(number.to_le_bytes()));
    bytes
}

/// The messages of [`straight`] in ROS 1.
fn straight_in_ros1() -> Messages {
    let messages = (0..100u32).flat_map(|i| {
        let s = 1000.0 + 0.05 * f64::from(i);
        let at = [0.01 * f64::from(i), 0.0, 0.0, 0.0, 0.0, 0.0, 1.0];
        [
            ("/cmd_vel", "geometry_msgs/Twist", s, ros1(None, &[0.2, 0.0, 0.0, 0.0, 0.0, 0.1])),
            ("/robot/pose", "geometry_msgs/PoseStamped", s + 0.01, ros1(Some((i, s, "map")), &at)),
        ]
    });
    messages.collect()
}

/// A bag of ROS 1 with one chunk.
fn ros1_bag(messages: &Messages) -> Vec<u8> {
    fn fields(fields: &[(&str, Vec<u8>)]) -> Vec<u8> {
        let mut bytes = Vec::new();
        for (name, value) in fields {
            bytes.extend((name.len() as u32 + 1 + value.len() as u32).to_le_bytes());
            bytes.extend(name.as_bytes());
            bytes.push(b'=');
            bytes.extend(value);
        }
        bytes
    }
    let record = |header: &[u8], data: &[u8]| {
        [&(header.len() as u32).to_le_bytes(), header, &(data.len() as u32).to_le_bytes(), data].concat()
    };
    let topics = ["/cmd_vel", "/robot/pose"];
    let connection = |id: usize| {
        let schema = messages.iter().find(|(topic, ..)| *topic == topics[id]).map_or("", |(_, schema, ..)| schema);
        let header =
            fields(&[("op", vec![7]), ("conn", (id as u32).to_le_bytes().into()), ("topic", topics[id].into())]);
        let data = fields(&[
            ("topic", topics[id].into()),
            ("type", schema.into()),
            ("md5sum", vec![b'0'; 32]),
            ("message_definition", Vec::new()),
        ]);
        record(&header, &data)
    };
    let connections = [connection(0), connection(1)].concat();
    let mut content = connections.clone();
    for (topic, _, s, data) in messages {
        let id = topics.iter().position(|name| name == topic).map_or(0, |id| id as u32);
        let time = [(*s as u32).to_le_bytes(), (((s - s.floor()) * 1e9) as u32).to_le_bytes()].concat();
        content.extend(record(&fields(&[("op", vec![2]), ("conn", id.to_le_bytes().into()), ("time", time)]), data));
    }
    let size = (content.len() as u32).to_le_bytes().to_vec();
    let chunk = record(&fields(&[("op", vec![5]), ("compression", b"none".to_vec()), ("size", size)]), &content);
    let header = |index: u64| {
        let fields = fields(&[
            ("op", vec![3]),
            ("index_pos", index.to_le_bytes().into()),
            ("conn_count", 2u32.to_le_bytes().into()),
            ("chunk_count", 1u32.to_le_bytes().into()),
        ]);
        [b"#ROSBAG V2.0\n".to_vec(), record(&fields, &vec![b' '; 4000])].concat()
    };
    let index = (header(0).len() + chunk.len()) as u64;
    [header(index), chunk, connections].concat()
}

#[test]
fn ros_1_is_read_from_its_bags_and_from_mcap() {
    let messages = straight_in_ros1();
    let whole = ros1_bag(&messages);
    assert_straight(&read_with(&whole, &Choice::default()).expect("a recording"));
    let cut = refusal(&whole[..whole.len() / 2]);
    assert!(cut.contains("bag of ROS 1 without an index") && cut.contains("rosbag reindex"), "{cut}");
    let converted = bag_encoded("ros1", Some(Compression::Lz4), &messages);
    assert_straight(&read_with(&converted, &Choice::default()).expect("a recording"));
}
