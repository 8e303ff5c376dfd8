//! `mindgap diagnose --fleet`: one diagnosis a robot, and what they say together.

use std::fs;
use std::sync::LazyLock;

use mindgap_tests::command::Workshop;
use mindgap_tests::rooms::trained;
use serde_json::Value;

/// Six robots, of which two have a weak motor, with a broken folder in their middle and a note beside them.
fn workshop() -> Workshop {
    static WORKSHOP: LazyLock<Workshop> = LazyLock::new(|| {
        let workshop = trained();
        fs::create_dir_all(workshop.path().join("fleet/broken")).unwrap();
        for (name, effect) in [("a", ""), ("b", ""), ("c", WEAK), ("d", ""), ("e", ""), ("f", WEAK)] {
            let seed = 20 + u32::from(name.as_bytes()[0]);
            workshop.done(&format!("record --out fleet/{name} --runs 6 --steps 25 --seed {seed} {effect}"));
        }
        workshop.write("fleet/broken/run-000.csv", "t_ms\n");
        workshop.write("fleet/notes.txt", "which robot is whose");
        workshop
    });
    WORKSHOP.copy()
}

const WEAK: &str = "--effect motor_asymmetry=0.25";

fn ids<'a>(list: &'a Value, key: &str) -> Vec<&'a str> {
    list.as_array().expect("a list").iter().map(|entry| entry[key].as_str().expect("a text")).collect()
}

#[test]
fn a_fleet_is_diagnosed_though_one_folder_is_broken() {
    let workshop = workshop();
    let done = workshop.call("diagnose sim.json fleet --fleet out");
    assert_eq!(done.code, 0, "{}", done.err);
    assert!(done.out.starts_with("6 of 7 robots diagnosed, 1 failed."), "{}", done.out);
    assert!(done.err.contains("broken is excluded: ") && done.err.contains("robot.toml"), "{}", done.err);

    let fleet = workshop.json("out/fleet.json");
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

    // Each one's own diagnosis is the one that it would have had alone.
    workshop.done("diagnose sim.json fleet/c --json alone.json");
    assert_eq!(workshop.text("out/diagnoses/c.json"), workshop.text("alone.json"));
    let page = workshop.text("out/fleet.html");
    assert!(page.contains(r#"<a href="diagnoses/c.json">c</a>"#) && page.contains("broken"));
    assert!(workshop.bytes("out/robots.parquet").starts_with(b"PAR1"));
    assert!(workshop.done("info out/fleet.json").contains("the diagnosis of a fleet"));
}

#[test]
fn it_is_the_same_on_any_number_of_threads() {
    let workshop = workshop();
    for (threads, out) in [(1, "one"), (2, "two")] {
        let done = workshop.call_on_threads(threads, &format!("diagnose sim.json fleet --fleet {out}"));
        assert_eq!(done.code, 0, "{}", done.err);
    }
    assert!(workshop.files("one") == workshop.files("two"));
}

#[test]
fn places_that_are_not_for_a_fleet_are_refused() {
    let workshop = trained();
    assert!(workshop.refused("diagnose sim.json logs --fleet out").contains("contains no folder"));
    assert!(workshop.refused("diagnose sim.json . --fleet .").contains("read by the same command"));
    assert!(workshop.refused("diagnose sim.json nowhere --fleet out").contains("nowhere: cannot be read"));
    assert!(
        workshop.refused("diagnose kinematic . --fleet out --apply better.json").contains("needs a simulator file")
    );
    fs::create_dir(workshop.path().join("mine")).unwrap();
    workshop.write("mine/diary.txt", "dear diary");
    assert!(workshop.refused("diagnose sim.json . --fleet mine").contains(": give an empty or new folder"));
    fs::remove_dir_all(workshop.path().join("logs")).unwrap();
    let none = workshop.call("diagnose sim.json . --fleet out");
    assert!(none.code == 1 && none.err.contains("none of 1 robots can be diagnosed"), "{}", none.err);
    assert!(!workshop.path().join("out").exists(), "nothing is left behind");
    assert_eq!(workshop.call("diagnose sim.json . --fleet out --json x.json").code, 2);
}
