//! `mindgap demo`: the whole process without a robot.

use std::fs;

use mindgap_tests::command::Sandbox;
use mindgap_tests::form::{is_long, short_or_long};

use super::schemas::is_described;

/// The short form is `demo --quick`, which promises no success.
#[test]
fn evolved_controllers_reach_the_target_on_the_robot() {
    let sandbox = Sandbox::new();
    let outcome =
        sandbox.call(&format!("demo --out out --html page.html --json facts.json{}", short_or_long(" --quick", "")));
    assert_eq!(outcome.code, 0, "{}", outcome.err);
    assert_eq!(outcome.err, "", "a pipe shows no progress");
    is_described(&sandbox, "demo", "facts.json");

    // controller for | simulated: reached | median | robot: reached | median
    let rows = outcome.out.lines().filter(|line| line.starts_with("start "));
    let on_the_robot: Vec<f64> = rows
        .map(|row| {
            let percents: Vec<&str> = row.split('%').collect();
            percents[1]
                .split_whitespace()
                .next_back()
                .and_then(|n| n.parse().ok())
                .expect("a share of the robot's runs")
        })
        .collect();
    let starts = short_or_long(1, 4);
    assert_eq!(on_the_robot.len(), starts, "{}", outcome.out);
    // As in the paper: at least three of four starts, in at least two of three runs.
    assert!(!is_long() || on_the_robot.iter().filter(|percent| **percent > 60.0).count() >= 3, "{}", outcome.out);

    let out = sandbox.path().join("out");
    for start in 1..=starts {
        let program = fs::read_to_string(out.join(format!("start-{start}.nxc"))).expect("a program for each start");
        assert!(program.contains("task main()") && program.contains("simulator: simulator.json"), "{program}");
    }
    for figure in
        ["figure-2-expected-against-predicted", "figure-3-sonar-surfaces", "figure-4-simulated-and-real-paths"]
    {
        let png = fs::read(out.join(format!("{figure}.png"))).expect("a picture");
        assert!(png.starts_with(b"\x89PNG") && png.len() > 10_000, "{figure}.png");
        let svg = fs::read_to_string(out.join(format!("{figure}.svg"))).expect("a picture");
        assert!(svg.contains("<svg") && svg.trim_end().ends_with("</svg>"), "{figure}.svg");
    }
    // A motor got weak: the first controller misses, the diagnosis names the motor, and a later one reaches the target.
    let (_, repair) = outcome.out.split_once("\nwith motor_asymmetry").expect("a robot with a weak motor");
    assert!(!is_long() || repair.contains("effects: motor_asymmetry"), "{repair}");
    let state = sandbox.json("out/loop/loop.json");
    let trials = state["trials"].as_array().expect("trials");
    if is_long() {
        assert_eq!(trials[0]["real"]["reached"], false, "{repair}");
        assert!(trials.iter().any(|trial| trial["real"]["reached"] == true), "{repair}");
    }
    assert_eq!(sandbox.text("page.html").matches("data-chart=\"map\"").count(), starts + trials.len());
    assert_eq!(sandbox.text("out/demo.html"), sandbox.text("page.html"));
    let facts = sandbox.json("facts.json");
    assert_eq!(facts["starts"].as_array().map(Vec::len), Some(starts), "{facts}");
    assert_eq!(facts["repair"]["trials"].as_u64(), Some(trials.len() as u64), "{facts}");
    for file in [
        "simulator.json",
        "evaluation.json",
        "scene.toml",
        "logs/robot.toml",
        "held-out-logs/run-000.csv",
        "loop/paths.png",
    ] {
        assert!(out.join(file).is_file(), "{file}");
    }
}
