//! Effects added to a simulator: it explains the logs, and runs like any other.

use std::ops::Range;

use glam::DVec2;
use mindgap_built_in_robot::{BuiltInRobot, default_robot, four_obstacles, run_controller};
use mindgap_core::controller::{Controller, Tuple, When};
use mindgap_diagnosis::verdict::Verdict;
use mindgap_diagnosis::{Method, diagnose, findings};
use mindgap_foundations::geometry::direction;
use mindgap_foundations::random::generator;
use mindgap_learning::evaluation::accuracy::evaluate;
use mindgap_learning::evaluation::final_position::final_position_errors;
use mindgap_logs::inspection::Inspection;
use mindgap_logs::{Logs, Row, Run};
use mindgap_models::effects::applied::AppliedEffect;
use mindgap_models::effects::{CATALOGUE, Candidate};
use mindgap_models::simulator::baseline::Baseline;
use mindgap_models::simulator::environment::Environment;
use mindgap_models::simulator::rollout_report::{PathPoint, RolloutReport};
use mindgap_models::simulator::{Noise, Simulator};

use crate::{SIMULATOR, logs};

fn with(added: Vec<AppliedEffect>) -> Simulator {
    Simulator { added, ..SIMULATOR.clone() }
}

/// The first variant of an effect.
fn variant(id: &str) -> Candidate {
    Candidate::all(CATALOGUE).into_iter().find(|c| c.effect == id).expect("the effect is in the catalogue")
}

/// The same at the values that change nothing.
fn nominal(id: &str) -> AppliedEffect {
    let candidate = variant(id);
    AppliedEffect::new(&candidate, &candidate.variant.nominal(), &SIMULATOR.robot)
}

/// Forty runs round a small circle, which no reading ends.
fn circling(simulator: &Simulator) -> RolloutReport {
    let tuple = Tuple { left: 60, right: 20, when: When::Smaller, threshold_cm: 0 };
    let controller = Controller { step_ms: 400, max_steps: 20, tuples: [tuple; 6] };
    let scene = four_obstacles();
    let environment = Environment::new(simulator, &scene, scene.starts[2], Noise::Learned).expect("the robot fits");
    RolloutReport::new(&environment, &scene, &controller, 40, 5)
}

/// What two rehearsals come to at the same steps of the same runs.
fn side_by_side<'r>(
    one: &'r RolloutReport,
    other: &'r RolloutReport,
) -> impl Iterator<Item = (&'r PathPoint, &'r PathPoint)> {
    one.runs.iter().zip(&other.runs).flat_map(|(one, other)| {
        assert_eq!(one.path.len(), other.path.len());
        one.path.iter().zip(&other.path)
    })
}

fn distance_cm(one: &PathPoint, other: &PathPoint) -> f64 {
    DVec2::new(one.x_cm, one.y_cm).distance(DVec2::new(other.x_cm, other.y_cm))
}

/// Median of the second readings minus the first, where there are both.
fn reads_farther_cm(one: &RolloutReport, other: &RolloutReport) -> f64 {
    let readings = side_by_side(one, other).filter_map(|(one, other)| Some(other.echo_cm? - one.echo_cm?));
    let mut differences: Vec<f32> = readings.collect();
    assert!(differences.len() > 100, "{} readings", differences.len());
    differences.sort_by(f32::total_cmp);
    f64::from(differences[differences.len() / 2])
}

/// Mean way of a step, of steps from and to.
fn way_cm(rollouts: &RolloutReport, steps: Range<usize>) -> f64 {
    let ways = rollouts.runs.iter().flat_map(|run| run.path.windows(2).skip(steps.start).take(steps.len()));
    ways.map(|pair| distance_cm(&pair[0], &pair[1])).sum::<f64>() / (rollouts.runs.len() * steps.len()) as f64
}

#[test]
fn a_simulator_with_the_effects_found_has_no_gap_on_fresh_logs() {
    let effects = ["drive_scale=1.1", "sonar_offset=5"];
    let inspected = Inspection::new(logs(16, &effects, 21));
    let found = findings(Baseline::at_posterior_mean(&SIMULATOR).expect("a reference"), &inspected, Method::default());
    let applied = with(found.expect("a gap").applied);
    assert_eq!(applied.added.len(), 2, "{:?}", applied.added);
    let fresh = logs(16, &effects, 22);
    let again =
        diagnose(Baseline::at_posterior_mean(&applied).expect("a reference"), &fresh).expect("something to compare");
    assert_eq!(again.verdict, Verdict::NoGap, "{again:?}");
    let error = |simulator: &Simulator| {
        let networks = evaluate(simulator, &fresh, |_, _| ()).expect("samples").networks;
        [networks.forward.expect("poses").mse, networks.echo_value.expect("echoes").mse]
    };
    let (before, after) = (error(&SIMULATOR), error(&applied));
    assert!(after[0] < 0.5 * before[0] && after[1] < before[1], "{before:?} {after:?}");
}

#[test]
fn an_effect_that_changes_nothing_changes_no_motion_and_no_reading() {
    let before = circling(&SIMULATOR);
    for candidate in Candidate::all(CATALOGUE) {
        let name = format!("{}: {}", candidate.effect, candidate.variant.id);
        let after =
            circling(&with(vec![AppliedEffect::new(&candidate, &candidate.variant.nominal(), &SIMULATOR.robot)]));
        let farthest_cm = side_by_side(&before, &after).map(|(a, b)| distance_cm(a, b)).fold(0.0, f64::max);
        assert!(farthest_cm < 1e-6, "{name}: {farthest_cm} cm");
        let farther_cm = reads_farther_cm(&before, &after);
        assert!(farther_cm.abs() < 0.5, "{name}: reads {farther_cm} cm farther");
    }
}

#[test]
fn an_effect_changes_runs_as_it_says_and_the_same_seed_repeats_them() {
    let before = circling(&SIMULATOR);
    let after = |id: &str, values: &[f64]| {
        let changed = with(vec![AppliedEffect::new(&variant(id), values, &SIMULATOR.robot)]);
        let after = circling(&changed);
        assert_eq!(after, circling(&changed), "{id}");
        after
    };
    let down_deg: f64 = 57.0;
    let slope = after("slope", &[down_deg, 0.2]);
    let drift_cm: DVec2 = before
        .runs
        .iter()
        .zip(&slope.runs)
        .map(|(flat, sloping)| DVec2::new(sloping.end_x_cm - flat.end_x_cm, sloping.end_y_cm - flat.end_y_cm))
        .sum::<DVec2>()
        / before.runs.len() as f64;
    assert!(drift_cm.length() > 1.0 && drift_cm.normalize().dot(direction(down_deg.to_radians())) > 0.95, "{drift_cm}");

    let offset = after("sonar_offset", &[15.0]);
    assert!(side_by_side(&before, &offset).all(|(a, b)| distance_cm(a, b) == 0.0), "the sensor moves nothing");
    let farther_cm = reads_farther_cm(&before, &offset);
    assert!((farther_cm - 15.0).abs() < 0.5, "{farther_cm}");

    // A step is 400 ms: at its middle the second has lost 0.6 % and the nineteenth 7.4 %.
    let sag = after("battery_sag", &[0.6]);
    let left = |steps: Range<usize>| way_cm(&sag, steps.clone()) / way_cm(&before, steps);
    let (early, late) = (left(1..2), left(18..19));
    assert!((0.98..1.0).contains(&early) && (0.90..0.95).contains(&late), "{early} {late}");
}

#[test]
fn what_no_effect_could_be_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("sim.json");
    let wrong = AppliedEffect::new(&variant("sonar_offset"), &[1e6], &SIMULATOR.robot);
    with(vec![wrong]).write(&path).expect("a file");
    let refusal = Simulator::read(&path).expect_err("no such offset").to_string();
    assert!(refusal.contains("sonar_offset"), "{refusal}");
    with(vec![nominal("sonar_offset")]).write(&path).expect("a file");
    assert_eq!(Simulator::read(&path).expect("a simulator").added.len(), 1);
}

#[test]
fn final_positions_are_predicted_better_with_the_effect() {
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
    let better = with(vec![AppliedEffect::new(&variant("drive_scale"), &[1.15], &SIMULATOR.robot)]);
    let found = final_position_errors([&SIMULATOR, &better], &controller, &logs, 1).expect("poses at both ends");
    assert_eq!(found.runs, 8);
    assert!(found.after_cm < 0.7 * found.before_cm && found.floor_cm > 0.0, "{found:?}");
    let unseen =
        Logs { runs: vec![Run { name: "run-000".into(), rows: [Row::default(); 3].into_iter().collect() }], ..logs };
    assert!(final_position_errors([&SIMULATOR, &better], &controller, &unseen, 1).is_err());
}
