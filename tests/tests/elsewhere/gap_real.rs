//! The diagnosis of real robots against the kinematic model.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use mindgap_diagnosis::{Method, findings};
use mindgap_foundations::geometry::Pose;
use mindgap_foundations::motion::Motion;
use mindgap_logs::inspection::Inspection;
use mindgap_logs::{Logs, Robot, Row, Run, Scene, Ultrasonic};
use mindgap_models::effects::chain::EffectChain;
use mindgap_models::effects::context::{RunHistory, Surroundings};
use mindgap_models::effects::{CATALOGUE, Effect};
use mindgap_models::simulator::kinematic;
use mindgap_tests::command::Sandbox;
use mindgap_tests::form::short_or_long;
use serde::Deserialize;
use serde_json::Value;

/// Duration of the rows made for the Neato, ms.
const STEP_MS: f64 = 400.0;
/// The Neato's speed at command 100, cm/s.
const FULL_CM_S: f64 = 30.0;
/// Nominal distance between the Neato's wheels, cm.
const TRACK_CM: f64 = 23.5;

/// Wheel speeds at a time of a run.
#[derive(Deserialize)]
struct Commanded {
    run: usize,
    t_s: f64,
    vl_m_s: f64,
    vr_m_s: f64,
}

/// Poses at both ends of a run.
#[derive(Deserialize)]
struct Ends {
    run: usize,
    x0_m: f64,
    y0_m: f64,
    th0_rad: f64,
    x1_m: f64,
    y1_m: f64,
    th1_rad: f64,
}

fn table<T: for<'a> Deserialize<'a>>(path: &Path) -> Vec<T> {
    let mut reader = csv::Reader::from_path(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    reader.deserialize().map(|row| row.unwrap_or_else(|e| panic!("{}: {e}", path.display()))).collect()
}

/// Returns the runs of a Neato, with a pose only at both ends.
fn neato(folder: &Path) -> Logs {
    let mut commands: BTreeMap<usize, Vec<Commanded>> = BTreeMap::new();
    table(&folder.join("commanded.csv"))
        .into_iter()
        .for_each(|c: Commanded| commands.entry(c.run).or_default().push(c));
    let ends: Vec<Ends> = table(&folder.join("poses.csv"));
    let runs = ends.iter().map(|ends| Run {
        name: format!("run-{:03}", ends.run),
        rows: rows(ends, &commands[&ends.run]).into_iter().collect(),
    });
    let ultrasonic = Ultrasonic { x_cm: 0.0, y_cm: 0.0, yaw_deg: 0.0, min_cm: 4.0, max_cm: 240.0 };
    let robot = Robot {
        wheel_diameter_cm: 7.6,
        track_cm: TRACK_CM,
        body_radius_cm: 17.0,
        step_ms: STEP_MS,
        full_speed_cm_s: FULL_CM_S,
        ultrasonic: Some(ultrasonic),
    };
    let scene = Scene { arena_cm: Some(glam::DVec2::splat(400.0)), ..Scene::default() };
    Logs { robot, scene, runs: runs.collect() }
}

/// Returns rows with the mean command over each step.
fn rows(ends: &Ends, commanded: &[Commanded]) -> Vec<Row> {
    let steps = (commanded[commanded.len() - 1].t_s * 1000.0 / STEP_MS).ceil() as usize;
    let way = |wheel: fn(&Commanded) -> f64, until_s: f64| {
        let held = commanded.windows(2).map(|pair| (pair[1].t_s.min(until_s) - pair[0].t_s).max(0.0) * wheel(&pair[0]));
        held.sum::<f64>()
    };
    let command = |wheel: fn(&Commanded) -> f64, step: usize| {
        let [from_s, to_s] = [step, step + 1].map(|i| i as f64 * STEP_MS / 1000.0);
        let speed_cm_s = 100.0 * (way(wheel, to_s) - way(wheel, from_s)) / (to_s - from_s);
        100.0 * speed_cm_s / FULL_CM_S
    };
    let pose = |x_m: f64, y_m: f64, rad: f64| Some(Pose::new(100.0 * x_m + 100.0, 100.0 * y_m + 100.0, rad));
    let row = |step: usize| Row {
        t_ms: step as f64 * STEP_MS,
        left: command(|c| c.vl_m_s, step),
        right: command(|c| c.vr_m_s, step),
        pose: match step {
            0 => pose(ends.x0_m, ends.y0_m, ends.th0_rad),
            _ if step == steps => pose(ends.x1_m, ends.y1_m, ends.th1_rad),
            _ => None,
        },
        ..Row::default()
    };
    (0..=steps).map(row).collect()
}

fn diagnosed(sandbox: &Sandbox, logs: &str) -> Value {
    println!("{}", sandbox.run(&format!("diagnose kinematic {logs} --json diagnosis.json")));
    sandbox.json("diagnosis.json")
}

pub fn the_end_poses_of_a_neato_show_its_gap_to_the_kinematic_model(folder: &Path) {
    let sandbox = Sandbox::new();
    neato(folder).write(&sandbox.path().join("logs")).expect("a folder that can be written");
    let diagnosis = diagnosed(&sandbox, "logs");
    assert_ne!(diagnosis["verdict"], "no_gap", "its owner measured one");
    assert!(diagnosis["notes"].to_string().contains("whole segments between poses"), "{diagnosis}");
    let shrink = &diagnosis["shrink"];
    let number = |value: &Value| value.as_f64().expect("a number");
    assert!(number(&shrink["before"]) > 1.0 && number(&shrink["reducible_closed"]) > 0.8, "{shrink}");
    // The robot has no sonar, so the gap is in forward motion and turns.
    let channels = shrink["channels"].as_array().expect("a list").iter();
    let of_wheels: f64 = channels
        .filter(|part| part["channel"] == "forward" || part["channel"] == "turn")
        .map(|part| number(&part["before"]))
        .sum();
    assert!(of_wheels > 0.7 * number(&shrink["before"]), "{shrink}");
    let effects = diagnosis["effects"].as_array().expect("a list");
    let of_sonar = |effect: &Value| effect["id"].as_str().is_some_and(|id| id.starts_with("sonar"));
    assert!(!effects.is_empty() && !effects.iter().any(of_sonar), "{effects:?}");
}

pub fn a_real_sonar_at_rest_is_compared_with_the_kinematic_model(folder: &Path) {
    let entries = fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path());
    let mut teams: Vec<PathBuf> = entries.filter(|path| path.is_dir()).collect();
    teams.sort();
    assert!(teams.len() >= 5, "{teams:?}");
    // The first team has the fewest readings.
    teams.truncate(short_or_long(1, usize::MAX));
    let (mut with_gap, mut wide) = (0, 0);
    for team in &teams {
        let diagnosis = diagnosed(&Sandbox::new(), &team.display().to_string());
        let notes = diagnosis["notes"].to_string();
        assert!(notes.contains("motion is not excited"), "{}: {notes}", team.display());
        // No command turns the sensor, so motion is never said to agree. Any gap is in the readings.
        let places = diagnosis["where"].as_array().expect("a list");
        assert!(
            places.iter().all(|place| place["channel"] == "echo_value" || place["channel"] == "echo_rate"),
            "{}: {places:?}",
            team.display()
        );
        assert_ne!(diagnosis["verdict"], "no_gap", "{}: {places:?}", team.display());
        with_gap += usize::from(!places.is_empty());
        let effects = diagnosis["effects"].as_array().expect("a list");
        wide += usize::from(effects.iter().any(|effect| effect["id"] == "sonar_beam"));
    }
    // No real sonar is the ideal ray of the kinematic model, and five scans show it for most teams.
    assert!(2 * with_gap > teams.len(), "{with_gap} of {} teams", teams.len());
    // An independent analysis found beams of 7 to 11 degrees for all of them.
    assert!(wide + 1 >= teams.len(), "{wide} of {} teams", teams.len());
}

/// The robot's owner measured a loss of 6.9 cm of forward travel per radian of turn. With latency as the only known effect,
/// the formula for the residual finds it.
pub fn the_loss_in_turns_of_a_real_robot_is_found_as_a_formula(folder: &Path) {
    let logs = Logs::read(folder, |_| ()).expect("logs");
    let latency: Vec<&'static Effect> = CATALOGUE.iter().copied().filter(|effect| effect.id == "latency").collect();
    let method = Method { catalogue: latency.leak(), ..Method::default() };
    let found = findings(kinematic::baseline(&logs), &Inspection::new(logs.clone()), method).expect("poses");
    let formula = found.diagnosis.formula.clone().expect("a formula");
    let applied = found.with_formula();
    println!("{formula:?} {applied:?}");
    assert_eq!(formula.channel.name(), "forward", "{formula:?}");
    assert!(formula.text.contains("abs(turn_rad)"), "{formula:?}");
    let [effects @ .., formula] = applied.as_slice() else { panic!("something is applied") };
    assert!(effects.iter().all(|effect| effect.effect == "latency"), "{effects:?}");
    // What is lost in a step of 400 ms at 9 cm/s that turns by 0.16 rad.
    let (candidate, values) = formula.resolve(&logs.robot).expect("an effect");
    let robot = Surroundings::new(&logs.robot, &logs.scene);
    let step = robot.context(&RunHistory::default(), 30_000.0, Pose::new(500.0, 500.0, 0.0));
    let predicted = Motion { forward: 3.5, lateral: 0.0, turn: 0.16 };
    let after = EffectChain::default().with(&[candidate.variant], &values).wrap(&step, |_, _| predicted);
    let loss_cm_per_rad = (predicted.forward - after.forward) / 0.16;
    assert!((5.5..9.0).contains(&loss_cm_per_rad), "{loss_cm_per_rad} cm a radian");
}
