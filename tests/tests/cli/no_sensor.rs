//! A robot without a range sensor, and open ground: everything that needs neither works.

use mindgap_tests::command::Workshop;
use mindgap_tests::rooms::SCENE;

/// Small logs of such a robot, in which nothing is left of sensor and room.
fn without_sensor() -> Workshop {
    let workshop = Workshop::new();
    workshop.done("record --out logs --runs 12 --steps 40");
    workshop.edit("logs/robot.toml", |text| text.split_once("[ultrasonic]").expect("a sensor").0.to_owned());
    workshop.write("logs/scene.toml", "# Open ground.\n");
    for run in 0..12 {
        let file = format!("logs/run-{run:03}.csv");
        workshop.edit_cells(&file, |cells| cells[6] = "");
    }
    workshop
}

#[test]
fn motion_is_learned_judged_and_diagnosed() {
    let workshop = without_sensor();
    let done = workshop.call("check logs --json check.json");
    assert_eq!((done.code, done.err.as_str()), (0, ""), "{done:?}");
    assert!(done.out.contains("the robot has no range sensor: robot.toml has no [ultrasonic]"), "{}", done.out);
    assert_eq!(workshop.json("check.json")["missing_networks"].as_array().map(Vec::len), Some(2));
    let done = workshop.call("train logs --out sim.json");
    assert_eq!((done.code, done.err.lines().count()), (0, 2), "two networks are missing: {}", done.err);
    assert!(!workshop.text("sim.json").contains("ultrasonic\""), "nor does the simulator have one");
    let judged = workshop.done("evaluate sim.json logs");
    assert!(judged.contains("turn (deg)") && !judged.contains("echo"), "{judged}");
    for simulator in ["kinematic", "sim.json"] {
        workshop.done(&format!("diagnose {simulator} logs --json {simulator}-diagnosis.json"));
        let diagnosis = workshop.json(&format!("{simulator}-diagnosis.json"));
        assert_eq!(diagnosis["compared"].to_string(), "[\"forward\",\"lateral\",\"turn\"]", "{simulator}");
    }
}

#[test]
fn what_needs_a_sensor_says_so() {
    let workshop = without_sensor();
    assert_eq!(workshop.call("train logs --out sim.json").code, 0);
    workshop.write("scene.toml", SCENE);
    let tuple = "  { left = 55, right = 48, when = \"larger\", threshold_cm = 42 },\n";
    workshop.write("c.toml", format!("step_ms = 400\nmax_steps = 10\ntuple = [\n{}]\n", tuple.repeat(6)));
    let calls = [
        "evolve sim.json --scene scene.toml --out d.toml",
        "simulate sim.json c.toml --scene scene.toml",
        "crosscheck sim.json logs",
    ];
    for call in calls {
        let refusal = workshop.refused(call);
        assert!(refusal.contains("the robot has no range sensor: robot.toml has no [ultrasonic]"), "{call}: {refusal}");
    }
}

#[test]
fn sensor_of_zeros_is_an_error_and_not_an_absent_sensor() {
    let workshop = Workshop::with_logs();
    let mut line = 0;
    workshop.edit("logs/robot.toml", |text| {
        let body = text.split_once("[ultrasonic]").expect("a sensor").0;
        line = body.lines().count() + 1;
        format!("{body}[ultrasonic]\nx_cm = 0.0\ny_cm = 0.0\nyaw_deg = 0.0\nmin_cm = 0.0\nmax_cm = 0.0\n")
    });
    let refusal = workshop.refused("check logs");
    assert!(refusal.starts_with(&format!("logs/robot.toml:{line}: [ultrasonic] needs numbers")), "{refusal}");
}

#[test]
fn a_column_of_readings_is_needed_by_a_sensor_alone() {
    let workshop = without_sensor();
    for run in 0..12 {
        let file = format!("logs/run-{run:03}.csv");
        workshop.edit(&file, |text| text.replacen("echo_cm", "nothing", 1));
    }
    let done = workshop.call("check logs");
    assert!(done.code == 0 && done.err.contains("\"nothing\" is not known"), "{}", done.err);
    let workshop = Workshop::with_logs();
    workshop.edit("logs/robot.toml", |text| text.split_once("[ultrasonic]").expect("a sensor").0.to_owned());
    let done = workshop.call("check logs");
    assert!(done.err.contains("has no [ultrasonic]") && done.err.contains("readings ignored"), "{}", done.err);
}

/// A sensor in open ground reads nothing, and a controller drives on regardless.
#[test]
fn open_ground_is_driven_on() {
    let workshop = Workshop::with_logs();
    workshop.done("train logs --out sim.json");
    workshop.write("open.toml", "[[start]]\nx_cm = 0\ny_cm = 0\nheading_deg = 0\n");
    let tuple = "  { left = 55, right = 48, when = \"smaller\", threshold_cm = 42 },\n";
    workshop.write("c.toml", format!("step_ms = 400\nmax_steps = 10\ntuple = [\n{}]\n", tuple.repeat(6)));
    let told = workshop.done("simulate sim.json c.toml --scene open.toml --runs 3");
    assert_eq!(told.matches(" timed out ").count(), 3, "{told}");
    let refusal = workshop.refused("record --out more --scene open.toml");
    assert!(refusal.starts_with("open.toml: the scene has no room between its walls"), "{refusal}");
}
