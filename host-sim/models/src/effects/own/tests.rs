use std::fs;

use super::*;
use crate::effects::applied::AppliedEffect;
use crate::effects::catalogue::Candidate;
use crate::effects::chain::EffectChain;
use crate::effects::context::{HISTORY, RunHistory, Surroundings};
use mindgap_foundations::geometry::Pose;
use mindgap_logs::Scene;

/// A caster that holds a robot back as it turns, and a sensor that reads short at oblique incidence.
const FILE: &str = r#"
[[effect]]
id = "caster"
description = "A caster drags in turns."
change.forward_cm = "forward_cm - cm_per_rad * abs(turn_rad)"

[[effect.parameter]]
name = "cm_per_rad"
unit = "cm/rad"
nominal = 0.0
bounds = [0.0, 20.0]

[[effect]]
id = "tired"
description = "Commands, readings and echoes change."

[effect.change]
left = "left * (1 - k * elapsed_min)"
echo_cm = "(1 + k) * echo_cm + 10 * k * abs(incidence_rad)"
echo_loss = "k * distance_cm / 100"

[[effect.parameter]]
name = "k"
nominal = 0.0
bounds = [-1.0, 1.0]
prior_sd = 0.1
guesses = [0.2]
"#;

fn read_text(text: &str) -> Result<Vec<&'static Effect>> {
    let file = tempfile::NamedTempFile::new().expect("a file");
    fs::write(file.path(), text).expect("a file");
    read(file.path())
}

fn own(place: usize) -> Candidate {
    let effect = read_text(FILE).expect("a file of effects")[place];
    Candidate { effect: effect.id, variant: &effect.variants[0] }
}

/// Half a minute into a run, 100 cm from the wall that it faces at 0.5 rad.
fn step() -> StepContext {
    let scene = Scene { arena_cm: Some(glam::DVec2::new(300.0, 220.0)), ..Scene::default() };
    let surroundings = Surroundings::new(&mindgap_built_in_robot::default_robot(), &scene);
    let context = surroundings.context(&RunHistory::default(), 30_000.0, Pose::new(100.0, 50.0, 0.5));
    StepContext { commands: [[60.0, 40.0]; HISTORY], faced: Some([100.0, -0.5]), ..context }
}

const AS_PREDICTED: Motion<f64> = Motion { forward: 7.0, lateral: -0.4, turn: -0.5 };

fn increment(candidate: &Candidate, values: &[f64]) -> Motion<f64> {
    EffectChain::default().with(&[candidate.variant], values).wrap(&step(), |_, _| AS_PREDICTED)
}

#[test]
fn motion_changes_as_its_expression_says() {
    let caster = own(0);
    assert_eq!(increment(&caster, &[6.0]), Motion { forward: 4.0, ..AS_PREDICTED });
    assert_eq!(increment(&caster, &[0.0]), AS_PREDICTED);
    assert!(caster.variant.moves() && !caster.variant.senses());
}

#[test]
fn commands_readings_and_echoes_change_as_their_expressions_say() {
    let tired = own(1);
    assert!(tired.variant.moves() && tired.variant.senses());
    let effects = EffectChain::default().with(&[tired.variant], &[0.2]);
    effects.wrap(&step(), |now, before| {
        assert_eq!([now, before], [[54.0, 40.0]; 2]);
        AS_PREDICTED
    });
    let change = effects.sensor(&step()).perturbation;
    let near = |a: f64, b: f64| (a - b).abs() < 1e-9;
    assert!(near(change.gain, 1.2) && near(change.offset_cm, 1.0) && near(change.attenuation, 0.2), "{change:?}");
}

/// The second effect acts on what the first has left: a factor also stretches a length that was added before.
#[test]
fn readings_change_one_after_the_other() {
    let tired = own(1).variant;
    let change = EffectChain::default().with(&[tired, tired], &[0.2, 0.2]).sensor(&step()).perturbation;
    assert!((change.gain - 1.44).abs() < 1e-9 && (change.offset_cm - 2.2).abs() < 1e-9, "{change:?}");
}

#[test]
fn parameters_are_those_of_the_file() {
    let [length] = own(0).variant.parameters else { panic!("one parameter") };
    assert_eq!((length.name, length.unit, length.nominal, length.bounds), ("cm_per_rad", "cm/rad", 0.0, [0.0, 20.0]));
    assert!(length.prior_sd.is_infinite());
    assert_eq!(own(0).variant.initial_guesses(30.0), [[2.0]], "a tenth of the way to the bound that is not nominal");
    assert_eq!(own(1).variant.parameters[0].prior_sd, 0.1);
    assert_eq!(own(1).variant.initial_guesses(30.0), [[0.2]]);
}

#[test]
fn a_definition_is_kept_once_and_written_as_it_is_read() {
    let (one, again) = (own(0), own(0));
    assert!(std::ptr::eq(one.variant, again.variant));
    let definition = definition_of(one.variant).expect("an own effect");
    let read = read_text(&to_text(&definition)).expect("what was written");
    assert!(std::ptr::eq(&read[0].variants[0], one.variant));
    assert!(Candidate::all(crate::effects::CATALOGUE).iter().all(|c| definition_of(c.variant).is_none()));
}

#[test]
fn a_simulator_file_holds_the_definition() {
    let robot = mindgap_built_in_robot::default_robot();
    let applied = AppliedEffect::new(&own(0), &[6.0], &robot);
    let text = serde_json::to_string(&applied).expect("JSON");
    assert!(text.contains("abs(turn_rad)"), "{text}");
    let read: AppliedEffect = serde_json::from_str(&text).expect("what was written");
    let (candidate, values) = read.resolve(&robot).expect("an effect");
    assert!(std::ptr::eq(candidate.variant, own(0).variant) && values == [6.0]);
    assert!(AppliedEffect { effect: "another".into(), ..read }.resolve(&robot).is_err());
    let too_much = AppliedEffect::new(&own(0), &[60.0], &robot).resolve(&robot).err().expect("a refusal");
    assert!(too_much.contains("these parameters and values"), "{too_much}");
}

/// Where an expression has no value nothing changes, be it for a division by zero or for a number beyond all sense.
#[test]
fn what_is_impossible_changes_nothing() {
    let steep = FILE.replace("cm_per_rad * abs(turn_rad)", "exp(cm_per_rad * 1000) * cm_per_rad / 2");
    let effect = read_text(&steep).expect("no change at the nominal value")[0];
    let candidate = Candidate { effect: effect.id, variant: &effect.variants[0] };
    for values in [[0.02], [20.0]] {
        assert_eq!(increment(&candidate, &values), AS_PREDICTED);
    }
}

/// What is wrong with the file once `from` in it is `to`, and where.
fn refusal(from: &str, to: &str) -> String {
    assert!(FILE.contains(from), "{from}");
    let message = read_text(&FILE.replacen(from, to, 1)).err().unwrap_or_else(|| panic!("{to}")).to_string();
    assert!(!message.contains('\n'), "{message}");
    message
}

#[test]
fn errors_are_reported_with_their_place() {
    let assert_refused = |from: &str, to: &str, place: &str, what: &str| {
        let message = refusal(from, to);
        assert!(message.contains(place) && message.contains(what), "{message}");
    };
    let first = ":2: effect caster: ";
    let key = ":2: effect caster: change.forward_cm: ";
    let parameter = ":2: effect caster: parameter cm_per_rad: ";
    assert_refused("description", "describes", ":4: ", "unknown key `describes`");
    assert_refused("bounds = [0.0, 20.0]", "bounds = [0.0, 20.0", ":", "");
    assert_refused("abs(turn_rad)", "abs(turn)", key, "turn is not known here; known are left, right, ");
    assert_refused("abs(turn_rad)", "magnitude(turn_rad)", key, "magnitude() is not a known function");
    assert_refused("abs(turn_rad)", "abs(turn_rad", key, "unclosed parenthesis");
    assert_refused("abs(turn_rad)", "echo_cm", key, "echo_cm is not known here");
    assert_refused("bounds = [0.0, 20.0]", "bounds = [20.0, 0.0]", parameter, "bounds [20, 0]");
    assert_refused("bounds = [0.0, 20.0]", "bounds = [0.0, inf]", parameter, "bounds [0, inf]");
    assert_refused("nominal = 0.0", "nominal = -1.0", parameter, "nominal -1 lies outside the bounds 0 to 20");
    assert_refused("nominal = 0.0", "nominal = nan", parameter, "nominal NaN");
    assert_refused(
        "nominal = 0.0",
        "nominal = 1.0",
        first,
        "change.forward_cm changes something at the nominal parameters",
    );
    assert_refused("bounds = [0.0, 20.0]", "bounds = [0.0, 20.0]\nguesses = [30.0]", parameter, "guess 30");
    assert_refused("bounds = [0.0, 20.0]", "bounds = [0.0, 20.0]\nprior_sd = 0.0", parameter, "prior_sd");
    assert_refused(
        "name = \"cm_per_rad\"",
        "name = \"x_cm\"",
        ":2: effect caster: parameter x_cm: ",
        "name of a variable",
    );
    assert_refused("cm_per_rad * abs(turn_rad)", "0", first, "parameter cm_per_rad is in no expression");
    assert_refused(
        "forward_cm - cm_per_rad",
        "forward_cm / abs(turn_rad) - cm_per_rad",
        key.trim_end_matches(": "),
        "is not a number at the nominal",
    );
    assert_refused("id = \"caster\"", "id = \"latency\"", ":2: effect latency: ", "built-in effect");
    assert_refused("id = \"caster\"", "id = \"A caster\"", ":2: ", "small letters");
    assert_refused("id = \"tired\"", "id = \"caster\"", ":13: effect caster: ", "is there twice");
    assert_refused(
        "(1 + k) * echo_cm",
        "(1 + k * echo_cm) * echo_cm",
        ":13: effect tired: ",
        "has to be a factor times echo_cm",
    );
}
