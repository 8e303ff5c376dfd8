use std::path::Path;

use mindgap_built_in_robot::{default_robot, record, training_room};
use mindgap_logs::{Logs, Robot, Row};

const TABLES: &str =
    "\n[[range_sensor]]\nname = \"left\"\nx_cm = 0\ny_cm = 6\nyaw_deg = 60\nmin_cm = 4\nmax_cm = 240\n";
const RUN: &str = "t_ms,left,right,x_cm,y_cm,heading_deg,echo_cm,echo_left_cm\n";

/// Returns logs of a robot with a second sensor, whose readings are written in the last column.
fn read(rows: &str) -> Logs {
    let folder = tempfile::tempdir().expect("a folder");
    let logs = record(&default_robot(), &training_room(), 1, 4, &[], 1).expect("logs");
    logs.write(folder.path()).expect("written");
    let robot = default_robot().to_text() + TABLES;
    std::fs::write(folder.path().join("robot.toml"), robot).expect("written");
    std::fs::write(folder.path().join("run-000.csv"), RUN.to_owned() + rows).expect("written");
    Logs::read(folder.path(), |warning| panic!("{warning}")).expect("logs")
}

#[test]
fn each_sensor_hears_its_own_column() {
    let logs = read("0,10,10,50,50,0,80,31\n400,10,10,51,50,0,,32.5\n800,10,10,52,50,0,78,\n");
    let heard = logs.by_sensor();
    let readings = |logs: &Logs| logs.runs[0].rows.iter().map(|row| row.echo_cm).collect::<Vec<_>>();
    assert_eq!([heard[0].sensor.as_str(), &heard[1].sensor], ["ultrasonic", "left"]);
    assert_eq!(readings(&heard[0].logs), [Some(80.0), None, Some(78.0)]);
    assert_eq!(readings(&heard[1].logs), [Some(31.0), Some(32.5), None]);
    assert_eq!(heard[1].logs.robot.ultrasonic.map(|sensor| sensor.yaw_deg), Some(60.0));
    let text = logs.runs[0].to_text();
    assert!(text.starts_with(RUN) && text.contains("\n400,10,10,51,50,0,,32.5\n"), "{text}");
}

#[test]
fn all_sensors_are_written_and_read_again() {
    let (robot, sensors) =
        Robot::parse_all(Path::new("robot.toml"), &(default_robot().to_text() + TABLES)).expect("a robot");
    let text = robot.to_text_with(&sensors);
    assert_eq!(Robot::parse_all(Path::new("robot.toml"), &text).expect("a robot"), (robot, sensors));
    let alone = text.split_once("[ultrasonic]").expect("a sensor").0.to_owned() + TABLES;
    let (robot, sensors) = Robot::parse_all(Path::new("robot.toml"), &alone).expect("a robot");
    assert_eq!((robot.ultrasonic.map(|sensor| sensor.yaw_deg), sensors.first()), (Some(60.0), "left"));
    let text = robot.to_text_with(&sensors);
    assert!(!text.contains("[ultrasonic]"), "{text}");
    assert_eq!(Robot::parse_all(Path::new("robot.toml"), &text).expect("a robot"), (robot, sensors));
}

#[test]
fn longer_steps_keep_the_latest_fresh_reading_of_each_sensor() {
    let row = |k: i32| format!("{},10,10,{},50,0,{},{}\n", 400 * k, 50 + k, 80 - k, 31 + k);
    let logs = read(&(0..5).map(row).collect::<String>()).resampled(800.0);
    let rows: Vec<Row> = logs.runs[0].rows.iter().collect();
    assert_eq!(rows.iter().map(|row| row.echo_cm).collect::<Vec<_>>(), [Some(80.0), Some(78.0), Some(76.0)]);
    let further: Vec<_> = (0..3).map(|row| logs.runs[0].rows.further_cm(0, row)).collect();
    assert_eq!(further, [Some(31.0), Some(33.0), Some(35.0)]);
}
