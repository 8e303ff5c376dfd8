//! `mindgap diagnose` on logs with little information, and on logs of another robot than the simulator's.

use std::fs;

use mindgap_logs::Run;
use mindgap_tests::command::Sandbox;
use mindgap_tests::form::{short_or_long, spread};
use mindgap_tests::rooms::{trained, with_forty_runs, with_scene};
use serde_json::Value;

/// Number of runs in the logs.
const RUNS: usize = 6;

fn run(number: usize) -> String {
    format!("logs/run-{number:03}.csv")
}

/// Rewrites every cell of all runs. `change` takes the row from 0, the name of the column, and the cell.
fn rewrite(sandbox: &Sandbox, change: impl Fn(usize, &str, &str) -> String) {
    for number in 0..RUNS {
        let text = sandbox.text(&run(number));
        let (header, rows) = text.split_once('\n').expect("a header");
        let columns: Vec<&str> = header.split(',').collect();
        let rows = rows.lines().enumerate().map(|(row, line)| {
            let fields = columns.iter().zip(line.split(',')).map(|(column, field)| change(row, column, field));
            fields.collect::<Vec<String>>().join(",")
        });
        let rows: Vec<String> = rows.collect();
        sandbox.write(&run(number), format!("{header}\n{}\n", rows.join("\n")));
    }
}

fn without<'a>(columns: &'a [&str]) -> impl Fn(usize, &str, &str) -> String + 'a {
    move |_, column, field| if columns.contains(&column) { String::new() } else { field.into() }
}

fn diagnosis(sandbox: &Sandbox) -> Value {
    sandbox.run("diagnose sim.json logs --json diagnosis.json");
    sandbox.json("diagnosis.json")
}

#[track_caller]
fn assert_noted(sandbox: &Sandbox, what: &str) {
    let diagnosis = diagnosis(sandbox);
    let notes = diagnosis["notes"].as_array().expect("a list");
    assert!(notes.iter().any(|note| note.as_str().is_some_and(|n| n.contains(what))), "{notes:?}");
}

#[test]
fn logs_of_another_robot_are_refused() {
    let sandbox = trained();
    sandbox.edit("logs/robot.toml", |robot| robot.replace("track_cm = 11.5", "track_cm = 17.5"));
    let refusal = sandbox.refused("diagnose sim.json logs");
    assert!(refusal.contains("another robot") && refusal.contains("track_cm"), "{refusal}");
}

#[test]
fn logs_in_longer_steps_are_refused() {
    let sandbox = trained();
    sandbox.edit("logs/robot.toml", |robot| robot.replace("step_ms = 400", "step_ms = 600"));
    let refusal = sandbox.refused("diagnose sim.json logs");
    assert!(refusal.contains("rows are 400 ms apart"), "{refusal}");
    rewrite(&sandbox, |row, column, field| if column == "t_ms" { (600 * row).to_string() } else { field.into() });
    let refusal = sandbox.refused("diagnose sim.json logs");
    assert!(refusal.contains("steps of 400 ms cannot be compared: rows are 600 ms apart"), "{refusal}");
}

/// Rows at four times the rate of the simulator's steps are compared in its steps.
#[test]
fn logs_in_shorter_steps_are_compared_in_the_simulators() {
    let sandbox = trained();
    for number in 0..RUNS {
        let text = sandbox.text(&run(number));
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
                // A heading that wraps at 180 degrees is held for the step.
                let passes =
                    number_of(pair[0][5]).zip(number_of(pair[1][5])).is_some_and(|(a, b)| (a - b).abs() > 180.0);
                row[5] = if passes { pair[0][5].into() } else { between(pair[0][5], pair[1][5], share) };
                row.join(",")
            })
        });
        let quarters: Vec<String> = quarters.collect();
        sandbox.write(&run(number), format!("{header}\n{}\n", quarters.join("\n")));
    }
    sandbox.edit("logs/robot.toml", |robot| robot.replace("step_ms = 400", "step_ms = 100"));
    // Readings come up to a quarter of a step before the poses at which they are compared.
    let diagnosis = diagnosis(&sandbox);
    let effects = diagnosis["effects"].as_array().expect("a list");
    let of_motion = |effect: &&Value| !effect["id"].as_str().is_some_and(|id| id.starts_with("sonar"));
    assert_eq!(effects.iter().filter(of_motion).count(), 0, "{diagnosis}");
    let refusal = sandbox.refused("diagnose sim.json logs --step-ms 200");
    assert!(refusal.contains("the simulator's steps are 400 ms"), "{refusal}");
}

#[test]
fn a_simulator_of_another_version_is_refused() {
    let sandbox = trained();
    sandbox.edit("sim.json", |sim| sim.replacen("\"schema\": 1", "\"schema\": 9", 1));
    let refusal = sandbox.refused("diagnose sim.json logs");
    assert!(refusal.contains("version 9"), "{refusal}");
}

#[test]
fn without_poses_nothing_can_be_compared() {
    let sandbox = trained();
    rewrite(&sandbox, without(&["x_cm", "y_cm", "heading_deg"]));
    let refusal = sandbox.refused("diagnose sim.json logs");
    assert!(refusal.contains("nothing can be compared") && refusal.contains("pose"), "{refusal}");
}

#[test]
fn without_readings_motion_alone_is_compared() {
    let sandbox = trained();
    rewrite(&sandbox, without(&["echo_cm"]));
    assert_noted(&sandbox, "There are no readings");
}

/// Someone carries the robot: its readings agree with its poses, but no command moves it.
#[test]
fn motion_without_commands_is_not_agreement() {
    let sandbox = trained();
    rewrite(&sandbox, |_, column, field| if ["left", "right"].contains(&column) { "0".into() } else { field.into() });
    let diagnosis = diagnosis(&sandbox);
    assert_eq!(diagnosis["verdict"], "unknown", "{diagnosis}");
    assert_eq!(diagnosis["compared"], serde_json::json!(["echo_rate", "echo_value"]));
    assert!(diagnosis["not_compared"].to_string().contains("the robot moves"), "{diagnosis}");
    assert_noted(&sandbox, "the robot moves");
}

#[test]
fn a_single_run_and_copies_of_one_run_are_noted() {
    let sandbox = trained();
    let first = sandbox.text(&run(0));
    (1..RUNS).for_each(|number| sandbox.write(&run(number), &first));
    let diagnosis = diagnosis(&sandbox);
    assert_eq!(diagnosis["data"][0]["finding"], "run_copied", "{diagnosis}");
    assert_noted(&sandbox, "One run only");
    (1..RUNS).for_each(|number| std::fs::remove_file(sandbox.path().join(run(number))).expect("a file"));
    assert_noted(&sandbox, "One run only");
}

#[test]
fn few_runs_are_noted_as_fitted_without_hold_out() {
    assert_noted(&trained(), "With fewer than 8 runs none is held out");
}

#[test]
fn tracker_jumps_are_reported_and_explain_nothing() {
    let sandbox = trained();
    assert_eq!(diagnosis(&sandbox)["verdict"], "no_gap", "the simulator's own logs");
    rewrite(&sandbox, |row, column, field| match (row, column, field.parse::<f64>()) {
        (12, "x_cm", Ok(x_cm)) => (x_cm + 60.0).to_string(),
        _ => field.into(),
    });
    let diagnosis = diagnosis(&sandbox);
    assert_eq!(diagnosis["data"][0]["finding"], "tracker_jump", "{diagnosis}");
    assert_eq!(diagnosis["effects"], Value::Array(Vec::new()));
}

#[test]
fn final_positions_of_a_controller_are_compared() {
    let sandbox = trained();
    let tuple = "[[tuple]]\nleft = 30\nright = 30\nwhen = \"smaller\"\nthreshold_cm = 40\n";
    sandbox.write("controller.toml", format!("step_ms = 400\nmax_steps = 10\n{}", tuple.repeat(6)));
    sandbox.run("diagnose sim.json logs --controller controller.toml --json diagnosis.json");
    assert_eq!(sandbox.json("diagnosis.json")["endings"]["runs"], RUNS);
    let refusal = sandbox.refused("diagnose kinematic logs --controller controller.toml");
    assert!(refusal.contains("needs a simulator file"), "{refusal}");
}

/// The effect that the simulator's own error imitates grows with the amount of logs.
#[test]
fn many_runs_of_the_same_robot_show_no_gap() {
    let sandbox = with_forty_runs();
    let runs = short_or_long(60, 120);
    sandbox.run(&format!("record --out many --runs {runs} --seed 21"));
    let said = sandbox.run("diagnose sim.json many");
    assert!(said.starts_with("No gap"), "{said}");
}

/// Writes a room and two controllers whose fast turns are in no training log. There the networks are wrong by degrees per step,
/// in the same way in all steps of all runs.
fn controllers(sandbox: &Sandbox) {
    let room = "[arena]\nwidth_cm = 280\nheight_cm = 240\n";
    let starts = [[60, 60, 0], [140, 70, 90]]
        .map(|[x, y, deg]| format!("[[start]]\nx_cm = {x}\ny_cm = {y}\nheading_deg = {deg}\n"));
    sandbox.write("room.toml", [room, &starts[0], &starts[1]].concat());
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
    sandbox.write("one.toml", controller(one));
    sandbox.write("other.toml", controller(other));
}

/// Drives three runs of each of the two controllers from its start.
fn six_runs(sandbox: &Sandbox, folder: &str, starts: [usize; 2], effect: &str) {
    fs::create_dir(sandbox.path().join(folder)).expect("a new folder");
    sandbox.write(&format!("{folder}/robot.toml"), sandbox.text("hundred/robot.toml"));
    sandbox.write(&format!("{folder}/scene.toml"), sandbox.text("room.toml"));
    for (controller, start) in ["one", "other"].iter().zip(starts) {
        for seed in 1..=3 {
            let run = format!("{folder}/run-{controller}-{seed}.csv");
            sandbox.run(&format!(
                "drive {controller}.toml --scene room.toml --start {start} --seed {seed} --out {run} {effect}"
            ));
        }
    }
}

/// Steps under the same commands share the simulator's error and count for less than independent steps. A weak motor shows in
/// all of them.
#[test]
fn runs_of_two_controllers_on_the_same_robot_show_no_gap() {
    let sandbox = Sandbox::new();
    sandbox.run("record --out hundred --runs 100 --seed 1");
    sandbox.run("train hundred --out sim.json");
    controllers(&sandbox);
    for starts in spread(vec![[1, 1], [2, 2], [1, 2], [2, 1]], short_or_long(1, 4)) {
        let folder = format!("same-{}{}", starts[0], starts[1]);
        six_runs(&sandbox, &folder, starts, "");
        let said = sandbox.run(&format!("diagnose sim.json {folder}"));
        assert!(said.starts_with("No gap"), "{starts:?}: {said}");
    }
    six_runs(&sandbox, "weak", [1, 1], "--effect motor_asymmetry=0.15");
    let said = sandbox.run("diagnose sim.json weak");
    assert!(said.starts_with("There is a gap") && said.contains("motor_asymmetry: "), "{said}");
}

#[test]
fn the_next_experiment_is_a_run_that_can_be_exported() {
    let sandbox = with_forty_runs();
    // Of a load so light six runs do not say whether it is one, or a weaker motor.
    sandbox.run("record --out laden --runs 6 --seed 5 --effect payload=0.03");
    let said = sandbox.run("diagnose sim.json laden --next-experiment next.csv");
    assert!(said.contains("cannot distinguish it from") && said.contains("To distinguish "), "{said}");
    let rows = Run::read(&sandbox.path().join("next.csv"), |warning| panic!("{warning}")).expect("a run").rows;
    assert!(rows.len() > 5 && rows.iter().any(|row| row.command() != [0.0, 0.0]), "{rows:?}");
    let budget = sandbox.run("export next.csv --format nxc-collect --out next.nxc");
    assert!(budget.contains("next.nxc written") && budget.contains(" of 400 ms at worst"), "{budget}");
    let said = sandbox.run("diagnose sim.json logs --next-experiment none.csv");
    assert!(said.contains("none.csv was not written") && !sandbox.path().join("none.csv").exists(), "{said}");
}

#[test]
fn the_kinematic_model_is_refused_where_a_learned_simulator_is_needed() {
    let sandbox = with_scene();
    for call in [
        "evaluate kinematic logs",
        "adapt kinematic logs --out adapted.json",
        "crosscheck kinematic logs",
        "evolve kinematic --scene scene.toml --out controller.toml",
        "simulate kinematic controller.toml --scene scene.toml",
        "loop out --sim kinematic --scene scene.toml --robot false",
    ] {
        let refused = sandbox.refused(call);
        assert!(refused.starts_with("kinematic: is the textbook model, which only mindgap diagnose"), "{refused}");
    }
}
