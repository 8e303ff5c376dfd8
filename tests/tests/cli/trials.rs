//! `mindgap adapt` and `mindgap loop`: what runs of a robot teach, and what must teach nothing.

use mindgap_tests::command::{Done, Workshop};
use mindgap_tests::rooms::{robot, trained, with_scene};

const LOOP: &str = "loop out --sim sim.json --scene scene.toml --max-steps 20";

fn with_robot() -> Workshop {
    let workshop = with_scene();
    robot(&workshop, "", "");
    workshop
}

#[test]
fn a_simulator_adapts_to_runs_and_keeps_its_networks() {
    let workshop = trained();
    workshop.done("record --out slow --runs 4 --steps 25 --seed 9 --effect drive_scale=0.85");
    let told = workshop.done("adapt sim.json slow --out better.json --json lesson.json");
    assert!(told.ends_with("simulator written to better.json\n"), "{told}");
    let lesson = &workshop.json("lesson.json")["lessons"][0];
    let gap = &lesson["gap"]["forward_cm"];
    assert!(gap[1].as_f64() < gap[0].as_f64(), "forward steps are less off: {lesson}");
    let (before, after) = (workshop.json("sim.json"), workshop.json("better.json"));
    for network in ["turn", "forward", "lateral", "echo_probability", "echo_value"] {
        assert_eq!(before[network], after[network], "{network}");
    }
    let evidence = |file: &serde_json::Value| file["robots"]["evidence"].as_array().map_or(0, Vec::len);
    assert!(evidence(&after) > evidence(&before));
    workshop.done("crosscheck better.json logs");
    let again = workshop.copy();
    assert_eq!(again.call_on_threads(1, "adapt sim.json slow --out better.json").code, 0);
    assert_eq!(again.bytes("better.json"), workshop.bytes("better.json"), "on any number of threads");
}

#[test]
fn an_older_simulator_cannot_adapt() {
    let workshop = trained();
    workshop.edit("sim.json", |text| {
        let mut file: serde_json::Value = serde_json::from_str(&text).expect("JSON");
        file.as_object_mut().expect("an object").remove("robots");
        file.to_string()
    });
    workshop.done("evaluate sim.json logs");
    let problem = workshop.refused("adapt sim.json logs --out better.json");
    assert!(problem.ends_with("has no parameter uncertainty: train it again"), "{problem}");
}

#[test]
fn a_loop_leaves_all_that_happened_and_goes_on_from_where_it_stood() {
    let workshop = with_robot();
    let stopped = workshop.copy();
    let told = workshop.loops("--trials 2");
    assert!(told.contains("trial 1: ") && told.contains("out/controller.toml: "), "{told}");
    let state = workshop.json("out/loop.json");
    assert_eq!(state["schema"], 1);
    let trials = state["trials"].as_array().expect("trials");
    assert!((1..=2).contains(&trials.len()), "{state}");
    for (trial, number) in trials.iter().zip(1..) {
        assert!(trial["real"]["distance_cm"].is_number() && trial["predicted"]["success"].is_number(), "{trial}");
        assert!(workshop.text(&format!("out/trial-{number}.csv")).starts_with("t_ms,"));
    }
    assert!(workshop.bytes("out/paths.png").starts_with(b"\x89PNG"));
    let controller = workshop.text("out/controller.toml");
    assert_eq!(controller.matches("[[tuple]]").count(), 6);
    // It was selected by its chance of success.
    assert!(controller.contains("success = ") && !controller.contains("fitness"), "{controller}");
    assert!(workshop.json("out/simulator.json")["robots"].is_object());

    // One trial, and then the second: the same as both at once.
    stopped.loops("--trials 1");
    stopped.loops("--trials 2");
    assert_eq!(stopped.json("out/loop.json"), state);

    // What has ended drives no more.
    workshop.write("robot.sh", "exit 1\n");
    workshop.loops("--trials 2");
    let problem = workshop.refused(&format!("{LOOP} --seed 2 --robot none"));
    assert!(problem.starts_with("out/loop.json: is of a loop with another simulator, scene, start, seed"), "{problem}");
}

/// What goes wrong with the robot is told, and nothing is learned from it.
#[test]
fn a_robot_that_fails_teaches_nothing() {
    let planned = with_robot();
    planned.write("robot.sh", "exit 3\n");
    assert!(planned.fails("").contains("the robot's command sh failed: exit status: 3"));
    let other = "sed 's/left = .*/left = 11/' \"$1\" > other.toml; set -- other.toml \"$2\" \"$3\" \"$4\" \"$5\"";
    let lost = each_row("NR > 5 { $4 = \"\"; $5 = \"\"; $6 = \"\" }");
    let moved = each_row("NR > 4 { $4 += 60; $5 += 30 }");
    let cases = [
        ("exec sleep 60", "", "took longer than 1 s and was killed"),
        ("", "rm \"$4\"", "was not written by the robot"),
        ("", "head -c 300 \"$4\" > cut; mv cut \"$4\"", "incomplete or malformed line"),
        ("", "sed -i '6,$d' \"$4\"", "incomplete log"),
        ("set -- \"$1\" \"$2\" 2 \"$4\" \"$5\"", "", "away from the start"),
        (other, "", "another controller or robot"),
        ("", &lost, "the tracker lost the robot"),
        ("", &moved, "the camera moved"),
    ];
    for (before, after, problem) in cases {
        let workshop = planned.copy();
        robot(&workshop, before, after);
        let told = workshop.fails(if before.contains("sleep") { "--robot-timeout 1" } else { "" });
        assert!(told.contains(problem), "{before}; {after}\n{told}");
        let state = workshop.json("out/loop.json");
        assert!(state["trials"][0]["real"].is_null(), "{state}");
        assert!(!workshop.path().join("out/trial-1.csv").exists());
    }
}

/// Changes the cells of a log's rows.
fn each_row(change: &str) -> String {
    format!("awk -F, -v OFS=, '{change} {{ print }}' \"$4\" > changed; mv changed \"$4\"")
}

trait Loops {
    fn looping(&self, options: &str) -> Done;
    fn loops(&self, options: &str) -> String;
    fn fails(&self, options: &str) -> String;
}

impl Loops for Workshop {
    /// Calls the loop with the robot of `robot.sh`.
    fn looping(&self, options: &str) -> Done {
        let mut command = self.command(&format!("{LOOP} {options}"));
        command.args(["--robot", "sh robot.sh"]);
        self.run(command)
    }

    #[track_caller]
    fn loops(&self, options: &str) -> String {
        let done = self.looping(options);
        assert_eq!(done.code, 0, "{}", done.err);
        done.out
    }

    /// What it says when it cannot go on.
    #[track_caller]
    fn fails(&self, options: &str) -> String {
        let done = self.looping(options);
        assert_eq!((done.code, done.out.as_str()), (1, ""), "{}", done.err);
        assert!(done.err.contains("loop stopped"), "{}", done.err);
        done.err
    }
}
