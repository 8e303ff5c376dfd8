use std::path::Path;

use mindgap_built_in_robot::default_robot;
use mindgap_logs::robot::same_robot;
use mindgap_logs::{Robot, Ultrasonic};

#[test]
fn robots_are_the_same_within_two_per_cent() {
    let robot = Robot { track_cm: 10.0, ..default_robot() };
    let logged = |track_cm: f64| same_robot(&robot, &Robot { track_cm, ..robot });
    assert!(logged(10.19).is_ok());
    let refusal = logged(10.3).expect_err("another robot").to_string();
    assert!(refusal.contains("track_cm is 10.3 in the logs' robot.toml and 10 in the simulator"), "{refusal}");
}

#[test]
fn sensor_mountings_are_compared_where_both_robots_have_a_sensor() {
    let robot = default_robot();
    let turned = robot.ultrasonic.map(|sensor| Ultrasonic { yaw_deg: 90.0, ..sensor });
    let refusal = same_robot(&robot, &Robot { ultrasonic: turned, ..robot }).expect_err("another mounting");
    assert!(refusal.to_string().contains("ultrasonic.yaw_deg is 90"), "{refusal}");
    assert!(same_robot(&robot, &Robot { ultrasonic: None, ..robot }).is_ok());
}

#[test]
fn absent_sensor_is_not_written_and_read_as_absent() {
    let robot = Robot { ultrasonic: None, ..default_robot() };
    let text = robot.to_text();
    assert!(!text.contains("ultrasonic"), "{text}");
    assert_eq!(Robot::parse(Path::new("robot.toml"), &text).expect("a robot"), robot);
}

#[test]
fn sensor_of_zeros_is_an_error_at_its_line() {
    let robot = Robot { ultrasonic: None, ..default_robot() }.to_text();
    let line = robot.lines().count() + 2;
    let text = format!("{robot}\n[ultrasonic]\nx_cm = 0\ny_cm = 0\nyaw_deg = 0\nmin_cm = 0\nmax_cm = 0\n");
    let refusal = Robot::parse(Path::new("robot.toml"), &text).expect_err("no range").to_string();
    assert!(refusal.starts_with(&format!("robot.toml:{line}: [ultrasonic] needs numbers")), "{refusal}");
}
