//! Effects added to a simulator: it explains the logs, and runs like any other.

use std::sync::LazyLock;

use mindgap_core::controller::{Controller, Tuple, When};
use mindgap_host_sim::built_in_robot::{
    BuiltInRobot, default_robot, four_obstacles, record, run_controller, training_room,
};
use mindgap_host_sim::chance::generator;
use mindgap_host_sim::effects;
use mindgap_host_sim::effects::applied::AppliedEffect;
use mindgap_host_sim::evaluation::accuracy::evaluate;
use mindgap_host_sim::evaluation::final_position::endings;
use mindgap_host_sim::gap::verdict::Verdict;
use mindgap_host_sim::gap::{diagnose, findings};
use mindgap_host_sim::learn::train::{TABLE_ONE, Trainer, train};
use mindgap_host_sim::logs::{Logs, Row, Run};
use mindgap_host_sim::simulator::baseline::Baseline;
use mindgap_host_sim::simulator::course::Course;
use mindgap_host_sim::simulator::rehearsal::Rehearsal;
use mindgap_host_sim::simulator::{Noise, Simulator};

/// A simulator of the built-in robot as it is.
static SIMULATOR: LazyLock<Simulator> = LazyLock::new(|| {
    train(&logs(60, &[], 1), &Trainer::Fast, &TABLE_ONE, 1, |_| {}).expect("the logs train every network")
});

fn logs(runs: usize, effects: &[&str], seed: u64) -> Logs {
    let effects: Vec<_> = effects.iter().map(|e| e.parse().expect("an effect")).collect();
    record(&default_robot(), &training_room(), runs, 60, &effects, seed).expect("the room has room")
}

fn with(added: Vec<AppliedEffect>) -> Simulator {
    Simulator { added, ..SIMULATOR.clone() }
}

/// The form of an effect at the values that change nothing.
fn neutral(id: &str) -> AppliedEffect {
    let form = effects::all().into_iter().find(|form| form.id == id).expect("the effect is in the bank");
    AppliedEffect::new(form, &form.neutral())
}

fn rehearsed(simulator: &Simulator) -> Rehearsal {
    let turn = |left, right, threshold_cm| Tuple { left, right, when: When::Smaller, threshold_cm };
    let tuples = [(60, 55, 40), (40, -40, 20), (50, 60, 35), (-30, -30, 15), (60, 60, 30), (20, 50, 25)];
    let controller = Controller { step_ms: 400, max_steps: 60, tuples: tuples.map(|(l, r, t)| turn(l, r, t)) };
    let scene = four_obstacles();
    let course = Course::new(simulator, &scene, scene.starts[0], Noise::Learned).expect("the robot fits");
    Rehearsal::new(&course, &scene, &controller, 40, 5)
}

#[test]
fn a_simulator_with_the_effects_found_has_no_gap_on_fresh_logs() {
    let effects = ["drive_scale=1.1", "sonar_offset=5"];
    let found = findings(Baseline::learned(&SIMULATOR).expect("a reference"), &logs(16, &effects, 21)).expect("a gap");
    let applied = with(found.added);
    assert_eq!(applied.added.len(), 2, "{:?}", applied.added);
    let fresh = logs(16, &effects, 22);
    let again = diagnose(Baseline::learned(&applied).expect("a reference"), &fresh).expect("something to compare");
    assert_eq!(again.verdict, Verdict::NoGap, "{again:?}");
    let error = |simulator: &Simulator| {
        let networks = evaluate(simulator, &fresh).expect("samples").networks;
        [networks.forward.expect("poses").mse, networks.echo_value.expect("echoes").mse]
    };
    let (before, after) = (error(&SIMULATOR), error(&applied));
    assert!(after[0] < 0.5 * before[0] && after[1] < before[1], "{before:?} {after:?}");
}

#[test]
fn an_effect_that_changes_nothing_changes_no_motion() {
    let ends = |simulator: &Simulator| rehearsed(simulator).runs;
    assert_eq!(ends(&with(vec![neutral("drive_scale")])), ends(&SIMULATOR));
}

#[test]
fn an_effect_changes_runs_and_the_same_seed_repeats_them() {
    for (id, values) in [("slope", vec![1.0, 0.2]), ("sonar_offset", vec![15.0]), ("battery_sag", vec![0.6])] {
        let form = effects::all().into_iter().find(|form| form.id == id).expect("the effect is in the bank");
        let changed = with(vec![AppliedEffect::new(form, &values)]);
        assert_ne!(rehearsed(&changed), rehearsed(&SIMULATOR), "{id}");
        assert_eq!(rehearsed(&changed), rehearsed(&changed), "{id}");
    }
}

#[test]
fn what_no_effect_could_be_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("sim.json");
    let mut wrong = neutral("sonar_offset");
    wrong.values = vec![1e6];
    with(vec![wrong]).write(&path).expect("a file");
    let refusal = Simulator::read(&path).expect_err("no such offset").to_string();
    assert!(refusal.contains("sonar_offset"), "{refusal}");
    with(vec![neutral("sonar_offset")]).write(&path).expect("a file");
    assert_eq!(Simulator::read(&path).expect("a simulator").added.len(), 1);
}

#[test]
fn a_controllers_ends_are_foretold_better_with_the_effect() {
    // It drives an arc and waits for a reading that never comes: what chance adds to its end stays small.
    let tuple = Tuple { left: 60, right: 52, when: When::Smaller, threshold_cm: 1 };
    let controller = Controller { step_ms: 400, max_steps: 10, tuples: [tuple; 6] };
    let scene = four_obstacles();
    let robot = BuiltInRobot::new(&default_robot(), &scene, &["drive_scale=1.15".parse().expect("an effect")]);
    let mut rng = generator(9, &[]);
    let mut drive = |run: usize| {
        let start = scene.starts[run % scene.starts.len()];
        run_controller(&robot, &controller, start, &mut rng).to_run(format!("run-{run:03}"))
    };
    let runs = (0..8).map(&mut drive).collect();
    let logs = Logs { robot: default_robot(), scene: scene.clone(), runs };
    let form = effects::all().into_iter().find(|form| form.id == "drive_scale").expect("the effect is in the bank");
    let better = with(vec![AppliedEffect::new(form, &[1.15])]);
    let found = endings([&SIMULATOR, &better], &controller, &logs).expect("poses at both ends");
    assert_eq!(found.runs, 8);
    assert!(found.after_cm < 0.7 * found.before_cm && found.floor_cm > 0.0, "{found:?}");
    let unseen = Logs { runs: vec![Run { name: "run-000".into(), rows: vec![Row::default(); 3] }], ..logs };
    assert!(endings([&SIMULATOR, &better], &controller, &unseen).is_err());
}
