//! Robots with several range sensors.

use super::*;

const RANGE: &str = "sensor_msgs/msg/Range";
const SCAN: &str = "sensor_msgs/msg/LaserScan";

fn range(s: f64, frame: &str, m: f32) -> Vec<u8> {
    cdr(&(header(s, frame), 0u8, 0.3f32, 0.02f32, 4.0f32, m))
}

/// A scan of four beams: ahead, left, behind and right.
fn scan(s: f64, ranges_m: [f32; 4]) -> Vec<u8> {
    let quarter = std::f32::consts::FRAC_PI_2;
    let angles = [0.0, 3.0 * quarter, quarter];
    cdr(&(header(s, "laser"), angles, [0.0f32, 0.1], [0.02f32, 30.0], ranges_m.as_slice(), [0.0f32; 0].as_slice()))
}

/// A drive with further messages at its times, s.
fn with(more: impl Fn(f64) -> Messages) -> Messages {
    let times = (0..100).map(|i| 1000.0 + 0.05 * f64::from(i));
    straight().into_iter().chain(times.flat_map(more)).collect()
}

/// Returns the first reading of each sensor that was heard, cm, rounded.
fn heard(recording: &Recording) -> Vec<(usize, f64)> {
    let first = |readings: &Readings| readings.samples[0].1.map(f64::round);
    recording.readings.iter().filter_map(|readings| Some((readings.sensor, first(readings)?))).collect()
}

#[test]
fn topics_and_frames_that_name_a_sensor_are_matched_to_it() {
    let sensors = [sensor("ultrasonic", 0.0), sensor("left", 90.0), sensor("front_left", 45.0)];
    let by_topic = with(|s| {
        let of = |topic: &'static str, m: f32| (topic, RANGE, s, range(s, "sonar", m));
        vec![of("/range/front_left", 0.3), of("/range/left", 0.2), of("/sonar", 0.1)]
    });
    let recording = read_of(&by_topic, &Choice::default(), &sensors).expect("a recording");
    assert_eq!(heard(&recording), [(0, 10.0), (1, 20.0), (2, 30.0)]);
    // One topic for all, as some drivers have it.
    let by_frame = with(|s| {
        let of = |frame: &str, m: f32| ("/sonar", RANGE, s, range(s, frame, m));
        vec![of("sonar_left_link", 0.2), of("sonar_front_left_link", 0.3), of("sonar_link", 0.1)]
    });
    let recording = read_of(&by_frame, &Choice::default(), &sensors).expect("a recording");
    assert_eq!(heard(&recording), [(0, 10.0), (1, 20.0), (2, 30.0)]);
}

#[test]
fn beams_of_a_scan_stand_in_for_sensors() {
    let sensors = [sensor("ahead", 0.0), sensor("left", 90.0), sensor("right", -90.0)];
    let messages = with(|s| vec![("/scan", SCAN, s, scan(s, [1.0, 2.0, 3.0, 4.0]))]);
    let recording = read_of(&messages, &Choice::default(), &sensors).expect("a recording");
    assert_eq!(heard(&recording), [(0, 100.0), (1, 200.0), (2, 400.0)]);
    assert!(recording.sources.iter().any(|source| source.mapped[0].starts_with("readings of right = ")));
    let mixed =
        with(|s| vec![("/scan", SCAN, s, scan(s, [1.0, 2.0, 3.0, 4.0])), ("/left", RANGE, s, range(s, "", 0.5))]);
    let recording = read_of(&mixed, &Choice::default(), &sensors).expect("a recording");
    assert_eq!(heard(&recording), [(0, 100.0), (1, 50.0), (2, 400.0)]);
    let chosen =
        Choice { ranges: vec![(Some("left".into()), "/scan".into()), (None, "none".into())], ..Choice::default() };
    assert_eq!(heard(&read_of(&mixed, &chosen, &sensors).expect("a recording")), []);
    let chosen = Choice { ranges: vec![(Some("left".into()), "/scan".into())], ..Choice::default() };
    assert_eq!(heard(&read_of(&mixed, &chosen, &sensors).expect("a recording"))[1], (1, 200.0));
}

#[test]
fn topics_without_a_name_are_chosen_by_the_user() {
    let sensors = [sensor("ahead", 0.0), sensor("left", 90.0)];
    let messages = with(|s| vec![("/r1", RANGE, s, range(s, "a", 0.1)), ("/r2", RANGE, s, range(s, "b", 0.2))]);
    let recording = read_of(&messages, &Choice::default(), &sensors).expect("a recording");
    assert_eq!(heard(&recording), []);
    let text = remarks(&recording);
    assert!(
        text.contains("100 messages of /r1: names no range sensor of robot.toml; choose it with --ranges NAME=TOPIC"),
        "{text}"
    );
    let choice = |sensor: &str, topic: &str| Choice {
        ranges: vec![(None, "/r2".into()), (Some(sensor.into()), topic.into())],
        ..Choice::default()
    };
    let recording = read_of(&messages, &choice("left", "/r1"), &sensors).expect("a recording");
    assert_eq!(heard(&recording), [(0, 20.0), (1, 10.0)]);
    let refusal =
        |sensor, topic| read_of(&messages, &choice(sensor, topic), &sensors).expect_err("refused").to_string();
    assert!(refusal("behind", "/r1").contains("robot.toml has no range sensor \"behind\""));
    assert!(refusal("left", "/r3").contains("/r3 is not a topic of readings"));
}
