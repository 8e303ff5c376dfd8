//! `mindgap drive`: one run of the built-in robot, logged.

use std::fs;

use mindgap_tests::command::{Workshop, workspace};
use mindgap_tests::rooms::SCENE;

fn workshop() -> Workshop {
    let workshop = Workshop::new();
    workshop.write("scene.toml", SCENE);
    let controller = workspace().join("tests/tests/golden/controller.toml");
    workshop.write("six.toml", fs::read(controller).expect("a fixed controller"));
    workshop
}

#[test]
fn a_run_is_logged_from_the_start_to_where_it_ended() {
    let workshop = workshop();
    let told = workshop.done("drive six.toml --scene scene.toml --start 2 --out run.csv");
    assert!(told.starts_with("run.csv: ") && told.contains(" cm from the target"), "{told}");
    let log = workshop.text("run.csv");
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

/// Also where its controller does not look: in the first row, and once the motors have stopped. Of ten readings near walls one
/// or two fail.
#[test]
fn the_sensor_is_read_at_both_ends_of_a_run() {
    let workshop = workshop();
    let mut read = [0; 2];
    for seed in 1..=8 {
        workshop.done(&format!("drive six.toml --scene scene.toml --seed {seed} --out run.csv --force"));
        let log = workshop.text("run.csv");
        let rows: Vec<&str> = log.lines().skip(1).collect();
        let is_read = |row: &str| row.split(',').nth(6).is_some_and(|echo_cm| !echo_cm.is_empty());
        [rows[0], rows[rows.len() - 1]].iter().zip(&mut read).for_each(|(row, read)| *read += i32::from(is_read(row)));
    }
    assert!(read.iter().all(|read| *read >= 4), "{read:?} of 8");
}

#[test]
fn a_run_takes_no_more_steps_than_its_controller_may() {
    let workshop = workshop();
    workshop.edit("six.toml", |text| text.replace("max_steps = 150", "max_steps = 2"));
    let told = workshop.done("drive six.toml --scene scene.toml --out run.csv");
    assert!(told.starts_with("run.csv: timed out after 2 steps, "), "{told}");
}

#[test]
fn the_seed_and_an_effect_decide_how_it_goes() {
    let workshop = workshop();
    let log = |name: &str, options: &str| {
        workshop.done(&format!("drive six.toml --scene scene.toml --out {name} {options}"));
        workshop.bytes(name)
    };
    let once = log("once.csv", "--seed 3");
    assert_eq!(once, log("again.csv", "--seed 3"));
    assert_ne!(once, log("other.csv", "--seed 4"));
    assert_ne!(once, log("changed.csv", "--seed 3 --effect drive_scale=0.85"));
}

#[test]
fn a_run_that_cannot_begin_is_refused() {
    let workshop = workshop();
    let problem = workshop.refused("drive six.toml --scene scene.toml --start 3 --out run.csv");
    assert_eq!(problem, "scene.toml: has 2 [[start]] table(s); there is no start 3");
    let problem = workshop.refused("drive none.toml --scene scene.toml --out run.csv");
    assert!(problem.starts_with("none.toml: cannot be read: "), "{problem}");
}
