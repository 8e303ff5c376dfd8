//! Bad input is refused by one line that names file and line, with exit code 1 and nothing left behind.

use std::fs;

use mindgap_tests::command::Sandbox;
use mindgap_tests::rooms::{SCENE, trained, with_scene};

/// Changes one file of small logs, expects training to be refused, and returns the message.
fn refused_after(file: &str, change: impl FnOnce(String) -> String) -> String {
    let sandbox = Sandbox::with_logs();
    sandbox.edit(&format!("logs/{file}"), change);
    sandbox.refused("train logs --out sim.json")
}

/// Returns a run's text with changed cells in line `line`, which counts from 1 at the header.
fn with_row(text: &str, line: usize, change: impl Fn(&mut Vec<String>)) -> String {
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    let mut cells: Vec<String> = lines[line - 1].split(',').map(str::to_owned).collect();
    change(&mut cells);
    lines[line - 1] = cells.join(",");
    lines.join("\n") + "\n"
}

/// Returns a text with changed cells in every row below the header.
fn with_rows(text: &str, change: impl Fn(&mut Vec<String>)) -> String {
    (2..=text.lines().count()).fold(text.to_owned(), |text, line| with_row(&text, line, &change))
}

fn begins(problem: &str, start: &str) {
    assert!(problem.starts_with(start), "{problem}\nshould begin with\n{start}");
}

#[test]
fn missing_files_are_refused() {
    let sandbox = Sandbox::new();
    begins(&sandbox.refused("train logs --out sim.json"), "logs/robot.toml: cannot be read: ");
    begins(&sandbox.refused("evaluate sim.json logs"), "sim.json: cannot be read: ");
    begins(&sandbox.refused("export c.toml --format nxc --out c.nxc"), "c.toml: cannot be read: ");
    begins(&sandbox.refused("record --out logs --scene room.toml"), "room.toml: cannot be read: ");
    let sandbox = trained();
    begins(&sandbox.refused("evolve sim.json --scene room.toml --out c.toml"), "room.toml: cannot be read: ");
    for (file, problem) in [("scene.toml", "logs/scene.toml: cannot be read: "), ("robot.toml", "logs/robot.toml: ")] {
        let sandbox = Sandbox::with_logs();
        fs::remove_file(sandbox.path().join("logs").join(file)).unwrap();
        begins(&sandbox.refused("train logs --out sim.json"), problem);
    }
}

#[test]
fn a_folder_without_runs_is_refused() {
    let sandbox = Sandbox::with_logs();
    for run in 0..6 {
        fs::remove_file(sandbox.path().join(format!("logs/run-00{run}.csv"))).unwrap();
    }
    assert_eq!(sandbox.refused("train logs --out sim.json"), "logs: has no run-*.csv");
}

#[test]
fn missing_and_duplicate_columns_are_refused() {
    let problem = refused_after("run-002.csv", |text| text.replacen("heading_deg", "heading", 1));
    begins(&problem, "logs/run-002.csv:1: column heading_deg is missing");
    let problem = refused_after("run-002.csv", |text| text.replacen("right", "left", 1));
    begins(&problem, "logs/run-002.csv:1: column left is duplicated");
}

#[test]
fn cells_that_are_not_numbers_are_refused() {
    for (cell, word) in [("NaN", "NaN"), ("inf", "inf"), ("1e300", "1e300"), ("ten", "\"ten\"")] {
        for (column, name) in [(0, "t_ms"), (1, "left"), (3, "x_cm"), (6, "echo_cm")] {
            // Drivers write inf or nan where there was no echo.
            if name == "echo_cm" && ["NaN", "inf"].contains(&word) {
                continue;
            }
            let problem = refused_after("run-001.csv", |text| with_row(&text, 7, |cells| cells[column] = cell.into()));
            begins(&problem, &format!("logs/run-001.csv:7: {name} = {word} is not a "));
        }
    }
}

#[test]
fn numbers_out_of_range_are_refused() {
    let problem = refused_after("run-001.csv", |text| with_row(&text, 4, |cells| cells[2] = "101".into()));
    assert_eq!(problem, "logs/run-001.csv:4: right = 101 lies outside -100..100");
    let problem = refused_after("run-001.csv", |text| with_row(&text, 4, |cells| cells[6] = "-1".into()));
    assert_eq!(
        problem,
        "logs/run-001.csv:4: echo_cm = -1 is negative; leave the cell empty if there was no echo, and add 256 if a byte was read as signed"
    );
    let problem = refused_after("run-001.csv", |text| with_row(&text, 4, |cells| cells[0] = "0".into()));
    begins(&problem, "logs/run-001.csv:4: t_ms = 0 is not later than the row before");
    let problem = refused_after("run-001.csv", |text| with_row(&text, 4, |cells| cells[3].clear()));
    begins(&problem, "logs/run-001.csv:4: x_cm, y_cm and heading_deg must be all given or all empty");
}

#[test]
fn an_empty_or_one_row_log_is_refused() {
    begins(&refused_after("run-003.csv", |_| String::new()), "logs/run-003.csv:1: ");
    let lines =
        |text: String, count: usize| text.lines().take(count).map(|line| format!("{line}\n")).collect::<String>();
    let problem = refused_after("run-003.csv", |text| lines(text, 1));
    assert_eq!(problem, "logs/run-003.csv: has 0 row(s); a run needs at least two");
    let problem = refused_after("run-003.csv", |text| lines(text, 2));
    assert_eq!(problem, "logs/run-003.csv: has 1 row(s); a run needs at least two");
}

#[test]
fn a_truncated_last_line_is_refused() {
    let problem = refused_after("run-000.csv", |text| text[..text.trim_end().rfind(',').unwrap()].to_owned());
    begins(&problem, "logs/run-000.csv:27: has 9 cells where the header has 10");
}

#[test]
fn a_last_line_without_newline_is_used_with_a_warning() {
    let sandbox = Sandbox::with_logs();
    sandbox.edit("logs/run-000.csv", |text| text.trim_end().to_owned());
    let outcome = sandbox.call("train logs --out sim.json");
    assert_eq!(outcome.code, 0);
    begins(&outcome.err, "mindgap: warning: logs/run-000.csv: the last line has no line end");
}

#[test]
fn an_unknown_column_is_ignored_with_a_warning() {
    let sandbox = Sandbox::with_logs();
    sandbox.edit("logs/run-000.csv", |text| text.replacen("battery_mv", "mood", 1));
    let outcome = sandbox.call("train logs --out sim.json");
    assert_eq!(outcome.code, 0);
    assert_eq!(outcome.err, "mindgap: warning: logs/run-000.csv:1: unknown column \"mood\" ignored\n");
}

#[test]
fn rows_at_another_interval_than_the_robots_are_refused() {
    let problem = refused_after("robot.toml", |text| text.replace("step_ms = 400", "step_ms = 200"));
    begins(&problem, "logs: rows are ");
    assert!(problem.ends_with("robot.toml has step_ms = 200"), "{problem}");
}

#[test]
fn impossible_robots_and_scenes_are_refused() {
    begins(
        &refused_after("robot.toml", |text| text.replace("track_cm = 11.5", "track_cm = -1")),
        "logs/robot.toml: track_cm = -1",
    );
    begins(
        &refused_after("robot.toml", |text| text.replace("track_cm = 11.5", "track_cm = nan")),
        "logs/robot.toml: track_cm = NaN",
    );
    begins(&refused_after("robot.toml", |text| text.replace("track_cm = 11.5\n", "")), "logs/robot.toml");
    begins(
        &refused_after("scene.toml", |_| "[arena]\nwidth_cm = 0\nheight_cm = 5\n".into()),
        "logs/scene.toml:1: the arena's width",
    );
    begins(&refused_after("scene.toml", |_| "[arena]\nwidth_cm = ten\n".into()), "logs/scene.toml:2: ");
}

#[test]
fn constant_commands_train_no_motion_network() {
    let sandbox = Sandbox::with_logs();
    for run in 0..6 {
        let equal = |text: String| with_rows(&text, |cells| cells[1..3].fill("50".into()));
        sandbox.edit(&format!("logs/run-00{run}.csv"), equal);
    }
    let outcome = sandbox.call("train logs --out sim.json");
    assert_eq!(outcome.code, 0, "the two sonar networks are there: {}", outcome.err);
    // Another warning says that the runs did not drive as these commands ask.
    let warnings: Vec<&str> = outcome.err.lines().filter(|line| line.contains("network")).collect();
    assert_eq!(warnings.len(), 3, "{warnings:?}");
    for (line, network) in warnings.iter().zip(["turn", "forward", "lateral"]) {
        begins(line, &format!("mindgap: warning: no {network} network: "));
        assert!(line.contains("commands"), "{line}");
    }
    sandbox.write("scene.toml", SCENE);
    let problem = sandbox.refused("evolve sim.json --scene scene.toml --out c.toml");
    assert!(problem.contains("the simulator has no forward network"), "{problem}");
}

#[test]
fn logs_without_an_echo_train_no_sonar_network() {
    let sandbox = Sandbox::with_logs();
    for run in 0..6 {
        sandbox.edit(&format!("logs/run-00{run}.csv"), |text| with_rows(&text, |cells| cells[6].clear()));
    }
    let outcome = sandbox.call("train logs --out sim.json");
    assert_eq!(outcome.code, 0, "the three motion networks are there: {}", outcome.err);
    let warnings: Vec<&str> = outcome.err.lines().collect();
    assert_eq!(warnings.len(), 2, "{warnings:?}");
    begins(warnings[0], "mindgap: warning: no echo_probability network: ");
    begins(warnings[1], "mindgap: warning: no echo_value network: ");
    sandbox.write("scene.toml", SCENE);
    let problem = sandbox.refused("evolve sim.json --scene scene.toml --out c.toml");
    assert!(problem.contains("the simulator has no echo_probability network"), "{problem}");
}

#[test]
fn logs_that_support_no_network_are_refused() {
    let sandbox = Sandbox::with_logs();
    for run in 0..6 {
        let lost = |text: String| with_rows(&text, |cells| cells[3..6].fill(String::new()));
        sandbox.edit(&format!("logs/run-00{run}.csv"), lost);
    }
    begins(&sandbox.refused("train logs --out sim.json"), "no network can be trained on these logs (turn: ");
}

#[test]
fn a_room_too_small_for_the_robot_is_refused() {
    let sandbox = trained();
    let small = "[arena]\nwidth_cm = 15\nheight_cm = 15\n\n[target]\nx_cm = 8\ny_cm = 8\n\n[[start]]\nx_cm = 7\ny_cm = 7\nheading_deg = 0\n";
    sandbox.write("small.toml", small);
    begins(&sandbox.refused("record --out more --scene small.toml --runs 2"), "small.toml: ");
    begins(
        &sandbox.refused("evolve sim.json --scene small.toml --out c.toml"),
        "small.toml: start 1 leaves no room for a robot of radius 10 cm",
    );
}

#[test]
fn impossible_starts_and_targets_are_refused() {
    let sandbox = trained();
    sandbox.write("c.toml", CONTROLLER);
    let change = |from: &str, to: &str| {
        assert!(SCENE.contains(from));
        sandbox.write("scene.toml", SCENE.replacen(from, to, 1));
    };
    let calls = [
        "evolve sim.json --scene scene.toml --out d.toml",
        "simulate sim.json c.toml --scene scene.toml --json r.json",
    ];
    for call in calls {
        change("x_cm = 40\ny_cm = 40", "x_cm = 95\ny_cm = 75");
        begins(&sandbox.refused(call), "scene.toml:15: the start lies outside the arena or inside an obstacle");
        change("x_cm = 160", "x_cm = 260");
        begins(&sandbox.refused(call), "scene.toml:11: the target lies outside the arena");
        sandbox.write("scene.toml", SCENE);
        begins(
            &sandbox.refused(&format!("{call} --start 3")),
            "scene.toml: has 2 [[start]] table(s); there is no start 3",
        );
        begins(
            &sandbox.refused(&format!("{call} --start 0")),
            "scene.toml: has 2 [[start]] table(s); there is no start 0",
        );
    }
    sandbox.write(
        "scene.toml",
        "[arena]\nwidth_cm = 200\nheight_cm = 150\n\n[[start]]\nx_cm = 40\ny_cm = 40\nheading_deg = 0\n",
    );
    assert_eq!(sandbox.refused(calls[0]), "scene.toml: has no [target]");
}

const CONTROLLER: &str = "\
step_ms = 400
max_steps = 10
tuple = [
  { left = 55, right = 48, when = \"larger\", threshold_cm = 42 },
  { left = 55, right = 48, when = \"larger\", threshold_cm = 42 },
  { left = 55, right = 48, when = \"larger\", threshold_cm = 42 },
  { left = 55, right = 48, when = \"larger\", threshold_cm = 42 },
  { left = 55, right = 48, when = \"larger\", threshold_cm = 42 },
  { left = 55, right = 48, when = \"larger\", threshold_cm = 42 },
]
";

#[test]
fn options_of_another_export_format_are_refused() {
    let sandbox = Sandbox::new();
    sandbox.write("c.toml", CONTROLLER);
    for options in ["--format rxe --log a.csv", "--format c --display"] {
        let refusal = sandbox.refused(&format!("export c.toml --out c.out {options}"));
        assert_eq!(refusal, "c.toml: a log and a display need a controller and format nxc");
    }
}

#[test]
fn scripts_that_cannot_be_driven_are_refused() {
    let sandbox = Sandbox::new();
    let header = "t_ms,left,right,x_cm,y_cm,heading_deg,echo_cm\n";
    sandbox.write("s.csv", format!("{header}0,10,10,,,,\n400,10,10,,,,\n900,10,10,,,,\n"));
    let refusal = sandbox.refused("export s.csv --format nxc-collect --out s.nxc");
    assert_eq!(refusal, "s.csv: is not a script: its rows must be the same whole number of milliseconds apart");
    sandbox.write("s.csv", format!("{header}0,10,10,,,,\n50,10,10,,,,\n"));
    let refusal = sandbox.refused("export s.csv --format nxc-collect --out s.nxc");
    assert!(refusal.starts_with("s.csv: ") && refusal.contains("50"), "{refusal}");
    let wrong = sandbox.call("export s.csv --format nxc-collect --out s.nxc --steps 10");
    assert!(wrong.code == 2 && wrong.err.contains("cannot be used with"), "{}", wrong.err);
}

#[test]
fn impossible_controllers_are_refused() {
    let sandbox = with_scene();
    let calls = ["export c.toml --format nxc --out c.nxc", "simulate sim.json c.toml --scene scene.toml --json r.json"];
    let line = "  { left = 55, right = 48, when = \"larger\", threshold_cm = 42 },\n";
    for call in calls {
        let refused = |controller: String| {
            assert_ne!(controller, CONTROLLER);
            sandbox.write("c.toml", controller);
            sandbox.refused(call)
        };
        assert_eq!(refused(CONTROLLER.replacen(line, "", 1)), "c.toml: has 5 tuples; a controller has exactly 6");
        assert_eq!(
            refused(CONTROLLER.replacen(line, &line.repeat(2), 1)),
            "c.toml: has 7 tuples; a controller has exactly 6"
        );
        assert_eq!(refused(CONTROLLER.replacen("55", "101", 1)), "c.toml:4: a speed lies outside -100..100");
        assert_eq!(refused(CONTROLLER.replacen("42", "300", 1)), "c.toml:4: the threshold lies outside 0..255 cm");
        begins(&refused(CONTROLLER.replacen("larger", "wider", 1)), "c.toml:4: ");
        begins(&refused(CONTROLLER.replacen("55", "1e9", 1)), "c.toml:4: ");
        begins(&refused(CONTROLLER.replacen("max_steps = 10", "max_steps = 0", 1)), "c.toml: max_steps");
        begins(&refused("not a controller".into()), "c.toml:1: ");
    }
}

/// A simulator whose networks see filtered commands drives on the PC; a board would drive with something else.
#[test]
fn networks_behind_a_filter_are_not_exported() {
    let sandbox = trained().copy();
    let filter =
        "\"filter\": {\"dead_time_steps\": 0.5, \"lag_steps\": 0.4, \"turn_lag_steps\": 0.0, \"drift_factor\": 1.0},";
    sandbox.edit("sim.json", |text| text.replacen("\"schema\": 1,", &format!("\"schema\": 1, {filter}"), 1));
    assert!(sandbox.run("info sim.json").contains("filter of the drive: dead time 200 ms, lag 160 ms"));
    let refused = "sim.json: the motion networks see commands behind a filter (dead time 200 ms, lag 160 ms)";
    begins(&sandbox.refused("export sim.json --format c --out networks.h"), refused);
    begins(&sandbox.refused("export sim.json --format pybricks --out networks.py"), refused);
    sandbox.edit("sim.json", |text| text.replacen("\"lag_steps\": 0.4", "\"lag_steps\": -0.4", 1));
    begins(
        &sandbox.refused("evaluate sim.json logs"),
        "sim.json: the filter of the drive holds numbers that cannot be",
    );
}

#[test]
fn invalid_simulator_files_are_refused() {
    let sandbox = trained();
    let refused = |change: &dyn Fn(String) -> String| {
        let copy = sandbox.copy();
        copy.edit("sim.json", change);
        copy.refused("evaluate sim.json logs --json figures.json")
    };
    begins(
        &refused(&|text| text.replacen("\"schema\": 1", "\"schema\": 99", 1)),
        "sim.json: is a simulator file of version 99",
    );
    begins(&refused(&|text| text[..text.len() / 2].to_owned()), "sim.json:");
    begins(&refused(&|_| "[arena]\n".into()), "sim.json:1: is no simulator file of mindgap");
    let changed = |place: &str, value: serde_json::Value| {
        refused(&|text| {
            let mut file: serde_json::Value = serde_json::from_str(&text).expect("JSON");
            *file.pointer_mut(place).unwrap_or_else(|| panic!("{place}")) = value.clone();
            file.to_string()
        })
    };
    begins(&changed("/robot/track_cm", 0.into()), "sim.json: robot: track_cm = 0 must lie between 0.001 and 100000");
    begins(&changed("/robot/step_ms", 1e300.into()), "sim.json: robot: step_ms = 1");
    let reversed = serde_json::json!([80.0, -80.0]);
    begins(
        &changed("/commands", reversed.clone()),
        "sim.json: commands [80, -80] must be the smallest and the largest",
    );
    begins(
        &changed("/reference/sonar/range_cm", reversed),
        "sim.json: the reference model holds numbers that cannot be",
    );
    let with = |effect: &str, ms: f64| {
        refused(&|text| {
            let mut file: serde_json::Value = serde_json::from_str(&text).expect("JSON");
            file["added"] = serde_json::json!([{ "effect": effect, "variant": "delay", "parameters": { "ms": ms } }]);
            file.to_string()
        })
    };
    let known = "sim.json: the added effect latency (delay) is not possible: this program knows no such variant with";
    begins(&with("latency", -4000.0), known);
    let unknown =
        "sim.json: the added effect latencies (delay) is not possible: it is not known to this program; did you";
    begins(&with("latencies", 100.0), unknown);
}

#[test]
fn invalid_effect_files_are_refused() {
    let sandbox = trained();
    let refused = || sandbox.refused("diagnose sim.json logs --effects own.toml");
    begins(&refused(), "own.toml: cannot be read: ");
    sandbox.write("own.toml", "[[effect]]\nid = \"mine\"\n");
    begins(&refused(), "own.toml:1: missing field `description`");
    let effect = "[[effect]]\nid = \"mine\"\ndescription = \"?\"\nchange.turn_rad = \"turn_rad + k * speed\"\n\
                  [[effect.parameter]]\nname = \"k\"\nnominal = 0.0\nbounds = [-1.0, 1.0]\n";
    sandbox.write("own.toml", format!("# Mine.\n{effect}"));
    begins(&refused(), "own.toml:2: effect mine: change.turn_rad: speed is not known here; known are left, right, ");
    sandbox.write("own.toml", effect.replace("speed", "left"));
    sandbox.write("other.toml", effect.replace("speed", "right"));
    let twice = sandbox.refused("diagnose sim.json logs --effects own.toml --effects other.toml");
    begins(&twice, "other.toml: effect mine is in another file too");
}
