//! `mindgap import streams` of rotation counters, a gyro and several range sensors, on an exactly known drive.

use std::fmt::Write;

use mindgap_tests::command::Sandbox;
use mindgap_tests::range_sensors::table;

use super::import_recordings::{ROBOT, SAMPLE_S, SENSOR, assert_measured, drive, rows, with_streams};

const CALL: &str =
    "import streams command.csv track.csv own.csv --robot robot.toml --out logs --json report.json --force";

/// Returns what the robot measures at each sample: time (s), angles of the wheels (rad) and yaw rate (rad/s).
fn measured() -> Vec<[f64; 4]> {
    let mut wheels_rad = [0.0; 2];
    let samples = drive().into_iter().map(|sample| {
        let [v, w] = sample.twist;
        let here = [sample.s, wheels_rad[0], wheels_rad[1], w];
        wheels_rad[0] += (v - 0.1 * w) / 0.03 * SAMPLE_S;
        wheels_rad[1] += (v + 0.1 * w) / 0.03 * SAMPLE_S;
        here
    });
    samples.collect()
}

/// Returns a table of what the robot measures, with each row changed.
fn own(header: &str, change: impl Fn([f64; 4]) -> [f64; 4]) -> String {
    measured().into_iter().map(change).fold(format!("{header}\n"), |mut text, [s, left, right, rate]| {
        writeln!(text, "{s:.3},{left:.5},{right:.5},{rate:.5}").expect("memory");
        text
    })
}

const HEADER: &str = "t_s,js/wheel_left/position,js/wheel_right/position,gyro_rad_s";

/// Imports the drive with this table, and returns what the terminal shows.
fn import(sandbox: &Sandbox, table: &str) -> String {
    sandbox.write("own.csv", table.replace("js/", "/joint_states/"));
    sandbox.run(CALL)
}

#[test]
fn counters_and_gyro_of_tables_become_columns() {
    let sandbox = with_streams();
    let said = import(&sandbox, &own(HEADER, |row| row));
    assert_measured(&rows(&sandbox));
    assert!(said.contains("rot_left = /joint_states/wheel_left/position") && said.contains(" with a gyro"), "{said}");
    let recording = &sandbox.json("report.json")["recordings"][0];
    assert_eq!(recording["with_counters"], recording["rows"]);
    assert_eq!(recording["with_gyro"], recording["rows"]);
    assert_eq!(sandbox.json("report.json")["findings"].as_array().map(Vec::len), Some(0));
    let text = sandbox.run("check logs");
    assert!(text.contains("rot_left_deg, rot_right_deg") && text.contains("gyro_deg_s"), "{text}");
    sandbox.run("diagnose kinematic logs --json gap.json");
    assert_eq!(sandbox.json("gap.json")["verdict"], "no_gap");
}

#[test]
fn wrong_counters_and_gyros_are_found_and_become_no_cause() {
    let sandbox = with_streams();
    let wrapped = |rad: f64| rad.rem_euclid(std::f64::consts::TAU);
    for (id, header, change) in [
        ("counter_backwards", HEADER, (|[s, l, r, w]| [s, l, -r, w]) as fn([f64; 4]) -> [f64; 4]),
        ("counter_jump", HEADER, |[s, l, r, w]| [s, if s < 40.0 { l } else { l - 1000.0 }, r, w]),
        ("counter_unit", "t_s,rot_left_deg,rot_right_deg,gyro_rad_s", |row| row),
        // Of the motor, whose gear was not divided by.
        ("counter_unit", HEADER, |[s, l, r, w]| [s, 30.0 * l, 30.0 * r, w]),
        ("gyro_sign", HEADER, |[s, l, r, w]| [s, l, r, -w]),
        ("gyro_unit", "t_s,js/wheel_left/position,js/wheel_right/position,gyro_deg_s", |row| row),
    ] {
        let said = import(&sandbox, &own(header, change));
        assert!(said.contains(&format!("logs: {id} ")), "{id}: {said}");
        sandbox.run("diagnose kinematic logs --json gap.json");
        let gap = sandbox.json("gap.json");
        assert_eq!(gap["verdict"], "no_gap", "{id}: {}", gap["effects"]);
        assert!(gap["data"].as_array().expect("findings").iter().any(|found| found["finding"] == id), "{id}");
    }
    let said = import(&sandbox, &own(HEADER, |[s, l, r, w]| [s, wrapped(l), wrapped(r), w]));
    assert!(said.contains("logs: counter_wraps "), "{said}");
    let said = import(&sandbox, &own(HEADER, |[s, l, ..]| [s, l, 1e308, -1e300]));
    assert!(said.contains("1600 rows (yaw rate): larger than any robot's"), "{said}");
    assert_eq!(sandbox.json("report.json")["recordings"][0]["with_gyro"], 0);
    sandbox.run("check logs");
}

/// Expects the drive in rows without poses, and a diagnosis of these channels.
#[track_caller]
fn assert_untracked(sandbox: &Sandbox, said: &str, channels: &[&str]) {
    assert!(said.contains("poses: no poses were found"), "{said}");
    assert!(rows(sandbox).iter().all(|row| row.pose.is_none()) && rows(sandbox).len() > 180, "{said}");
    assert!(sandbox.text("logs/run-000.csv").starts_with("t_ms,left,right,x_cm,y_cm,heading_deg,echo_cm"));
    assert_eq!(sandbox.json("report.json")["findings"].as_array().map(Vec::len), Some(0));
    assert!(sandbox.run("check logs").contains("No defects found."));
    sandbox.run("diagnose kinematic logs --json gap.json");
    let gap = sandbox.json("gap.json");
    assert_eq!((&gap["verdict"], &gap["compared"]), (&"no_gap".into(), &serde_json::json!(channels)), "{said}");
    assert!(
        gap["not_compared"].as_array().is_some_and(|channels| channels.iter().any(|of| of["channel"] == "forward"))
    );
}

#[test]
fn without_poses_what_the_robot_measures_is_imported_and_diagnosed() {
    let sandbox = with_streams();
    let call = CALL.replace(" track.csv", "");
    let all = ["rot_left", "rot_right", "gyro"];
    let measured = own("t_s,rot_left_rad,rot_right_rad,gyro_rad_s", |row| row);
    sandbox.write("own.csv", &measured);
    let said = sandbox.run(&call);
    assert_untracked(&sandbox, &said, &all);
    assert_measured(&rows(&sandbox));
    assert!(said.contains("rotation counters, which show the drive up to the wheels, and a gyro"), "{said}");
    assert!(said.contains("to add poses, import them") && said.contains("motion lags the commands by 0 ms"), "{said}");
    assert!(sandbox.json("report.json")["untracked"].is_string());

    // On another clock.
    sandbox.write("own.csv", own("t_s,rot_left_rad,rot_right_rad,gyro_rad_s", |[s, l, r, w]| [s + 5000.0, l, r, w]));
    let said = sandbox.run(&call);
    let clocks = sandbox.json("report.json")["recordings"][0]["clocks"].clone();
    let off_ms = clocks["offset_ms"].as_f64().expect("a number") - 5e6;
    assert!(said.contains("two clocks: that of the motion is") && off_ms.abs() < 25.0, "{clocks}");
    assert_untracked(&sandbox, &said, &all);

    sandbox.write("own.csv", own("t_s,something,else,gyro_rad_s", |row| row));
    let said = sandbox.run(&call);
    assert_untracked(&sandbox, &said, &["gyro"]);
    assert!(!said.contains("rotation counters"), "{said}");

    // Everything in one table.
    let commands = sandbox.text("command.csv");
    let joined =
        commands.lines().zip(measured.lines()).map(|(a, b)| format!("{a},{}\n", b.split_once(',').expect("cells").1));
    sandbox.write("own.csv", joined.collect::<String>());
    let said = sandbox.run(&call.replace(" command.csv", ""));
    assert_untracked(&sandbox, &said, &all);
}

#[test]
fn recordings_that_show_no_motion_are_refused() {
    let sandbox = with_streams();
    let call = CALL.replace(" track.csv", "");
    sandbox.write(
        "own.csv",
        drive().iter().fold("t_s,range_m\n".to_owned(), |text, sample| text + &format!("{:.3},1\n", sample.s)),
    );
    for call in [&call, &call.replace(" own.csv", "")] {
        let refusal = sandbox.refused(call);
        assert!(refusal.contains("a drive needs commands, and poses or else rotation counters or a gyro"), "{refusal}");
    }
    sandbox.write("own.csv", own(HEADER, |[s, ..]| [s, 3.0, 3.0, 0.0]).replace("js/", "/joint_states/"));
    let refusal = sandbox.refused(&call);
    assert!(refusal.contains("the robot never moves: its rotation counters stay within 0.0 cm"), "{refusal}");
    sandbox.write(
        "own.csv",
        own(HEADER, |[s, l, r, w]| [s, l * libm::sin(s), r * libm::cos(3.0 * s), w]).replace("js/", "/joint_states/"),
    );
    let refusal = sandbox.refused(&call);
    assert!(refusal.starts_with("command.csv: commands and rotation counters have nothing in common"), "{refusal}");
    sandbox.write("track.csv", "t_s,x_m,y_m,yaw_rad\n0,1,broken,0\n1,1,1,0\n");
    sandbox.write("own.csv", own(HEADER, |row| row).replace("js/", "/joint_states/"));
    let refusal = sandbox.refused(CALL);
    assert!(refusal.starts_with("track.csv:2: y_m = \"broken\" is not a number"), "{refusal}");
}

#[test]
fn a_file_of_measurements_that_cannot_be_read_leaves_the_drive() {
    let sandbox = with_streams();
    let said = import(&sandbox, &own(HEADER, |row| row).replacen("\n5.000,", "\n5.000,broken", 1));
    assert!(said.contains("excluded: own.csv: line 102: /joint_states/wheel_left/position = \"broken"), "{said}");
    assert_eq!(sandbox.json("report.json")["recordings"][0]["with_counters"], 0);
    let long = format!("t_s,x_m,y_m,{}\n0,1,2,3\n1,1,2,3\n", "y".repeat(5_000_000));
    sandbox.write("track.csv", long);
    let refusal = sandbox.refused(&CALL.replace(" own.csv", "").replace("--out logs", "--out none"));
    assert_eq!(refusal.trim(), "track.csv:1: the name of a column has 5000000 characters: not a table");
}

#[test]
fn each_range_sensor_gets_its_column() {
    let sandbox = with_streams();
    let robot = format!("{ROBOT}{SENSOR}{}{}", table("left", 90.0), table("rear", 180.0));
    sandbox.write("robot.toml", robot);
    let text = drive().iter().fold("t_s,rear_range_m,range_m,sonar_left_cm\n".to_owned(), |mut text, sample| {
        let m = sample.range_m;
        writeln!(text, "{:.3},{:.4},{m:.4},{:.2}", sample.s, m + 0.2, 100.0 * m + 10.0).expect("memory");
        text
    });
    let said = import(&sandbox, &text);
    assert!(said.contains("sonar_left_cm is of range sensor left") && said.contains(" of rear"), "{said}");
    let logs = sandbox.logs("logs");
    let rows = &logs.runs[0].rows;
    for k in 1..rows.len() {
        let first = rows.at(k).echo_cm.expect("a reading");
        let [left, rear] = [0, 1].map(|sensor| rows.further_cm(sensor, k).expect("a reading") - first);
        assert!((left - 10.0).abs() < 0.02 && (rear - 20.0).abs() < 0.02, "{left} {rear}");
    }
    let further = &sandbox.json("report.json")["recordings"][0]["further_sensors"];
    assert_eq!(
        (further[1]["sensor"].as_str(), further[1]["with_reading"].as_u64()),
        (Some("rear"), Some(rows.len() as u64))
    );
    // A sensor without readings has no column: an empty one would be that of a sensor that hears nothing.
    let without = text.replacen("sonar_left_cm", "something", 1);
    let said = import(&sandbox, &without);
    assert!(said.contains("range sensor left of robot.toml has no readings: echo_left_cm is not written"), "{said}");
    assert!(!sandbox.text("logs/run-000.csv").contains("echo_left_cm"));
}
