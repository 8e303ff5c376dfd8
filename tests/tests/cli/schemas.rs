//! Outputs in JSON against the schemas that `mindgap schema` prints.

use jsonschema::Validator;
use mindgap_tests::command::Sandbox;
use mindgap_tests::rooms::{challenge, trained, with_scene};
use serde_json::Value;

use super::{import, import_recordings};

/// Runs a call that writes `found.json`, and compares that with the schema of an output.
#[track_caller]
fn fits(sandbox: &Sandbox, output: &str, call: &str) {
    sandbox.run(&format!("{call} --json found.json --force"));
    is_described(sandbox, output, "found.json");
}

/// Compares a file with the schema of an output. Unlike readers, it takes no fields that the schema does not know.
#[track_caller]
pub(super) fn is_described(sandbox: &Sandbox, output: &str, file: &str) {
    let mut schema: Value = serde_json::from_str(&sandbox.run(&format!("schema {output}"))).expect("JSON");
    schema["unevaluatedProperties"] = false.into();
    let found = sandbox.json(file);
    let validator = Validator::new(&schema).expect("a schema");
    let errors: Vec<String> =
        validator.iter_errors(&found).map(|error| format!("{}: {error}", error.instance_path())).collect();
    assert!(errors.is_empty(), "{output}: {}", errors.join("\n"));
}

#[test]
fn outputs_about_logs_fit_their_schemas() {
    let sandbox = Sandbox::with_logs();
    fits(&sandbox, "record", "record --out others --runs 6 --steps 25 --seed 2 --effect drive_scale=0.8");
    fits(&sandbox, "check", "check others");
    fits(&sandbox, "train", "train logs --out sim.json --hidden turn=8");
    is_described(&sandbox, "simulator", "sim.json");
    fits(&sandbox, "evaluate", "evaluate sim.json logs");
    fits(&sandbox, "diagnose", "diagnose sim.json others");
    fits(&sandbox, "diagnose", "diagnose kinematic others");
    fits(&sandbox, "crosscheck", "crosscheck sim.json logs --runs 20");
    fits(&sandbox, "adapt", "adapt sim.json others --out adapted.json");
    is_described(&sandbox, "simulator", "adapted.json");
    fits(&sandbox, "info", "info adapted.json");
}

#[test]
fn outputs_about_controllers_fit_their_schemas() {
    let sandbox = with_scene();
    fits(&sandbox, "evolve", "evolve sim.json --scene scene.toml --out controller.toml --max-steps 6 --paper");
    fits(&sandbox, "simulate", "simulate sim.json controller.toml --scene scene.toml --runs 3");
    fits(&sandbox, "drive", "drive controller.toml --scene scene.toml --out run.csv");
    for (format, input) in [("rxe", "controller.toml"), ("c", "controller.toml"), ("nxc", "sim.json")] {
        fits(&sandbox, "export", &format!("export {input} --format {format} --out drive.{format}"));
    }
    fits(&sandbox, "brick", "brick drive.rxe --readings 100,41,none");
}

#[test]
fn a_fleet_fits_its_schema() {
    let sandbox = trained();
    for robot in ["a", "b"] {
        sandbox.run(&format!("record --out fleet/{robot} --runs 6 --steps 25 --effect motor_asymmetry=0.25"));
    }
    sandbox.run("diagnose sim.json fleet --fleet found");
    is_described(&sandbox, "fleet", "found/fleet.json");
}

#[test]
fn a_score_fits_its_schema() {
    let sandbox = challenge(2);
    sandbox.run("challenge answer blind");
    fits(&sandbox, "challenge-score", "challenge score blind");
}

#[test]
fn imports_fit_their_schemas() {
    let sandbox = import::with_a_drive();
    sandbox.run(import::CALL);
    is_described(&sandbox, "import", "report.json");
    let sandbox = import_recordings::with_streams();
    sandbox.run(import_recordings::STREAMS);
    is_described(&sandbox, "import-recordings", "report.json");
}

#[test]
fn an_unknown_output_has_no_schema() {
    let sandbox = Sandbox::new();
    let refusal = sandbox.refused("schema diagnosis");
    assert!(refusal.starts_with("diagnosis is not an output in JSON"), "{refusal}");
    let names = sandbox.run("schema");
    assert!(names.starts_with("outputs: adapt, ") && names.contains(", diagnose, "), "{names}");
}
