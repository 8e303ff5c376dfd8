//! Rotation counters from joints, and a gyro from an IMU.

use super::*;

const JOINTS: &str = "sensor_msgs/msg/JointState";
const IMU: &str = "sensor_msgs/msg/Imu";

fn joints(s: f64, names: &[&str], rad: &[f64]) -> Vec<u8> {
    cdr(&(header(s, ""), names, rad, [0.0f64; 0].as_slice(), [0.0f64; 0].as_slice()))
}

/// A message of an IMU whose turn rates and accelerations are these.
fn imu(s: f64, rate_rad_s: [f64; 3], acceleration_m_s2: [f64; 3], variance: f64) -> Vec<u8> {
    let covariance = |first: f64| [first, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    let orientation = ([0.0, 0.0, 0.0, 1.0], covariance(-1.0));
    cdr(&(header(s, "imu"), orientation, (rate_rad_s, covariance(variance)), (acceleration_m_s2, covariance(0.0))))
}

/// A drive with further messages at its times, s.
fn with(more: impl Fn(f64) -> Messages) -> Messages {
    let times = (0..100).map(|i| 1000.0 + 0.05 * f64::from(i));
    straight().into_iter().chain(times.flat_map(more)).collect()
}

fn read(messages: &Messages, choice: &Choice) -> Result<Recording> {
    read_of(messages, choice, &[])
}

/// Returns left and right angle and the yaw rate at a time, s.
fn measured(recording: &Recording, s: f64) -> [Option<f64>; 3] {
    let (own, times_ms) = (&recording.own_motion, [1e3 * s; 2]);
    [own.angle_rad(0, times_ms), own.angle_rad(1, times_ms), own.yaw_rad_s(times_ms)]
}

#[test]
fn wheels_of_a_side_are_averaged_and_other_joints_are_reported() {
    let names = ["rear_right_wheel", "front_left_wheel", "arm", "front_right_wheel", "rear_left_wheel"];
    let messages = with(|s| {
        let t = s - 1000.0;
        vec![("/joint_states", JOINTS, s, joints(s, &names, &[5.0 * t, 1.0 * t, 9.0, 3.0 * t, 2.0 * t]))]
    });
    let recording = read(&messages, &Choice::default()).expect("a recording");
    let [left, right, gyro] = measured(&recording, 1002.03);
    let off = |found: Option<f64>, rad: f64| (found.expect("an angle") - rad).abs();
    assert!(off(left, 1.5 * 2.03) < 1e-6 && off(right, 4.0 * 2.03) < 1e-6, "{left:?} {right:?}");
    assert_eq!(gyro, None);
    let text = remarks(&recording);
    assert!(text.contains("100 messages of /joint_states:arm: not taken for a driven wheel"), "{text}");
    assert!(!text.contains("messages of /joint_states: "), "{text}");
}

#[test]
fn a_bag_without_poses_needs_wheels_or_a_gyro() {
    let without_poses = |more: Messages| {
        let commands = straight().into_iter().filter(|(topic, ..)| *topic == "/cmd_vel");
        read(&commands.chain(more).collect(), &Choice::default())
    };
    let joints = |s: f64| ("/joint_states", JOINTS, s, joints(s, &["left_wheel", "right_wheel"], &[s - 1000.0; 2]));
    let counted = (0..100).map(|i| joints(1000.0 + 0.05 * f64::from(i)));
    let recording = without_poses(counted.collect()).expect("a recording");
    assert!(!recording.is_tracked() && recording.own_motion.has_counters() && recording.has_one_clock);
    let refusal = without_poses(Vec::new()).expect_err("no motion").to_string();
    assert!(refusal.contains("has no poses") && refusal.contains("wheels of a JointState or a gyro"), "{refusal}");
}

#[test]
fn joints_with_unknown_names_are_chosen_by_the_user() {
    let names = ["joint_a", "joint_b"];
    let messages = with(|s| vec![("/state", JOINTS, s, joints(s, &names, &[s - 1000.0, 7.0 - s]))]);
    let text = remarks(&read(&messages, &Choice::default()).expect("a recording"));
    assert!(
        text.contains(
            "100 messages of /state: no pair of left and right wheels by the names of its joints (joint_a, joint_b)"
        ),
        "{text}"
    );
    assert!(text.contains("--left-joint and --right-joint"), "{text}");
    let chosen = |left: &str, right: &[&str]| Choice {
        wheels: [vec![left.into()], right.iter().map(|joint| (*joint).to_owned()).collect()],
        ..Choice::default()
    };
    let recording = read(&messages, &chosen("joint_b", &["/state:joint_a"])).expect("a recording");
    assert!(matches!(measured(&recording, 1001.0), [Some(left), Some(right), None]
        if (left + 1.0).abs() < 1e-6 && (right - 1.0).abs() < 1e-6));
    let refusal = |choice| read(&messages, &choice).expect_err("refused").to_string();
    assert!(
        refusal(chosen("joint_c", &["joint_a"]))
            .contains("has no joint joint_c: those with positions are /state:joint_a")
    );
    assert!(refusal(chosen("joint_a", &[])).contains("give both --left-joint and --right-joint"));
}

#[test]
fn of_several_topics_with_wheels_that_of_the_robot_is_chosen_or_none() {
    let names = ["wheel_left", "wheel_right"];
    let both = |a: &'static str, b: &'static str| {
        let of = |topic, s: f64, rate: f64| (topic, JOINTS, s, joints(s, &names, &[rate * (s - 1000.0), 0.0]));
        with(|s| vec![of(a, s, 1.0), of(b, s, 3.0)])
    };
    let recording = read(&both("/joint_states", "/joint_commands"), &Choice::default()).expect("a recording");
    assert!(measured(&recording, 1001.0)[0].is_some_and(|rad| (rad - 1.0).abs() < 1e-6));
    let recording = read(&both("/a/joints", "/b/joints"), &Choice::default()).expect("a recording");
    assert_eq!(measured(&recording, 1001.0), [None; 3]);
    let text = remarks(&recording);
    assert!(
        text.contains("wheels are in several topics (/a/joints, /b/joints)")
            && text.contains("as in /b/joints:wheel_left")
    );
}

#[test]
fn joints_without_usable_positions_do_not_stop_the_import() {
    let names = ["wheel_left", "wheel_right"];
    for positions in [&[][..], &[f64::NAN, f64::INFINITY]] {
        let messages = with(|s| vec![("/joint_states", JOINTS, s, joints(s, &names, positions))]);
        let recording = read(&messages, &Choice::default()).expect("a recording");
        assert_eq!(measured(&recording, 1001.0), [None; 3]);
        let text = remarks(&recording);
        assert!(text.contains("100 messages of /joint_states: no positions of joints"), "{text}");
    }
    let mut once = straight();
    once.push(("/joint_states", JOINTS, 1001.0, joints(1001.0, &names, &[1.0, 2.0])));
    let text = remarks(&read(&once, &Choice::default()).expect("a recording"));
    assert!(
        text.contains("1 messages of /joint_states:wheel_left: /joint_states:wheel_left has a single message"),
        "{text}"
    );
}

#[test]
fn the_gyro_is_about_the_axis_that_the_accelerometer_shows() {
    for (acceleration, rate, words) in [
        ([0.1, 0.2, 9.8], 3.0, ""),
        ([0.0, 0.0, 0.0], 3.0, ""),
        ([0.0, -9.7, 0.3], -2.0, "the IMU's y axis points downwards"),
        ([9.8, 0.0, 0.0], 1.0, "the IMU's x axis points upwards"),
    ] {
        let messages = with(|s| vec![("/imu", IMU, s, imu(s, [1.0, 2.0, 3.0], acceleration, 0.0))]);
        let recording = read(&messages, &Choice::default()).expect("a recording");
        assert_eq!(measured(&recording, 1001.0), [None, None, Some(rate)], "{acceleration:?}");
        assert!(remarks(&recording).contains(words), "{}", remarks(&recording));
    }
    let without = with(|s| vec![("/imu", IMU, s, imu(s, [1.0, 2.0, 3.0], [0.0; 3], -1.0))]);
    let recording = read(&without, &Choice::default()).expect("a recording");
    assert_eq!(measured(&recording, 1001.0)[2], None);
    assert!(remarks(&recording).contains("100 messages of /imu: no turn rates"), "{}", remarks(&recording));
}

#[test]
fn one_of_several_imus_is_chosen_by_the_user() {
    let messages = with(|s| {
        let of = |topic: &'static str, rate: f64| (topic, IMU, s, imu(s, [0.0, 0.0, rate], [0.0, 0.0, 9.8], 0.0));
        vec![of("/camera/imu", 1.0), of("/base/imu", 2.0)]
    });
    let yaw = |gyro: Option<&str>| {
        let choice = Choice { gyro: gyro.map(str::to_owned), ..Choice::default() };
        read(&messages, &choice).map(|recording| (measured(&recording, 1001.0)[2], remarks(&recording)))
    };
    let (rate, text) = yaw(None).expect("a recording");
    assert_eq!(rate, None);
    assert!(text.contains("the gyro could be any of /base/imu, /camera/imu; select one with --gyro TOPIC"), "{text}");
    assert_eq!(yaw(Some("/base/imu")).expect("a recording").0, Some(2.0));
    assert_eq!(yaw(Some("none")).expect("a recording").0, None);
    let refusal = yaw(Some("/imu")).expect_err("refused").to_string();
    assert!(
        refusal.contains("/imu is not a topic of a gyro (sensor_msgs/Imu): those are /base/imu, /camera/imu"),
        "{refusal}"
    );
}

#[test]
fn messages_of_ros_1_are_read() {
    let text = |text: &str| [&(text.len() as u32).to_le_bytes(), text.as_bytes()].concat();
    let numbers = |numbers: &[f64]| numbers.iter().flat_map(|number| number.to_le_bytes()).collect::<Vec<u8>>();
    let header = [[7u32, 1001, 500_000_000].map(u32::to_le_bytes).as_flattened(), &text("base")].concat();
    let two = 2u32.to_le_bytes().to_vec();
    let joints = [header.clone(), two.clone(), text("l"), text("r"), two, numbers(&[1.5, 2.5]), vec![0; 8]].concat();
    let imu =
        [header, numbers(&[0.0; 13]), numbers(&[1.0, 2.0, 3.0]), numbers(&[0.0; 9]), numbers(&[4.0; 12])].concat();
    let decoded = |schema: &str, data: &[u8]| match messages::decode(schema, messages::Encoding::Ros1, data, &[]) {
        Message::Decoded(decoded) => decoded,
        _ => panic!("{schema}"),
    };
    let angle = |suffix: &str, rad: f64| (suffix.to_owned(), Some(1_001_500.0), Decoded::Angle(rad));
    assert_eq!(decoded(JOINTS, &joints), [angle(":l", 1.5), angle(":r", 2.5)]);
    let (_, stamp_ms, value) = decoded(IMU, &imu).remove(0);
    let is_read = matches!(value, Decoded::Inertial { rate_rad_s, acceleration_m_s2 }
        if rate_rad_s.z == 3.0 && acceleration_m_s2.x == 4.0);
    assert!(is_read && stamp_ms == Some(1_001_500.0), "{value:?}");
    assert!(matches!(messages::decode(IMU, messages::Encoding::Ros1, &imu[..200], &[]), Message::Undecodable));
}
