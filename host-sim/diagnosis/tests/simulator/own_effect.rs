//! The example of docs/how-to/own-effects.md, as it stands there.

use std::fs;
use std::path::Path;

use mindgap_diagnosis::{Method, findings};
use mindgap_learning::evaluation::accuracy::evaluate;
use mindgap_logs::inspection::Inspection;
use mindgap_models::effects::own;
use mindgap_models::effects::{CATALOGUE, Effect};
use mindgap_models::simulator::Simulator;
use mindgap_models::simulator::baseline::Baseline;

use crate::added_effect::{LOSS_PER_RAD_S, with_turning_loss};
use crate::{SIMULATOR, logs};

/// The effects of the page's first block of TOML.
fn example() -> Vec<&'static Effect> {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/how-to/own-effects.md");
    let page = fs::read_to_string(page).expect("the page");
    let (_, begin) = page.split_once("```toml\n").expect("a block of TOML");
    let (toml, _) = begin.split_once("```").expect("its end");
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("caster.toml");
    fs::write(&path, toml).expect("a file");
    own::read(&path).expect("effects")
}

#[test]
fn the_example_is_named_with_its_strength_and_applied() {
    let logs = with_turning_loss(logs(16, &[], 91));
    let catalogue: &'static [&'static Effect] = [CATALOGUE, &example()].concat().leak();
    let method = Method { catalogue, ..Method::default() };
    let found =
        findings(Baseline::at_posterior_mean(&SIMULATOR).expect("a reference"), &Inspection::new(logs.clone()), method)
            .expect("poses");
    let written = serde_json::to_value(&found.diagnosis).expect("JSON");
    assert_eq!(written["verdict"], "known", "{written}");
    assert_eq!(written["effects"][0]["id"], "caster_drag", "{written}");
    let loss = written["effects"][0]["parameters"]["loss_per_rad_s"].as_f64().expect("a number");
    assert!((loss - LOSS_PER_RAD_S).abs() < 0.1 * LOSS_PER_RAD_S, "{written}");
    assert!(written["shrink"]["reducible_closed"].as_f64().expect("a gap that shrinks") > 0.8, "{written}");

    // The simulator file holds all that is needed.
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("better.json");
    Simulator { added: found.applied, ..SIMULATOR.clone() }.write(&path).expect("a file");
    assert!(fs::read_to_string(&path).expect("a file").contains("abs(turn_rad) / step_s"));
    let better = Simulator::read(&path).expect("a simulator");
    let error = |simulator: &Simulator| {
        evaluate(simulator, &logs, |_, _| ()).expect("samples").networks.forward.expect("poses").mse
    };
    let (before, after) = (error(&SIMULATOR), error(&better));
    assert!(after < 0.7 * before, "{before} {after}");
}

/// The same loss, and nobody has thought of it: the formula closes what has no name.
#[test]
fn without_the_example_a_formula_tells_of_the_turns() {
    let logs = with_turning_loss(logs(16, &[], 91));
    let found = findings(
        Baseline::at_posterior_mean(&SIMULATOR).expect("a reference"),
        &Inspection::new(logs.clone()),
        Method { catalogue: &[], ..Method::default() },
    );
    let found = found.expect("poses");
    let formula = found.diagnosis.formula.clone().expect("a formula");
    assert_eq!(formula.channel.name(), "forward", "{formula:?}");
    assert!(formula.text.contains("turn_rad") && formula.share > 0.5, "{formula:?}");
    let better = Simulator { added: found.with_formula(), ..SIMULATOR.clone() };
    let error = |simulator: &Simulator| {
        evaluate(simulator, &logs, |_, _| ()).expect("samples").networks.forward.expect("poses").mse
    };
    let (before, after) = (error(&SIMULATOR), error(&better));
    assert!(after < 0.7 * before, "{formula:?} {before} {after}");
}

#[test]
fn logs_without_a_gap_have_no_formula() {
    let found = findings(
        Baseline::at_posterior_mean(&SIMULATOR).expect("a reference"),
        &Inspection::new(logs(16, &[], 93)),
        Method::default(),
    );
    assert_eq!(found.expect("poses").diagnosis.formula, None);
}
