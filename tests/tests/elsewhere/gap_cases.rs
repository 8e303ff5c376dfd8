//! The diagnosis on labelled logs that another program wrote, of a robot with other physics.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::sync::OnceLock;

use mindgap_host_sim::evaluation::observations::Observations;
use mindgap_host_sim::gap::calibration::Calibration;
use mindgap_host_sim::gap::minimal;
use mindgap_host_sim::gap::verdict::Verdict;
use mindgap_host_sim::inspection::Inspection;
use mindgap_host_sim::logs::Logs;
use mindgap_host_sim::simulator::Simulator;
use mindgap_host_sim::simulator::baseline::Baseline;
use mindgap_tests::command::Workshop;
use serde::Deserialize;
use serde_json::{Map, Value};
use toml::Table;

/// The part of diagnosis.json that is tested.
#[derive(Deserialize)]
struct Diagnosis {
    verdict: Verdict,
    effects: Vec<NamedEffect>,
    shrink: Option<Reduction>,
}

#[derive(Debug, Deserialize)]
struct NamedEffect {
    id: String,
    ambiguous_with: Vec<String>,
    intervals: Map<String, Value>,
}

#[derive(Deserialize)]
struct Reduction {
    reducible_closed: f64,
}

/// A rival counts as named while an effect has no more than this many.
const MOST_RIVALS: usize = 3;

/// A simulator of the robot, and the diagnosis of each case.
struct Diagnosed {
    simulator: Simulator,
    cases: BTreeMap<String, Diagnosis>,
}

/// Diagnoses all cases once for all tests.
fn diagnosed(data: &Path) -> &'static Diagnosed {
    static DIAGNOSED: OnceLock<Diagnosed> = OnceLock::new();
    DIAGNOSED.get_or_init(|| {
        let workshop = Workshop::new();
        workshop.done(&format!("train {} --out sim.json", data.join("nominal").display()));
        let simulator = Simulator::read(&workshop.path().join("sim.json")).expect("a simulator");
        let diagnosis = |case: &String| (case.clone(), diagnose(&workshop, &data.join("cases").join(case)));
        Diagnosed { simulator, cases: labels(data).keys().map(diagnosis).collect() }
    })
}

fn labels(data: &Path) -> Table {
    fs::read_to_string(data.join("cases/labels.toml")).expect("labels").parse().expect("TOML")
}

pub fn effects_of_another_robot_are_named(data: &Path) {
    let (mut singles, mut named, mut closed, mut wrong) = (0, 0, 0, Vec::new());
    for (case, effects) in &labels(data) {
        let effects: Vec<&str> = effects.as_array().expect("a list").iter().filter_map(|e| e.as_str()).collect();
        let diagnosis = &diagnosed(data).cases[case];
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
    assert!(named >= 24, "not named: {wrong:?}");
    assert!(closed >= 22, "only {closed} of {named} close 80 % of the reducible gap");
}

/// Cases whose effect the minimal method knows, with the parameter that is its size, and cases without any effect.
const SINGLES: [(&str, &str); 3] = [("02", "factor"), ("01", "loss"), ("06", "loss")];
const NULLS: [&str; 3] = ["11", "17", "21"];

pub fn minimal_method_agrees_with_the_full_one(data: &Path) {
    let Diagnosed { simulator, cases } = diagnosed(data);
    let baseline = Baseline::of_middle(simulator).expect("a baseline");
    let motion = baseline.motion.as_ref().expect("a model of motion");
    let minimal = |case: &str| {
        let logs = Logs::read(&data.join("cases").join(case), |_| {}).expect("logs");
        let rows = Observations::of(&Inspection::of(logs).logs, Some(motion), None);
        minimal::diagnose(&minimal::steps(&rows), motion.scatter()[0], &Calibration::shipped())
    };
    for (case, parameter) in SINGLES {
        let (full, minimal) = (&cases[case], minimal(case));
        assert_eq!((minimal.verdict, minimal.effects.len()), (full.verdict, full.effects.len()), "{case}: {minimal:?}");
        let (full, minimal) = (&full.effects[0], &minimal.effects[0]);
        assert_eq!(minimal.id, full.id, "{case}");
        let interval: [f64; 2] = serde_json::from_value(full.intervals[parameter].clone()).expect("an interval");
        assert!((interval[0]..=interval[1]).contains(&minimal.size), "{case}: {minimal:?} not in {interval:?}");
    }
    for case in NULLS {
        assert_eq!((minimal(case).verdict, cases[case].verdict), (Verdict::NoGap, Verdict::NoGap), "{case}");
    }
}

fn diagnose(workshop: &Workshop, logs: &Path) -> Diagnosis {
    workshop.done(&format!("diagnose sim.json {} --json diagnosis.json", logs.display()));
    serde_json::from_value(workshop.json("diagnosis.json")).expect("JSON as in docs/formats.md")
}

fn stands_for(found: &NamedEffect, effect: &str) -> bool {
    let rivals = &found.ambiguous_with;
    found.id == effect || (rivals.len() <= MOST_RIVALS && rivals.iter().any(|r| r == effect))
}
