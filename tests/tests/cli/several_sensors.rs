//! Robots with several range sensors, each learned, evaluated, diagnosed and shown under its name.

use mindgap_tests::command::Sandbox;
use mindgap_tests::form::{short_or_long, spread};
use mindgap_tests::range_sensors::{add, table};
use mindgap_tests::rooms::SCENE;
use serde_json::Value;

/// Returns a sandbox with logs of a robot whose second sensor looks to the left.
fn with_left(runs: usize, points_deg: f64) -> Sandbox {
    let sandbox = Sandbox::new();
    sandbox.run(&format!("record --out logs --runs {runs} --seed 5"));
    add(&sandbox, "logs", "left", [60.0, points_deg]);
    sandbox
}

/// Returns the names of effects in a diagnosis with their sensors.
fn effects(diagnosis: &Value) -> Vec<(String, Option<String>)> {
    let text = |value: &Value| value.as_str().map(str::to_owned);
    let effects = diagnosis["effects"].as_array().expect("effects").iter();
    effects.map(|effect| (text(&effect["id"]).expect("an id"), text(&effect["sensor"]))).collect()
}

#[test]
fn turned_sensor_is_named_and_the_other_is_not() {
    let sandbox = with_left(16, 60.0);
    sandbox.run("train logs --out sim.json");
    sandbox.run("evaluate sim.json logs --json accuracy.json --html accuracy.html");
    let networks = &sandbox.json("accuracy.json")["networks"];
    for network in ["echo_value", "echo_value_left"] {
        assert!(networks[network]["r2"].as_f64().is_some_and(|r2| r2 > 0.6), "{networks}");
    }
    assert!(networks["echo_probability_left"]["brier"].is_number(), "{networks}");
    assert!(sandbox.text("accuracy.html").contains("sonar reading of left"));

    sandbox.run("diagnose sim.json logs --json same.json");
    assert_eq!(sandbox.json("same.json")["verdict"], "no_gap");

    // The same motion, so that nothing but the sensor differs.
    sandbox.run("record --out turned --runs 16 --seed 5");
    add(&sandbox, "turned", "left", [60.0, 70.0]);
    let text = sandbox.run("diagnose sim.json turned --json turned.json --html turned.html --apply better.json");
    let turned = sandbox.json("turned.json");
    assert_eq!(effects(&turned), [("sonar_yaw".into(), Some("left".into()))], "{text}");
    let degrees = turned["effects"][0]["parameters"]["deg"].as_f64().expect("an angle");
    assert!((degrees - 10.0).abs() < 2.5, "{degrees}");
    assert!(text.contains("sonar_yaw of left"), "{text}");
    assert!(sandbox.text("turned.html").contains("of left"));
    let shares: f64 =
        turned["budget"].as_array().expect("parts").iter().filter_map(|part| part["share"].as_f64()).sum();
    assert!((shares - 1.0).abs() < 1e-3, "{shares}");
    assert!(turned["where"].as_array().expect("strata").iter().all(|stratum| stratum["sensor"] == "left"), "{turned}");

    let added = sandbox.json("better.json")["added"].clone();
    assert_eq!(
        (added[0]["effect"].as_str(), added[0]["sensor"].as_str()),
        (Some("sonar_yaw"), Some("left")),
        "{added}"
    );
}

#[test]
fn sensors_are_shown_by_check_info_and_the_textbook() {
    let sandbox = with_left(8, 70.0);
    let text = sandbox.run("check logs --json check.json");
    assert!(text.contains("sensor    left: reads"), "{text}");
    let holds = &sandbox.json("check.json")["holds"];
    assert_eq!(holds["sensors"][0]["sensor"], "left");
    let detectable = holds["detectable"].as_array().expect("a list");
    let of = |sensor: &str| detectable.iter().any(|of| of["id"] == "sonar_yaw" && of["sensor"] == sensor);
    assert!(of("left") && of("ultrasonic"), "{holds}");
    assert!(sandbox.run("info logs").contains("range sensors ultrasonic, left"));
    sandbox.run("diagnose kinematic logs --json kinematic.json");
    let yaw = ("sonar_yaw".to_owned(), Some("left".to_owned()));
    assert!(effects(&sandbox.json("kinematic.json")).contains(&yaw));
}

/// Writes one number into every cell of a sensor.
fn stick(sandbox: &Sandbox, runs: usize, column: &str) {
    for run in 0..runs {
        let file = format!("logs/run-{run:03}.csv");
        let text = sandbox.text(&file);
        let index = text.lines().next().and_then(|header| header.split(',').position(|name| name == column));
        let index = index.expect("a column");
        sandbox.edit_cells(&file, |cells| cells[index] = "87");
    }
}

#[test]
fn a_stuck_sensor_is_withheld_alone() {
    let sensors = vec![("echo_left_cm", "left", "ultrasonic"), ("echo_cm", "ultrasonic", "left")];
    for (column, stuck, sound) in spread(sensors, short_or_long(1, 2)) {
        let sandbox = with_left(6, 60.0);
        stick(&sandbox, 6, column);
        sandbox.run("diagnose kinematic logs --json gap.json");
        let gap = sandbox.json("gap.json");
        let withheld = gap["not_compared"].as_array().expect("a list");
        let sensors: Vec<&str> = withheld.iter().filter_map(|entry| entry["sensor"].as_str()).collect();
        assert!(sensors.contains(&stuck) && !sensors.contains(&sound), "{withheld:?}");
        let of_stuck = |entry: &&Value| entry["sensor"] == stuck;
        let reasons: Vec<&str> =
            withheld.iter().filter(of_stuck).filter_map(|entry| entry["reason"].as_str()).collect();
        assert!(reasons.iter().all(|reason| reason.contains("the sensor is stuck")), "{reasons:?}");
        let outcome = sandbox.call("train logs --out sim.json");
        assert!(outcome.code == 0 && outcome.err.contains("the sensor is stuck"), "{}", outcome.err);
        let simulator = sandbox.run("info sim.json");
        assert!(simulator.contains(sound), "{simulator}");
    }
    let sandbox = with_left(6, 60.0);
    ["echo_cm", "echo_left_cm"].iter().for_each(|column| stick(&sandbox, 6, column));
    assert!(sandbox.refused("train logs --out none.json").contains("the sensor is stuck"));
}

#[test]
fn first_of_range_sensors_takes_the_place_of_ultrasonic() {
    let sandbox = Sandbox::new();
    sandbox.run("record --out logs --runs 12 --seed 5");
    sandbox.run("train logs --out usual.json");
    sandbox.run("evaluate usual.json logs --json usual-accuracy.json");
    sandbox.edit("logs/robot.toml", |text| text.replace("[ultrasonic]", "[[range_sensor]]\nname = \"front\""));
    for run in 0..12 {
        sandbox.edit(&format!("logs/run-{run:03}.csv"), |text| text.replacen("echo_cm", "echo_front_cm", 1));
    }
    sandbox.run("train logs --out front.json");
    sandbox.run("evaluate front.json logs --json front-accuracy.json");
    let [usual, front] = ["usual-accuracy.json", "front-accuracy.json"].map(|name| sandbox.json(name));
    assert_eq!(front["networks"]["echo_value_front"], usual["networks"]["echo_value"]);
    let tuple = "  { left = 55, right = 48, when = \"larger\", threshold_cm = 42, sensor = \"front\" },\n";
    sandbox.write("c.toml", format!("step_ms = 400\nmax_steps = 10\ntuple = [\n{}]\n", tuple.repeat(6)));
    let scene = "--scene scene.toml --start 1 --runs 2 --json";
    sandbox.write("scene.toml", SCENE);
    sandbox.run(&format!("simulate front.json c.toml {scene} front-runs.json"));
    sandbox.edit("c.toml", |text| text.replace(", sensor = \"front\"", ""));
    sandbox.run(&format!("simulate usual.json c.toml {scene} usual-runs.json"));
    assert_eq!(sandbox.json("front-runs.json"), sandbox.json("usual-runs.json"));
}

#[test]
fn controllers_ask_one_sensor_that_the_robot_has() {
    let sandbox = with_left(12, 60.0);
    sandbox.run("train logs --out sim.json");
    sandbox.write("scene.toml", SCENE);
    let controller = |sensors: [&str; 6]| {
        let tuple = |sensor| format!("  {{ left = 50, right = 50, when = \"smaller\", threshold_cm = 60{sensor} }},\n");
        sandbox
            .write("c.toml", format!("step_ms = 400\nmax_steps = 40\ntuple = [\n{}]\n", sensors.map(tuple).concat()));
    };
    let left = ", sensor = \"left\"";
    let simulate = "simulate sim.json c.toml --scene scene.toml --runs 3";
    controller([""; 6]);
    let ahead = sandbox.run(simulate);
    controller([left; 6]);
    assert_ne!(sandbox.run(simulate), ahead, "another sensor sees other walls");
    let refusal = sandbox.refused("drive c.toml --scene scene.toml --out run.csv");
    assert!(refusal.contains("asks range sensor \"left\""), "{refusal}");
    sandbox.run("export c.toml --format rust --out c.rs");
    controller(["", left, "", "", "", ""]);
    for call in [simulate, "export c.toml --format rust --out d.rs"] {
        let refusal = sandbox.refused(call);
        assert!(refusal.starts_with("c.toml: tuple 1 asks range sensor \"ultrasonic\" and tuple 2"), "{refusal}");
    }
    controller([", sensor = \"rear\""; 6]);
    let refusal = sandbox.refused(simulate);
    assert!(refusal.starts_with("c.toml: the simulator's robot has no range sensor \"rear\""), "{refusal}");
}

#[test]
fn impossible_sensors_are_refused_at_their_line() {
    let sandbox = Sandbox::with_logs();
    let robot = sandbox.text("logs/robot.toml");
    let line = robot.lines().count() + 2;
    let refused = |tables: &str| {
        sandbox.write("logs/robot.toml", format!("{robot}{tables}"));
        sandbox.refused("check logs")
    };
    let twice = table("left", 60.0) + &table("left", 90.0);
    let refusal = refused(&twice);
    let second = line + table("left", 60.0).lines().count();
    assert!(
        refusal.starts_with(&format!("logs/robot.toml:{second}: two range sensors are named \"left\"")),
        "{refusal}"
    );
    let refusal = refused(&table("ultrasonic", 60.0));
    assert!(
        refusal.starts_with(&format!("logs/robot.toml:{line}: a range_sensor is named \"ultrasonic\"")),
        "{refusal}"
    );
    let refusal = refused(&table("le ft", 60.0));
    assert!(refusal.starts_with(&format!("logs/robot.toml:{line}: the range sensor's name \"le ft\"")), "{refusal}");
}

#[test]
fn columns_without_a_sensor_and_sensors_without_a_column_are_reported() {
    let sandbox = with_left(6, 60.0);
    sandbox.edit("logs/run-003.csv", |text| text.replacen("echo_left_cm", "echo_right_cm", 1));
    let outcome = sandbox.call("diagnose kinematic logs --json diagnosis.json");
    assert_eq!(outcome.code, 0, "{outcome:?}");
    assert!(
        outcome.err.contains("column \"echo_right_cm\" ignored: robot.toml has no range_sensor named"),
        "{}",
        outcome.err
    );
    assert!(
        outcome.err.contains("run-003 has no column echo_left_cm: range sensor \"left\" is not compared"),
        "{}",
        outcome.err
    );
    let diagnosis = sandbox.json("diagnosis.json");
    let not_compared = diagnosis["not_compared"].as_array().expect("a list");
    let of_left = not_compared.iter().filter(|not| not["sensor"] == "left").count();
    assert_eq!(of_left, 2, "{diagnosis}");
    assert!(effects(&diagnosis).iter().all(|(_, sensor)| sensor.as_deref() != Some("left")), "{diagnosis}");
    assert!(outcome.out.contains("Range sensor left is not compared: There are no readings"), "{}", outcome.out);
}
