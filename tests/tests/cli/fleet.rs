//! `mindgap diagnose --fleet`: one diagnosis per robot and a summary of all.

use std::fs;

use mindgap_tests::command::Sandbox;
use mindgap_tests::rooms::trained;
use serde_json::Value;

/// Returns a folder with the logs of six robots, two of them with a weak motor, a broken folder and a note.
fn sandbox() -> Sandbox {
    let sandbox = trained();
    fs::create_dir_all(sandbox.path().join("fleet/broken")).unwrap();
    for (name, effect) in [("a", ""), ("b", ""), ("c", WEAK), ("d", ""), ("e", ""), ("f", WEAK)] {
        let seed = 20 + u32::from(name.as_bytes()[0]);
        sandbox.run(&format!("record --out fleet/{name} --runs 6 --steps 25 --seed {seed} {effect}"));
    }
    sandbox.write("fleet/broken/run-000.csv", "t_ms\n");
    sandbox.write("fleet/notes.txt", "which robot is whose");
    sandbox
}

const WEAK: &str = "--effect motor_asymmetry=0.25";

fn ids<'a>(list: &'a Value, key: &str) -> Vec<&'a str> {
    list.as_array().expect("a list").iter().map(|entry| entry[key].as_str().expect("a text")).collect()
}

#[test]
fn a_fleet_is_diagnosed_despite_a_broken_folder_and_alike_on_any_number_of_threads() {
    let sandbox = sandbox();
    let outcome = sandbox.call_on_threads(2, "diagnose sim.json fleet --fleet out");
    let alone = sandbox.call_on_threads(1, "diagnose sim.json fleet --fleet out-of-one");
    assert!(outcome.out == alone.out && sandbox.files("out") == sandbox.files("out-of-one"));
    assert_eq!(outcome.code, 0, "{}", outcome.err);
    assert!(outcome.out.starts_with("6 of 7 robots diagnosed, 1 failed."), "{}", outcome.out);
    assert!(outcome.err.contains("broken is excluded: ") && outcome.err.contains("robot.toml"), "{}", outcome.err);

    let fleet = sandbox.json("out/fleet.json");
    assert_eq!(fleet["diagnosed"], 6);
    assert_eq!(ids(&fleet["refused"], "robot"), ["broken"]);
    assert_eq!(fleet["left_out"], Value::from(vec!["notes.txt"]));
    let weak = fleet["effects"].as_array().unwrap().iter().find(|effect| effect["id"] == "motor_asymmetry");
    let weak = weak.unwrap_or_else(|| panic!("{fleet}"));
    assert_eq!(weak["named"], 2, "{weak}");
    assert!(weak["frequency"].as_f64().unwrap() < 0.34 && weak["ci95"][1].as_f64().unwrap() > 0.5, "{weak}");
    let loss = weak["strengths"][0]["median"].as_f64().unwrap().abs();
    assert!((0.2..0.4).contains(&loss), "{weak}");
    assert_eq!(fleet["common"], Value::Array(vec![]), "two of six are not all");
    let group = |name: &str| {
        let groups = fleet["groups"].as_array().unwrap();
        groups.iter().position(|group| group["robots"].as_array().unwrap().contains(&name.into()))
    };
    assert!(group("c") == group("f") && group("c") != group("a"), "{}", fleet["groups"]);

    // Each robot has the same diagnosis as alone.
    sandbox.run("diagnose sim.json fleet/c --json alone.json");
    assert_eq!(sandbox.text("out/diagnoses/c.json"), sandbox.text("alone.json"));
    let page = sandbox.text("out/fleet.html");
    assert!(page.contains(r#"<a href="diagnoses/c.json">c</a>"#) && page.contains("broken"));
    assert!(sandbox.bytes("out/robots.parquet").starts_with(b"PAR1"));
    assert!(sandbox.run("info out/fleet.json").contains("the diagnosis of a fleet"));
}

#[test]
fn unsuitable_fleet_folders_are_refused() {
    let sandbox = trained();
    assert!(sandbox.refused("diagnose sim.json logs --fleet out").contains("contains no folder"));
    assert!(sandbox.refused("diagnose sim.json . --fleet .").contains("read by the same command"));
    assert!(sandbox.refused("diagnose sim.json nowhere --fleet out").contains("nowhere: cannot be read"));
    assert!(sandbox.refused("diagnose kinematic . --fleet out --apply better.json").contains("needs a simulator file"));
    fs::create_dir(sandbox.path().join("mine")).unwrap();
    sandbox.write("mine/diary.txt", "dear diary");
    assert!(sandbox.refused("diagnose sim.json . --fleet mine").contains(": give an empty or new folder"));
    fs::remove_dir_all(sandbox.path().join("logs")).unwrap();
    let none = sandbox.call("diagnose sim.json . --fleet out");
    assert!(none.code == 1 && none.err.contains("none of 1 robots can be diagnosed"), "{}", none.err);
    assert!(!sandbox.path().join("out").exists(), "nothing is left behind");
    assert_eq!(sandbox.call("diagnose sim.json . --fleet out --json x.json").code, 2);
}
