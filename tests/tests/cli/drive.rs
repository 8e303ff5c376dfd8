//! `mindgap drive`: one run of the built-in robot, logged.

use std::fs;

use mindgap_tests::command::{Sandbox, workspace};
use mindgap_tests::rooms::SCENE;

fn sandbox() -> Sandbox {
    let sandbox = Sandbox::new();
    sandbox.write("scene.toml", SCENE);
    let controller = workspace().join("tests/tests/golden/controller.toml");
    sandbox.write("six.toml", fs::read(controller).expect("a fixed controller"));
    sandbox
}

#[test]
fn a_run_is_logged_from_start_to_end() {
    let sandbox = sandbox();
    let output = sandbox.run("drive six.toml --scene scene.toml --start 2 --out run.csv");
    assert!(output.starts_with("run.csv: ") && output.contains(" cm from the target"), "{output}");
    let log = sandbox.text("run.csv");
    let rows: Vec<Vec<f64>> = log
        .lines()
        .skip(1)
        .map(|row| row.split(',').take(6).map(|cell| cell.parse().unwrap_or(f64::NAN)).collect())
        .collect();
    // Start 2 is (100, 30), facing 90 degrees; the tracker errs by millimetres and a degree.
    assert!((rows[0][3] - 100.0).abs() < 2.0 && (rows[0][4] - 30.0).abs() < 2.0, "{log}");
    assert!((rows[0][5] - 90.0).abs() < 8.0, "{log}");
    let last = &rows[rows.len() - 1];
    assert_eq!(last[1..3], [0.0, 0.0], "the motors are stopped");
}

/// The sensor is read in the first row and after the motors have stopped too, where the controller needs no reading. One or two
/// of ten readings near walls fail.
#[test]
fn the_sensor_is_read_at_both_ends_of_a_run() {
    let sandbox = sandbox();
    let mut read = [0; 2];
    for seed in 1..=8 {
        sandbox.run(&format!("drive six.toml --scene scene.toml --seed {seed} --out run.csv --force"));
        let log = sandbox.text("run.csv");
        let rows: Vec<&str> = log.lines().skip(1).collect();
        let is_read = |row: &str| row.split(',').nth(6).is_some_and(|echo_cm| !echo_cm.is_empty());
        [rows[0], rows[rows.len() - 1]].iter().zip(&mut read).for_each(|(row, read)| *read += i32::from(is_read(row)));
    }
    assert!(read.iter().all(|read| *read >= 4), "{read:?} of 8");
}

#[test]
fn a_run_stops_at_the_controllers_step_limit() {
    let sandbox = sandbox();
    sandbox.edit("six.toml", |text| text.replace("max_steps = 150", "max_steps = 2"));
    let output = sandbox.run("drive six.toml --scene scene.toml --out run.csv");
    assert!(output.starts_with("run.csv: timed out after 2 steps, "), "{output}");
}

#[test]
fn a_run_depends_on_seed_and_effect() {
    let sandbox = sandbox();
    let log = |name: &str, options: &str| {
        sandbox.run(&format!("drive six.toml --scene scene.toml --out {name} {options}"));
        sandbox.bytes(name)
    };
    let once = log("once.csv", "--seed 3");
    assert_eq!(once, log("again.csv", "--seed 3"));
    assert_ne!(once, log("other.csv", "--seed 4"));
    assert_ne!(once, log("changed.csv", "--seed 3 --effect drive_scale=0.85"));
}

#[test]
fn a_run_that_cannot_start_is_refused() {
    let sandbox = sandbox();
    let problem = sandbox.refused("drive six.toml --scene scene.toml --start 3 --out run.csv");
    assert_eq!(problem, "scene.toml: has 2 [[start]] table(s); there is no start 3");
    let problem = sandbox.refused("drive none.toml --scene scene.toml --out run.csv");
    assert!(problem.starts_with("none.toml: cannot be read: "), "{problem}");
}

#[test]
fn a_script_is_driven_where_there_is_room_for_it() {
    let sandbox = sandbox();
    sandbox.write("script.csv", "t_ms,left,right\n0,40,40\n800,30,-30\n2000,0,0\n");
    let said = sandbox.run("drive script.csv --scene scene.toml --seed 3 --out run.csv");
    assert!(said.starts_with("run.csv: finished after 5 steps"), "{said}");
    let log = sandbox.text("run.csv");
    let commands: Vec<Vec<&str>> = log.lines().skip(1).map(|row| row.split(',').skip(1).take(2).collect()).collect();
    let spins = [["30", "-30"]; 3];
    assert_eq!(commands, [&[["40", "40"]; 2][..], &spins, &[["0", "0"]]].concat());
    let at_start = sandbox.run("drive script.csv --scene scene.toml --start 2 --out run.csv --force");
    assert!(at_start.contains("finished") && sandbox.text("run.csv") != log, "{at_start}");
    let refused = sandbox.refused("drive script.csv --scene scene.toml --start 9 --out other.csv");
    assert!(refused.contains("scene.toml"), "{refused}");
    sandbox.write("script.csv", "t_ms,left\n0,40\n800,30\n");
    let refused = sandbox.refused("drive script.csv --scene scene.toml --out other.csv");
    assert!(refused.contains("script.csv") && refused.contains("right is missing"), "{refused}");
}
