//! The diagnosis of labelled logs that another program wrote, of a robot with different physics.

use std::fs;
use std::path::Path;

use mindgap_tests::command::Sandbox;
use mindgap_tests::form::{is_long, short_or_long};
use serde::Deserialize;
use toml::Table;

/// What is asked of a diagnosis as docs/reference/json.md has it.
#[derive(Deserialize)]
struct Diagnosis {
    effects: Vec<NamedEffect>,
    shrink: Option<Reduction>,
}

#[derive(Debug, Deserialize)]
struct NamedEffect {
    id: String,
    ambiguous_with: Vec<String>,
}

#[derive(Deserialize)]
struct Reduction {
    reducible_closed: f64,
}

/// A rival counts as named if its effect has at most this many.
const MOST_RIVALS: usize = 3;

/// Cases of the short form: a single effect, none, and two.
const SHORT: [&str; 3] = ["02", "11", "18"];

pub fn effects_of_another_robot_are_named(data: &Path) {
    let sandbox = Sandbox::new();
    sandbox.run(&format!("train {} --out sim.json", data.join("nominal").display()));
    let labels = fs::read_to_string(data.join("cases/labels.toml")).expect("labels");
    let labels: Table = labels.parse().expect("TOML");
    let (mut singles, mut named, mut closed, mut wrong) = (0, 0, 0, Vec::new());
    for (case, effects) in labels.iter().filter(|(case, _)| is_long() || SHORT.contains(&case.as_str())) {
        let effects: Vec<&str> = effects.as_array().expect("a list").iter().filter_map(|e| e.as_str()).collect();
        let diagnosis = diagnose(&sandbox, &data.join("cases").join(case));
        let is_named = |effect: &&str| diagnosis.effects.iter().any(|found| stands_for(found, effect));
        match effects.as_slice() {
            [] => assert!(diagnosis.effects.is_empty() && diagnosis.shrink.is_none(), "{case}: false alarm"),
            [effect] => {
                singles += 1;
                if diagnosis.effects.first().is_some_and(|first| stands_for(first, effect)) {
                    named += 1;
                    let share = diagnosis.shrink.as_ref().map_or(0.0, |s| s.reducible_closed);
                    closed += usize::from(share >= 0.8);
                } else {
                    wrong.push(format!("{case} {effect}"));
                }
            }
            several => assert!(several.iter().all(is_named), "{case}: {several:?} gave {:?}", diagnosis.effects),
        }
    }
    println!("{named} of {singles} single effects named, {closed} with at least 80 % of the reducible gap closed");
    assert!(named >= short_or_long(1, 24), "not named: {wrong:?}");
    assert!(closed >= short_or_long(1, 22), "only {closed} of {named} close 80 % of the reducible gap");
}

fn diagnose(sandbox: &Sandbox, logs: &Path) -> Diagnosis {
    sandbox.run(&format!("diagnose sim.json {} --json diagnosis.json", logs.display()));
    serde_json::from_value(sandbox.json("diagnosis.json")).expect("JSON as in docs/reference/json.md")
}

fn stands_for(found: &NamedEffect, effect: &str) -> bool {
    let rivals = &found.ambiguous_with;
    found.id == effect || (rivals.len() <= MOST_RIVALS && rivals.iter().any(|r| r == effect))
}
