//! What `mindgap diagnose` says of logs that tell little, or that are not the simulator's.

use std::fs;
use std::sync::LazyLock;

use mindgap_host_sim::logs::Run;
use mindgap_tests::command::Workshop;
use mindgap_tests::rooms::{trained, with_scene};
use serde_json::Value;

/// Runs of the workshop's logs.
const RUNS: usize = 6;

fn run(number: usize) -> String {
    format!("logs/run-{number:03}.csv")
}

/// Rewrites every field of all runs: `change` is given the row from 0, the column's name, and the field.
fn rewrite(workshop: &Workshop, change: impl Fn(usize, &str, &str) -> String) {
    for number in 0..RUNS {
        let text = workshop.text(&run(number));
        let (header, rows) = text.split_once('\n').expect("a header");
        let columns: Vec<&str> = header.split(',').collect();
        let rows = rows.lines().enumerate().map(|(row, line)| {
            let fields = columns.iter().zip(line.split(',')).map(|(column, field)| change(row, column, field));
            fields.collect::<Vec<String>>().join(",")
        });
        let rows: Vec<String> = rows.collect();
        workshop.write(&run(number), format!("{header}\n{}\n", rows.join("\n")));
    }
}

fn without<'a>(columns: &'a [&str]) -> impl Fn(usize, &str, &str) -> String + 'a {
    move |_, column, field| if columns.contains(&column) { String::new() } else { field.into() }
}

fn diagnosis(workshop: &Workshop) -> Value {
    workshop.done("diagnose sim.json logs --json diagnosis.json");
    workshop.json("diagnosis.json")
}

#[track_caller]
fn assert_noted(workshop: &Workshop, what: &str) {
    let diagnosis = diagnosis(workshop);
    let notes = diagnosis["notes"].as_array().expect("a list");
    assert!(notes.iter().any(|note| note.as_str().is_some_and(|n| n.contains(what))), "{notes:?}");
}

#[test]
fn logs_of_another_robot_are_refused() {
    let workshop = trained();
    workshop.edit("logs/robot.toml", |robot| robot.replace("track_cm = 11.5", "track_cm = 17.5"));
    let refusal = workshop.refused("diagnose sim.json logs");
    assert!(refusal.contains("robot mismatch") && refusal.contains("track_cm"), "{refusal}");
}

#[test]
fn logs_in_longer_steps_are_refused() {
    let workshop = trained();
    workshop.edit("logs/robot.toml", |robot| robot.replace("step_ms = 400", "step_ms = 600"));
    let refusal = workshop.refused("diagnose sim.json logs");
    assert!(refusal.contains("rows are 400 ms apart"), "{refusal}");
    rewrite(&workshop, |row, column, field| if column == "t_ms" { (600 * row).to_string() } else { field.into() });
    let refusal = workshop.refused("diagnose sim.json logs");
    assert!(refusal.contains("steps of 400 ms cannot be compared: rows are 600 ms apart"), "{refusal}");
}

/// Rows that come four times as fast as the simulator's steps are compared in its steps.
#[test]
fn logs_in_shorter_steps_are_compared_in_the_simulators() {
    let workshop = trained();
    for number in 0..RUNS {
        let text = workshop.text(&run(number));
        let (header, rows) = text.split_once('\n').expect("a header");
        let rows: Vec<Vec<&str>> = rows.lines().map(|line| line.split(',').collect()).collect();
        let number_of = |field: &str| field.parse::<f64>().ok();
        let between = |a: &str, b: &str, share: f64| {
            number_of(a).zip(number_of(b)).map_or(String::new(), |(a, b)| (a + share * (b - a)).to_string())
        };
        let quarters = rows.windows(2).flat_map(|pair| {
            (0..4).map(move |quarter| {
                let share = 0.25 * f64::from(quarter);
                let mut row: Vec<String> = pair[0].iter().map(|field| (*field).into()).collect();
                [0, 3, 4].iter().for_each(|column| row[*column] = between(pair[0][*column], pair[1][*column], share));
                // Headings that pass through half a turn stay where they are for the step.
                let passes =
                    number_of(pair[0][5]).zip(number_of(pair[1][5])).is_some_and(|(a, b)| (a - b).abs() > 180.0);
                row[5] = if passes { pair[0][5].into() } else { between(pair[0][5], pair[1][5], share) };
                row.join(",")
            })
        });
        let quarters: Vec<String> = quarters.collect();
        workshop.write(&run(number), format!("{header}\n{}\n", quarters.join("\n")));
    }
    workshop.edit("logs/robot.toml", |robot| robot.replace("step_ms = 400", "step_ms = 100"));
    // Readings come up to a quarter of a step earlier than the poses that they are compared at.
    let diagnosis = diagnosis(&workshop);
    let effects = diagnosis["effects"].as_array().expect("a list");
    let of_motion = |effect: &&Value| !effect["id"].as_str().is_some_and(|id| id.starts_with("sonar"));
    assert_eq!(effects.iter().filter(of_motion).count(), 0, "{diagnosis}");
    let refusal = workshop.refused("diagnose sim.json logs --step-ms 200");
    assert!(refusal.contains("the simulator's steps are 400 ms"), "{refusal}");
}

#[test]
fn a_simulator_of_another_version_is_refused() {
    let workshop = trained();
    workshop.edit("sim.json", |sim| sim.replacen("\"schema\": 1", "\"schema\": 9", 1));
    let refusal = workshop.refused("diagnose sim.json logs");
    assert!(refusal.contains("version 9"), "{refusal}");
}

#[test]
fn without_poses_nothing_can_be_compared() {
    let workshop = trained();
    rewrite(&workshop, without(&["x_cm", "y_cm", "heading_deg"]));
    let refusal = workshop.refused("diagnose sim.json logs");
    assert!(refusal.contains("nothing can be compared") && refusal.contains("pose"), "{refusal}");
}

#[test]
fn without_readings_motion_alone_is_compared() {
    let workshop = trained();
    rewrite(&workshop, without(&["echo_cm"]));
    assert_noted(&workshop, "There are no readings");
}

/// Somebody carries the robot about: its readings agree, and what moves it is nowhere.
#[test]
fn motion_that_no_command_asks_for_is_no_agreement() {
    let workshop = trained();
    rewrite(&workshop, |_, column, field| if ["left", "right"].contains(&column) { "0".into() } else { field.into() });
    let diagnosis = diagnosis(&workshop);
    assert_eq!(diagnosis["verdict"], "unknown", "{diagnosis}");
    assert_eq!(diagnosis["compared"], serde_json::json!(["echo_rate", "echo_value"]));
    assert!(diagnosis["not_compared"].to_string().contains("the robot moves"), "{diagnosis}");
    assert_noted(&workshop, "the robot moves");
}

#[test]
fn one_run_and_runs_alike_are_said_to_be_little() {
    let workshop = trained();
    let first = workshop.text(&run(0));
    (1..RUNS).for_each(|number| workshop.write(&run(number), &first));
    let diagnosis = diagnosis(&workshop);
    assert_eq!(diagnosis["data"][0]["finding"], "run_copied", "{diagnosis}");
    assert_noted(&workshop, "One run only");
    (1..RUNS).for_each(|number| std::fs::remove_file(workshop.path().join(run(number))).expect("a file"));
    assert_noted(&workshop, "One run only");
}

#[test]
fn few_runs_are_said_to_be_fitted_and_not_kept_back() {
    assert_noted(&trained(), "With fewer than 8 runs none is held out");
}

#[test]
fn jumps_of_the_tracker_are_told_and_cause_nothing() {
    let workshop = trained();
    assert_eq!(diagnosis(&workshop)["verdict"], "no_gap", "the simulator's own logs");
    rewrite(&workshop, |row, column, field| match (row, column, field.parse::<f64>()) {
        (12, "x_cm", Ok(x_cm)) => (x_cm + 60.0).to_string(),
        _ => field.into(),
    });
    let diagnosis = diagnosis(&workshop);
    assert_eq!(diagnosis["data"][0]["finding"], "tracker_jump", "{diagnosis}");
    assert_eq!(diagnosis["effects"], Value::Array(Vec::new()));
}

#[test]
fn a_controllers_ends_are_compared() {
    let workshop = trained();
    let tuple = "[[tuple]]\nleft = 30\nright = 30\nwhen = \"smaller\"\nthreshold_cm = 40\n";
    workshop.write("controller.toml", format!("step_ms = 400\nmax_steps = 10\n{}", tuple.repeat(6)));
    workshop.done("diagnose sim.json logs --controller controller.toml --json diagnosis.json");
    assert_eq!(workshop.json("diagnosis.json")["endings"]["runs"], RUNS);
    let refusal = workshop.refused("diagnose kinematic logs --controller controller.toml");
    assert!(refusal.contains("needs a simulator file"), "{refusal}");
}

/// A folder with forty runs in `logs` and a simulator that was trained on them in `sim.json`.
fn with_forty_runs() -> Workshop {
    static FORTY_RUNS: LazyLock<Workshop> = LazyLock::new(|| {
        let workshop = Workshop::new();
        workshop.done("record --out logs --runs 40 --seed 1");
        workshop.done("train logs --out sim.json");
        workshop
    });
    FORTY_RUNS.copy()
}

/// What the simulator's own misfit feigns grows with the logs.
#[test]
fn ever_so_many_runs_of_the_same_robot_are_no_gap() {
    let workshop = with_forty_runs();
    workshop.done("record --out many --runs 120 --seed 21");
    let said = workshop.done("diagnose sim.json many");
    assert!(said.starts_with("No gap"), "{said}");
}

/// A room, and two controllers whose fast turns no training log holds: there networks are off by degrees a step, the same in
/// all steps of all runs.
fn controllers(workshop: &Workshop) {
    let room = "[arena]\nwidth_cm = 280\nheight_cm = 240\n";
    let starts = [[60, 60, 0], [140, 70, 90]]
        .map(|[x, y, deg]| format!("[[start]]\nx_cm = {x}\ny_cm = {y}\nheading_deg = {deg}\n"));
    workshop.write("room.toml", [room, &starts[0], &starts[1]].concat());
    type Tuple = (i32, i32, &'static str, i32);
    let controller = |tuples: [Tuple; 6]| {
        let tuple = |(left, right, when, cm): Tuple| {
            format!("[[tuple]]\nleft = {left}\nright = {right}\nwhen = \"{when}\"\nthreshold_cm = {cm}\n")
        };
        format!("step_ms = 400\nmax_steps = 60\n{}", tuples.map(tuple).concat())
    };
    let one = [
        (45, 45, "smaller", 70),
        (-66, 80, "larger", 110),
        (69, 55, "smaller", 70),
        (71, -50, "larger", 110),
        (35, 80, "smaller", 70),
        (-60, -61, "larger", 100),
    ];
    let other = [
        (77, 40, "smaller", 80),
        (80, -66, "larger", 100),
        (36, 75, "smaller", 75),
        (-68, -53, "larger", 100),
        (-65, 60, "larger", 110),
        (75, 70, "smaller", 70),
    ];
    workshop.write("one.toml", controller(one));
    workshop.write("other.toml", controller(other));
}

/// Three runs of each of two controllers, of which `starts` says where they start.
fn six_runs(workshop: &Workshop, folder: &str, starts: [usize; 2], effect: &str) {
    fs::create_dir(workshop.path().join(folder)).expect("a new folder");
    workshop.write(&format!("{folder}/robot.toml"), workshop.text("hundred/robot.toml"));
    workshop.write(&format!("{folder}/scene.toml"), workshop.text("room.toml"));
    for (controller, start) in ["one", "other"].iter().zip(starts) {
        for seed in 1..=3 {
            let run = format!("{folder}/run-{controller}-{seed}.csv");
            workshop.done(&format!(
                "drive {controller}.toml --scene room.toml --start {start} --seed {seed} --out {run} {effect}"
            ));
        }
    }
}

/// Steps of the same commands have what the simulator is off by in common, and are fewer than they look; what a motor has
/// lost shows in all of them.
#[test]
fn runs_of_two_controllers_of_the_same_robot_are_no_gap() {
    let workshop = Workshop::new();
    workshop.done("record --out hundred --runs 100 --seed 1");
    workshop.done("train hundred --out sim.json");
    controllers(&workshop);
    for starts in [[1, 1], [2, 2], [1, 2], [2, 1]] {
        let folder = format!("same-{}{}", starts[0], starts[1]);
        six_runs(&workshop, &folder, starts, "");
        let said = workshop.done(&format!("diagnose sim.json {folder}"));
        assert!(said.starts_with("No gap"), "{starts:?}: {said}");
    }
    six_runs(&workshop, "weak", [1, 1], "--effect motor_asymmetry=0.15");
    let said = workshop.done("diagnose sim.json weak");
    assert!(said.starts_with("There is a gap") && said.contains("motor_asymmetry: "), "{said}");
}

#[test]
fn the_experiment_that_tells_confused_causes_apart_is_a_run() {
    let workshop = with_forty_runs();
    // Of a load so light six runs do not say whether it is one, or a weaker motor.
    workshop.done("record --out laden --runs 6 --seed 5 --effect payload=0.03");
    let said = workshop.done("diagnose sim.json laden --next-experiment next.csv");
    assert!(said.contains("cannot tell it from") && said.contains("To distinguish "), "{said}");
    let rows = Run::read(&workshop.path().join("next.csv"), |warning| panic!("{warning}")).expect("a run").rows;
    assert!(rows.len() > 5 && rows.iter().any(|row| row.command() != [0.0, 0.0]), "{rows:?}");
    let budget = workshop.done("export next.csv --format nxc-collect --out next.nxc");
    assert!(budget.contains("next.nxc written") && budget.contains(" of 400 ms at worst"), "{budget}");
    let said = workshop.done("diagnose sim.json logs --next-experiment none.csv");
    assert!(said.contains("none.csv is not written") && !workshop.path().join("none.csv").exists(), "{said}");
}

#[test]
fn the_textbook_is_refused_where_a_learned_simulator_is_needed() {
    let workshop = with_scene();
    for call in [
        "evaluate kinematic logs",
        "adapt kinematic logs --out adapted.json",
        "crosscheck kinematic logs",
        "evolve kinematic --scene scene.toml --out controller.toml",
        "simulate kinematic controller.toml --scene scene.toml",
        "loop out --sim kinematic --scene scene.toml --robot false",
    ] {
        let refused = workshop.refused(call);
        assert!(refused.starts_with("kinematic: stands for the textbook, with which mindgap diagnose"), "{refused}");
    }
}
