//! `mindgap compare`, `--patch` and `--verify`.

use std::fs;

use mindgap_foundations::geometry::Pose;
use mindgap_logs::Run;
use mindgap_tests::command::{Outcome, Sandbox};
use mindgap_tests::range_sensors::add;
use mindgap_tests::ros_bags::messages;
use serde_json::Value;

use super::schemas::is_described;

const COMPARE: &str = "compare logs --real real --patch logs/robot.toml=patched.toml --json found.json --force";

/// Makes logs of a simulator in `logs`, and in `real` those of a robot that turns less by a fifth.
fn both_sides() -> Sandbox {
    let sandbox = Sandbox::new();
    sandbox.run("record --out logs --runs 12 --steps 40");
    sandbox.run("record --out real --runs 12 --steps 40 --seed 2 --effect track_width=0.8");
    sandbox
}

/// Returns a robot's track as patched, and the patches that say so.
#[track_caller]
fn patched(sandbox: &Sandbox) -> (f64, Vec<Value>) {
    let robot: toml::Table = sandbox.text("patched.toml").parse().expect("TOML");
    let patches = sandbox.json("found.json")["patches"].as_array().expect("a list").clone();
    (robot["track_cm"].as_float().expect("a number"), patches)
}

#[cfg(unix)]
fn verified(sandbox: &Sandbox, script: &str) -> Outcome {
    sandbox.write("drive.sh", script);
    let mut command = sandbox.command(COMPARE);
    sandbox.execute({
        command.args(["--verify", "sh drive.sh"]);
        command
    })
}

#[test]
fn causes_are_written_into_a_copy_of_the_model() {
    let sandbox = both_sides();
    let old = sandbox.text("logs/robot.toml");
    let outcome = sandbox.call(&format!("{COMPARE} --exit-code"));
    assert_eq!(outcome.code, 3, "there is a gap: {}", outcome.err);
    is_described(&sandbox, "compare", "found.json");
    let (track_cm, patches) = patched(&sandbox);
    assert!((track_cm - 11.5 / 0.8).abs() < 0.7, "{track_cm}");
    let [patch] = patches.as_slice() else { panic!("{patches:?}") };
    assert_eq!(
        (&patch["tag"], &patch["old"], &patch["effect"]),
        (&"track_cm".into(), &"11.5".into(), &"track_width".into())
    );
    let ends: Vec<f64> = patch["ci95"].as_array().expect("an interval").iter().filter_map(Value::as_f64).collect();
    assert!(ends[0] < track_cm && track_cm < ends[1], "{ends:?}");
    assert_eq!(
        sandbox.text("patched.toml").replace(patch["new"].as_str().expect("text"), "11.5"),
        old,
        "all other bytes"
    );
    assert_eq!(sandbox.text("logs/robot.toml"), old, "the model stays");

    sandbox.run("train logs --out sim.json");
    sandbox.run("diagnose sim.json real --patch logs/robot.toml=diagnosed.toml --json diagnosed.json");
    is_described(&sandbox, "diagnose", "diagnosed.json");
    assert_eq!(sandbox.text("diagnosed.toml"), sandbox.text("patched.toml"), "diagnose patches alike");
}

#[cfg(unix)]
#[test]
fn a_patch_is_proved_by_held_out_runs_or_withdrawn() {
    let sandbox = both_sides();
    let call = "echo \"$1 $2 $3\" >> calls\nhead -n 1 \"$2\" >> calls\n";
    let exact = verified(&sandbox, &format!("{call}cp real/$(basename \"$3\") \"$3\"\n"));
    assert_eq!(exact.code, 0, "{}", exact.err);
    is_described(&sandbox, "compare", "found.json");
    let verification = sandbox.json("found.json")["verification"].clone();
    for length in verification.as_array().filter(|all| all.len() == 2).expect("two lengths") {
        assert_eq!((&length["after_cm"], &length["withdrawn"]), (&0.0.into(), &false.into()), "{length}");
        assert!(length["before_cm"].as_f64() > Some(0.5), "{length}");
    }
    let calls = sandbox.text("calls");
    let model = fs::canonicalize(sandbox.path()).expect("a folder").join("patched.toml").display().to_string();
    let models = calls.lines().step_by(2).map(|line| line.split(' ').next().expect("a word"));
    assert!(models.clone().all(|given| given == model), "{calls}");
    assert_eq!(models.count(), 3, "one call for each of runs 3, 7 and 11");
    assert!(calls.lines().skip(1).step_by(2).all(|header| header == "t_ms,left,right"), "{calls}");

    let wrong = verified(&sandbox, "cp logs/run-000.csv \"$3\"\n");
    assert_eq!(wrong.code, 0, "{}", wrong.err);
    assert_eq!(sandbox.json("found.json")["verification"][0]["withdrawn"], true);
    assert_eq!(sandbox.text("patched.toml"), sandbox.text("logs/robot.toml"), "a copy of the model");
    assert!(patched(&sandbox).1.is_empty());

    let none = verified(&sandbox, "echo >> tries\n");
    assert_eq!((none.code, none.err.lines().count()), (1, 1), "{}", none.err);
    assert!(none.err.contains("was not written by the simulator's command"), "{}", none.err);
    assert_eq!(sandbox.text("tries").lines().count(), 2, "a failure is repeated once");
}

#[test]
fn layers_of_both_sides_are_a_bag_that_the_official_reader_takes() {
    let sandbox = both_sides();
    let real = sandbox.logs("real");
    // One run of the simulator drove the robot's commands, elsewhere in the room, and went the same way.
    let mut simulator = sandbox.logs("logs");
    let elsewhere = Pose::new(40.0, -25.0, 0.6);
    let mut same = Run { name: "run-012".into(), ..real.runs[0].clone() };
    (0..same.rows.len())
        .for_each(|k| same.rows.edit(k, |row| row.pose = row.pose.map(|pose| elsewhere.compose(&pose))));
    simulator.runs.push(same);
    simulator.write(&sandbox.path().join("simulator")).expect("a folder");
    sandbox.run("compare simulator --real real --mcap layers.mcap --html gap.html --json found.json");
    assert_eq!(sandbox.json("found.json")["pairs"].as_array().map(Vec::len), Some(1));
    assert!(sandbox.text("gap.html").contains("the simulator, as recorded"));

    let layers = messages(&sandbox.path().join("layers.mcap"));
    let runs = &layers["/run"];
    assert_eq!((runs.len(), &runs[11][1]), (12, &Value::from("run-011")));
    let first = real.runs[0].rows.at(0).pose.expect("a pose").position_cm;
    let numbers = |topic: &str| -> Vec<Vec<f64>> {
        let of_message = |message: &Vec<Value>| message.iter().filter_map(Value::as_f64).collect();
        layers.get(topic).unwrap_or_else(|| panic!("{topic}: {:?}", layers.keys())).iter().map(of_message).collect()
    };
    let robot = numbers("/robot/pose");
    assert_eq!(robot.len(), real.runs.iter().flat_map(|run| &run.rows).filter(|row| row.pose.is_some()).count());
    assert!((robot[0][1] - first.x / 100.0).abs() < 1e-9 && (robot[0][2] - first.y / 100.0).abs() < 1e-9);
    let mut means_m = Vec::new();
    for simulator in ["simulator", "simulator_with_causes", "recorded_simulator"] {
        let [simulated, residuals] =
            [format!("/{simulator}/pose"), format!("/residual/{simulator}")].map(|topic| numbers(&topic));
        let mut distances_m = Vec::new();
        for residual in &residuals {
            let at = |poses: &[Vec<f64>]| poses.iter().find(|pose| pose[0] == residual[0]).cloned().expect("a pose");
            let (robot, simulated) = (at(&robot), at(&simulated));
            let apart_m = libm::hypot(robot[1] - simulated[1], robot[2] - simulated[2]);
            assert!((libm::hypot(residual[1], residual[2]) - apart_m).abs() < 1e-9, "{simulator}: {residual:?}");
            distances_m.push(apart_m);
        }
        assert!(distances_m[0] < 1e-9, "{simulator} begins at the robot");
        assert!(layers[&format!("/{simulator}/path")][0].len() > 100, "a path of a whole run");
        means_m.push(distances_m.iter().sum::<f64>() / distances_m.len() as f64);
    }
    assert!(means_m[1] < 0.5 * means_m[0], "the cause brings the simulator nearer: {means_m:?}");
    assert!(means_m[2] < 1e-3, "the recording is moved to the robot's start: {means_m:?}");
    sandbox.run("compare simulator --real real --mcap layers.mcap");
}

#[test]
fn every_range_sensor_of_recordings_and_folders_is_compared() {
    let sandbox = Sandbox::new();
    for (folder, points_deg) in [("logs", 60.0), ("real", 85.0)] {
        sandbox.run(&format!("record --out {folder} --runs 12 --steps 60 --seed 5"));
        add(&sandbox, folder, "left", [60.0, points_deg]);
    }
    let runs = |folder: &str| (0..12).map(|run| format!("{folder}/run-{run:03}.csv")).collect::<Vec<_>>().join(" ");
    let files = "--robot logs/robot.toml --scene logs/scene.toml --out kept";
    let of_files = format!("{} --real {} {files}", runs("logs"), runs("real"));
    for sides in ["logs --real real", &of_files] {
        let said = sandbox.run(&format!("compare {sides} --json found.json"));
        let found = sandbox.json("found.json");
        let effects = found["effects"].as_array().expect("effects");
        let turned = effects.iter().find(|effect| effect["id"] == "sonar_yaw");
        let turned = turned.unwrap_or_else(|| panic!("{sides}: {said}"));
        assert_eq!(turned["sensor"], "left", "{sides}: {said}");
        assert!((turned["parameters"]["deg"].as_f64().expect("an angle") - 25.0).abs() < 6.0, "{sides}: {turned}");
        let mut of_first = effects.iter().filter(|effect| effect["sensor"] == "ultrasonic");
        assert!(of_first.all(|effect| effect["probability"].as_f64() < Some(0.5)), "{sides}: {said}");
    }
    assert!(sandbox.text("kept/robot/run-000.csv").contains("echo_left_cm"));
    assert!(sandbox.run("info kept/simulator.json").contains("left"));
}

#[test]
fn too_little_of_the_simulator_asks_for_more() {
    let sandbox = Sandbox::new();
    sandbox.run("record --out logs --runs 2 --steps 25");
    sandbox.run("record --out real --runs 4 --steps 25 --seed 2");
    let outcome = sandbox.call("compare logs --real real --out asked");
    assert_eq!((outcome.code, outcome.err.lines().count()), (1, 1), "{}", outcome.err);
    assert!(outcome.err.contains("drive-these.csv"), "{}", outcome.err);
    assert!(sandbox.text("asked/drive-these.csv").starts_with("t_ms,left,right\n"));
    sandbox.run("info asked/drive-these.mcap");
}
