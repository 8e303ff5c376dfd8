//! The diagnosis of labelled logs that another program wrote, of a robot with different physics.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::sync::OnceLock;

use mindgap_diagnosis::calibration::Calibration;
use mindgap_diagnosis::minimal;
use mindgap_diagnosis::verdict::Verdict;
use mindgap_learning::evaluation::observations::Observations;
use mindgap_logs::Logs;
use mindgap_logs::inspection::Inspection;
use mindgap_models::simulator::Simulator;
use mindgap_models::simulator::baseline::Baseline;
use mindgap_tests::command::Sandbox;
use mindgap_tests::form::{is_long, short_or_long};
use serde::Deserialize;
use serde_json::{Map, Value};
use toml::Table;

/// The part of a diagnosis that is tested, as in docs/reference/json.md.
#[derive(Deserialize)]
struct Diagnosis {
    verdict: Verdict,
    effects: Vec<NamedEffect>,
    shrink: Reduction,
}

#[derive(Debug, Deserialize)]
struct NamedEffect {
    id: String,
    ambiguous_with: Vec<String>,
    intervals: Map<String, Value>,
}

#[derive(Deserialize)]
struct Reduction {
    reducible_closed: Option<f64>,
}

/// A rival counts as named if its effect has at most this many.
const MOST_RIVALS: usize = 3;

/// Cases of the short form: a single effect, none, and two.
const SHORT: [&str; 3] = ["02", "11", "18"];

/// A simulator of the robot, and the diagnosis of each case of the form.
struct Diagnosed {
    simulator: Simulator,
    cases: BTreeMap<String, Diagnosis>,
}

/// Diagnoses the cases once for all tests.
fn diagnosed(data: &Path) -> &'static Diagnosed {
    static DIAGNOSED: OnceLock<Diagnosed> = OnceLock::new();
    DIAGNOSED.get_or_init(|| {
        let sandbox = Sandbox::new();
        sandbox.run(&format!("train {} --out sim.json", data.join("nominal").display()));
        let simulator = Simulator::read(&sandbox.path().join("sim.json")).expect("a simulator");
        let labels = labels(data);
        let cases = labels.keys().filter(|case| is_long() || SHORT.contains(&case.as_str()));
        let diagnosis = |case: &String| (case.clone(), diagnose(&sandbox, &data.join("cases").join(case)));
        Diagnosed { simulator, cases: cases.map(diagnosis).collect() }
    })
}

fn labels(data: &Path) -> Table {
    fs::read_to_string(data.join("cases/labels.toml")).expect("labels").parse().expect("TOML")
}

pub fn effects_of_another_robot_are_named(data: &Path) {
    let labels = labels(data);
    let (mut singles, mut named, mut closed, mut wrong) = (0, 0, 0, Vec::new());
    for (case, diagnosis) in &diagnosed(data).cases {
        let effects: Vec<&str> = labels[case].as_array().expect("a list").iter().filter_map(|e| e.as_str()).collect();
        let is_named = |effect: &&str| diagnosis.effects.iter().any(|found| stands_for(found, effect));
        match effects.as_slice() {
            [] => assert!(
                diagnosis.effects.is_empty() && diagnosis.shrink.reducible_closed.is_none(),
                "{case}: false alarm"
            ),
            [effect] => {
                singles += 1;
                if diagnosis.effects.first().is_some_and(|first| stands_for(first, effect)) {
                    named += 1;
                    let share = diagnosis.shrink.reducible_closed.unwrap_or(0.0);
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

/// Cases whose effect the minimal method knows, with the parameter that is its size, and cases without any effect.
const SINGLES: [(&str, &str); 3] = [("02", "factor"), ("01", "loss"), ("06", "loss")];
const NULLS: [&str; 3] = ["11", "17", "21"];

pub fn minimal_method_agrees_with_the_full_one(data: &Path) {
    let Diagnosed { simulator, cases } = diagnosed(data);
    let baseline = Baseline::at_posterior_mean(simulator).expect("a baseline");
    let motion = baseline.motion.as_ref().expect("a model of motion");
    let minimal = |case: &str| {
        let logs = Logs::read(&data.join("cases").join(case), |_| {}).expect("logs");
        let rows = Observations::of(&Inspection::new(logs).logs, Some(motion), None);
        minimal::diagnose(&minimal::steps(&rows), motion.scatter().forward, &Calibration::shipped())
    };
    for (case, parameter) in SINGLES.into_iter().filter(|(case, _)| cases.contains_key(*case)) {
        let (full, minimal) = (&cases[case], minimal(case));
        assert_eq!((minimal.verdict, minimal.effects.len()), (full.verdict, full.effects.len()), "{case}: {minimal:?}");
        let (full, minimal) = (&full.effects[0], &minimal.effects[0]);
        assert_eq!(minimal.id, full.id, "{case}");
        let interval: [f64; 2] = serde_json::from_value(full.intervals[parameter].clone()).expect("an interval");
        assert!((interval[0]..=interval[1]).contains(&minimal.size), "{case}: {minimal:?} not in {interval:?}");
    }
    for case in NULLS.into_iter().filter(|case| cases.contains_key(*case)) {
        assert_eq!((minimal(case).verdict, cases[case].verdict), (Verdict::NoGap, Verdict::NoGap), "{case}");
    }
}

fn diagnose(sandbox: &Sandbox, logs: &Path) -> Diagnosis {
    sandbox.run(&format!("diagnose sim.json {} --json diagnosis.json", logs.display()));
    serde_json::from_value(sandbox.json("diagnosis.json")).expect("JSON as in docs/reference/json.md")
}

fn stands_for(found: &NamedEffect, effect: &str) -> bool {
    let rivals = &found.ambiguous_with;
    found.id == effect || (rivals.len() <= MOST_RIVALS && rivals.iter().any(|r| r == effect))
}

/// A lag of 80 ms, and a right motor that gives 0.9615 of its speed. A textbook states no load, so nothing can be one.
pub fn a_lagging_robot_with_a_weak_motor_carries_no_load(logs: &Path) {
    let sandbox = Sandbox::new();
    sandbox.run(&format!("diagnose kinematic {} --json found.json", logs.display()));
    let found = sandbox.json("found.json");
    let effect = |id: &str| found["effects"].as_array()?.iter().find(|effect| effect["id"] == id);
    let motor = effect("motor_asymmetry").unwrap_or_else(|| panic!("{found}"));
    assert_eq!(motor["parameters"]["side"], "right", "{found}");
    assert!((motor["parameters"]["factor"].as_f64().expect("a factor") - 0.9615).abs() < 0.005, "{found}");
    assert!(effect("inertia").or(effect("latency")).is_some() && effect("payload").is_none(), "{found}");
}
