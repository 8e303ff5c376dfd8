//! `mindgap adapt` and `mindgap loop` learn from good runs of a robot and from nothing else.

use mindgap_tests::command::{Outcome, Sandbox};
use mindgap_tests::form::is_long;
use mindgap_tests::rooms::{robot, trained, with_scene};

use super::schemas::is_described;

const LOOP: &str = "loop out --sim sim.json --scene scene.toml --max-steps 20";

fn with_robot() -> Sandbox {
    let sandbox = with_scene();
    robot(&sandbox, "", "");
    sandbox
}

#[test]
fn a_simulator_adapts_to_runs_and_keeps_its_networks() {
    let sandbox = trained();
    sandbox.run("record --out slow --runs 4 --steps 25 --seed 9 --effect drive_scale=0.85");
    let output = sandbox.run("adapt sim.json slow --out better.json --json lesson.json");
    assert!(output.ends_with("simulator written to better.json\n"), "{output}");
    let lesson = &sandbox.json("lesson.json")["lessons"][0];
    let gap = &lesson["gap"]["forward_cm"];
    assert!(gap[1].as_f64() < gap[0].as_f64(), "forward steps are less off: {lesson}");
    let (before, after) = (sandbox.json("sim.json"), sandbox.json("better.json"));
    for network in ["turn", "forward", "lateral", "echo_probability", "echo_value"] {
        assert_eq!(before[network], after[network], "{network}");
    }
    let evidence = |file: &serde_json::Value| file["robots"]["evidence"].as_array().map_or(0, Vec::len);
    assert!(evidence(&after) > evidence(&before));
    sandbox.run("crosscheck better.json logs");
    let again = sandbox.copy();
    assert_eq!(again.call_on_threads(1, "adapt sim.json slow --out better.json").code, 0);
    assert_eq!(again.bytes("better.json"), sandbox.bytes("better.json"), "on any number of threads");
}

#[test]
fn an_older_simulator_cannot_adapt() {
    let sandbox = trained();
    sandbox.edit("sim.json", |text| {
        let mut file: serde_json::Value = serde_json::from_str(&text).expect("JSON");
        file.as_object_mut().expect("an object").remove("robots");
        file.to_string()
    });
    sandbox.run("evaluate sim.json logs");
    let problem = sandbox.refused("adapt sim.json logs --out better.json");
    assert!(problem.ends_with("has no parameter uncertainty: train it again"), "{problem}");
}

#[test]
fn a_loop_records_its_trials_and_resumes() {
    let sandbox = with_robot();
    let stopped = sandbox.copy();
    let output = sandbox.loops("--trials 2");
    assert!(output.contains("trial 1: ") && output.contains("out/controller.toml: "), "{output}");
    is_described(&sandbox, "loop", "out/loop.json");
    let state = sandbox.json("out/loop.json");
    let trials = state["trials"].as_array().expect("trials");
    assert!((1..=2).contains(&trials.len()), "{state}");
    for (trial, number) in trials.iter().zip(1..) {
        assert!(trial["real"]["distance_cm"].is_number() && trial["predicted"]["success"].is_number(), "{trial}");
        assert!(sandbox.text(&format!("out/trial-{number}.csv")).starts_with("t_ms,"));
    }
    assert!(sandbox.bytes("out/paths.png").starts_with(b"\x89PNG"));
    let controller = sandbox.text("out/controller.toml");
    assert_eq!(controller.matches("[[tuple]]").count(), 6);
    // It was selected by its probability of success.
    assert!(controller.contains("success = ") && !controller.contains("fitness"), "{controller}");
    assert!(sandbox.json("out/simulator.json")["robots"].is_object());

    // One trial and then another give the same as two at once.
    if is_long() {
        stopped.loops("--trials 1");
        stopped.loops("--trials 2");
        assert_eq!(stopped.json("out/loop.json"), state);
    }

    // A finished loop drives no further run.
    sandbox.write("robot.sh", "exit 1\n");
    sandbox.loops("--trials 2");
    let problem = sandbox.refused(&format!("{LOOP} --seed 2 --robot none"));
    assert!(problem.starts_with("out/loop.json: is of a loop with another simulator, scene, start, seed"), "{problem}");
}

/// A failure of the robot is reported, and nothing is learned from its run.
#[test]
fn a_failed_run_teaches_nothing() {
    let planned = with_robot();
    planned.write("robot.sh", "exit 3\n");
    assert!(planned.fails("").contains("the robot's command sh failed: exit status: 3"));
    let other = "sed 's/left = .*/left = 11/' \"$1\" > other.toml; set -- other.toml \"$2\" \"$3\" \"$4\" \"$5\"";
    let lost = each_row("NR > 5 { $4 = \"\"; $5 = \"\"; $6 = \"\" }");
    let moved = each_row("NR > 4 { $4 += 60; $5 += 30 }");
    let cases = [
        ("exec sleep 60", "", "took longer than 1 s and was ended"),
        ("", "rm \"$4\"", "was not written by the robot"),
        ("", "head -c 300 \"$4\" > cut; mv cut \"$4\"", "incomplete or malformed line"),
        ("", "sed -i '6,$d' \"$4\"", "incomplete log"),
        ("set -- \"$1\" \"$2\" 2 \"$4\" \"$5\"", "", "away from the start"),
        (other, "", "another controller or robot"),
        ("", &lost, "the tracker lost the robot"),
        ("", &moved, "the camera moved"),
    ];
    for (before, after, problem) in cases {
        let sandbox = planned.copy();
        robot(&sandbox, before, after);
        let output = sandbox.fails(if before.contains("sleep") { "--robot-timeout 1" } else { "" });
        assert!(output.contains(problem), "{before}; {after}\n{output}");
        let state = sandbox.json("out/loop.json");
        assert!(state["trials"][0]["real"].is_null(), "{state}");
        assert!(!sandbox.path().join("out/trial-1.csv").exists());
    }
}

/// Returns a shell command that changes the rows of a log.
fn each_row(change: &str) -> String {
    format!("awk -F, -v OFS=, '{change} {{ print }}' \"$4\" > changed; mv changed \"$4\"")
}

trait Loops {
    fn looping(&self, options: &str) -> Outcome;
    fn loops(&self, options: &str) -> String;
    fn fails(&self, options: &str) -> String;
}

impl Loops for Sandbox {
    /// Calls the loop with the robot of `robot.sh`.
    fn looping(&self, options: &str) -> Outcome {
        let mut command = self.command(&format!("{LOOP} {options}"));
        command.args(["--robot", "sh robot.sh"]);
        self.execute(command)
    }

    #[track_caller]
    fn loops(&self, options: &str) -> String {
        let outcome = self.looping(options);
        assert_eq!(outcome.code, 0, "{}", outcome.err);
        outcome.out
    }

    /// Calls the loop, which has to fail, and returns its message.
    #[track_caller]
    fn fails(&self, options: &str) -> String {
        let outcome = self.looping(options);
        assert_eq!((outcome.code, outcome.out.as_str()), (1, ""), "{}", outcome.err);
        assert!(outcome.err.contains("loop stopped"), "{}", outcome.err);
        outcome.err
    }
}
