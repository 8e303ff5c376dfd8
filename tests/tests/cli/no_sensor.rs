//! A robot without a range sensor on open ground: every command works that needs neither sensor nor walls.

use mindgap_tests::command::Sandbox;
use mindgap_tests::rooms::SCENE;

/// Returns a folder with small logs of a robot without a sensor, in a scene without walls.
fn without_sensor() -> Sandbox {
    let sandbox = Sandbox::new();
    sandbox.run("record --out logs --runs 12 --steps 40");
    sandbox.edit("logs/robot.toml", |text| text.split_once("[ultrasonic]").expect("a sensor").0.to_owned());
    sandbox.write("logs/scene.toml", "# Open ground.\n");
    for run in 0..12 {
        let file = format!("logs/run-{run:03}.csv");
        sandbox.edit_cells(&file, |cells| cells[6] = "");
    }
    sandbox
}

#[test]
fn motion_is_learned_evaluated_and_diagnosed_without_a_sensor() {
    let sandbox = without_sensor();
    let outcome = sandbox.call("check logs --json check.json");
    assert_eq!((outcome.code, outcome.err.as_str()), (0, ""), "{outcome:?}");
    assert!(outcome.out.contains("the robot has no range sensor: robot.toml has no [ultrasonic]"), "{}", outcome.out);
    assert_eq!(sandbox.json("check.json")["missing_networks"].as_array().map(Vec::len), Some(2));
    let outcome = sandbox.call("train logs --out sim.json");
    assert_eq!((outcome.code, outcome.err.lines().count()), (0, 2), "two networks are missing: {}", outcome.err);
    assert!(!sandbox.text("sim.json").contains("ultrasonic\""), "nor does the simulator have one");
    let judged = sandbox.run("evaluate sim.json logs");
    assert!(judged.contains("turn (deg)") && !judged.contains("echo"), "{judged}");
    for simulator in ["kinematic", "sim.json"] {
        sandbox.run(&format!("diagnose {simulator} logs --json {simulator}-diagnosis.json"));
        let diagnosis = sandbox.json(&format!("{simulator}-diagnosis.json"));
        assert_eq!(diagnosis["compared"].to_string(), "[\"forward\",\"lateral\",\"turn\"]", "{simulator}");
    }
}

#[test]
fn commands_that_need_a_sensor_say_so() {
    let sandbox = without_sensor();
    assert_eq!(sandbox.call("train logs --out sim.json").code, 0);
    sandbox.write("scene.toml", SCENE);
    let tuple = "  { left = 55, right = 48, when = \"larger\", threshold_cm = 42 },\n";
    sandbox.write("c.toml", format!("step_ms = 400\nmax_steps = 10\ntuple = [\n{}]\n", tuple.repeat(6)));
    let calls = [
        "evolve sim.json --scene scene.toml --out d.toml",
        "simulate sim.json c.toml --scene scene.toml",
        "crosscheck sim.json logs",
    ];
    for call in calls {
        let refusal = sandbox.refused(call);
        assert!(refusal.contains("the robot has no range sensor: robot.toml has no [ultrasonic]"), "{call}: {refusal}");
    }
}

#[test]
fn sensor_of_zeros_is_an_error_and_not_an_absent_sensor() {
    let sandbox = Sandbox::with_logs();
    let mut line = 0;
    sandbox.edit("logs/robot.toml", |text| {
        let body = text.split_once("[ultrasonic]").expect("a sensor").0;
        line = body.lines().count() + 1;
        format!("{body}[ultrasonic]\nx_cm = 0.0\ny_cm = 0.0\nyaw_deg = 0.0\nmin_cm = 0.0\nmax_cm = 0.0\n")
    });
    let refusal = sandbox.refused("check logs");
    assert!(refusal.starts_with(&format!("logs/robot.toml:{line}: [ultrasonic] needs numbers")), "{refusal}");
}

#[test]
fn only_a_robot_with_a_sensor_needs_a_column_of_readings() {
    let sandbox = without_sensor();
    for run in 0..12 {
        let file = format!("logs/run-{run:03}.csv");
        sandbox.edit(&file, |text| text.replacen("echo_cm", "nothing", 1));
    }
    let outcome = sandbox.call("check logs");
    assert!(outcome.code == 0 && outcome.err.contains("unknown column \"nothing\""), "{}", outcome.err);
    let sandbox = Sandbox::with_logs();
    sandbox.edit("logs/robot.toml", |text| text.split_once("[ultrasonic]").expect("a sensor").0.to_owned());
    let outcome = sandbox.call("check logs");
    assert!(outcome.err.contains("has no [ultrasonic]") && outcome.err.contains("readings ignored"), "{}", outcome.err);
}

/// On open ground a sensor reads nothing, and the controller drives on.
#[test]
fn open_ground_can_be_driven_on() {
    let sandbox = Sandbox::with_logs();
    sandbox.run("train logs --out sim.json");
    sandbox.write("open.toml", "[[start]]\nx_cm = 0\ny_cm = 0\nheading_deg = 0\n");
    let tuple = "  { left = 55, right = 48, when = \"smaller\", threshold_cm = 42 },\n";
    sandbox.write("c.toml", format!("step_ms = 400\nmax_steps = 10\ntuple = [\n{}]\n", tuple.repeat(6)));
    let output = sandbox.run("simulate sim.json c.toml --scene open.toml --runs 3");
    assert_eq!(output.matches(" timed out ").count(), 3, "{output}");
    let refusal = sandbox.refused("record --out more --scene open.toml");
    assert!(refusal.starts_with("open.toml: the scene has no room between its walls"), "{refusal}");
}
