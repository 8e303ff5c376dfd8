//! Error messages name what was found and what to write instead.

use std::fs;

use mindgap_tests::command::Sandbox;
use mindgap_tests::rooms::{trained, with_scene};

#[test]
fn wrong_keys_and_types_are_reported_in_the_terms_of_the_file() {
    let sandbox = Sandbox::with_logs();
    let refused = |file: &str, from: &str, to: &str| {
        let before = sandbox.text(file);
        sandbox.edit(file, |text| text.replacen(from, to, 1));
        let refusal = sandbox.refused("check logs");
        sandbox.write(file, before);
        refusal
    };
    let refusal = refused("logs/scene.toml", "[[obstacle]]", "[[obstacles]]");
    assert!(refusal.contains("unknown key `obstacles`; expected one of `arena`, `obstacle`"), "{refusal}");
    let refusal = refused("logs/robot.toml", "track_cm", "track_width_cm");
    assert!(refusal.starts_with("logs/robot.toml:2: unknown key `track_width_cm`"), "{refusal}");
    let refusal = refused("logs/robot.toml", "track_cm = 11.5", "track_cm = \"11,5\"");
    assert_eq!(refusal, "logs/robot.toml:2: found the text \"11,5\", expected a number");
}

const TUPLE: &str = "  { left = 55, right = 48, when = \"larger\", threshold_cm = 42 },\n";

fn controller(step_ms: u32) -> String {
    format!("step_ms = {step_ms}\nmax_steps = 10\ntuple = [\n{}]\n", TUPLE.repeat(6))
}

#[test]
fn wrong_controllers_are_reported_with_the_correction() {
    let sandbox = with_scene();
    sandbox.write("c.toml", controller(400).replacen("left = 55", "left = \"fast\"", 1));
    let refusal = sandbox.refused("export c.toml --format nxc --out c.nxc");
    assert_eq!(refusal, "c.toml:4: found the text \"fast\", expected a whole number from -128 to 127");
    sandbox.write("c.toml", controller(200));
    let calls = [
        "simulate sim.json c.toml --scene scene.toml",
        "crosscheck sim.json logs --controller c.toml",
        "diagnose sim.json logs --controller c.toml",
    ];
    for call in calls {
        let refusal = sandbox.refused(call);
        let expected = "c.toml: has step_ms = 200, but the simulator's steps are 400 ms: write step_ms = 400";
        assert!(refusal.starts_with(expected), "{call}: {refusal}");
    }
}

#[test]
fn logs_of_another_robot_are_not_evaluated() {
    let sandbox = trained();
    sandbox.edit("logs/robot.toml", |text| text.replace("track_cm = 11.5", "track_cm = 15"));
    for call in ["evaluate sim.json logs", "crosscheck sim.json logs"] {
        let refusal = sandbox.refused(call);
        assert!(refusal.contains("track_cm is 15 in the logs' robot.toml and 11.5 in the simulator"), "{refusal}");
    }
}

#[test]
fn a_warning_about_many_files_is_printed_once() {
    let sandbox = Sandbox::with_logs();
    for run in 0..6 {
        sandbox.edit(&format!("logs/run-00{run}.csv"), |text| text.replacen("battery_mv", "mood", 1));
    }
    let warning = "mindgap: warning: logs/run-000.csv:1: unknown column \"mood\" ignored (in 6 files)\n";
    assert_eq!(sandbox.call("check logs").err, warning);
}

#[test]
fn control_characters_in_file_names_are_escaped() {
    let sandbox = Sandbox::with_logs();
    let name = "lo\u{1b}[2Jg\u{202e}s\n";
    fs::rename(sandbox.path().join("logs"), sandbox.path().join(name)).unwrap();
    let mut command = sandbox.command("check");
    let outcome = command.arg(name).output().unwrap();
    assert!(outcome.status.success());
    fs::remove_file(sandbox.path().join(name).join("robot.toml")).unwrap();
    let outcome = command.output().unwrap();
    let output = String::from_utf8(outcome.stderr).unwrap();
    assert!(
        output.starts_with("mindgap: lo\\u{1b}[2Jg\\u{202e}s\\n/robot.toml: cannot be read")
            && output.lines().count() == 1,
        "{output}"
    );
}
