//! Logs that other robots and other programs wrote are read, and can be used for training.

use std::path::Path;

use mindgap_logs::{Logs, Scene, samples};
use mindgap_tests::command::Sandbox;

/// Rows of each nominal run.
const ROWS: usize = 60;

fn read(folder: &Path) -> Logs {
    Logs::read(folder, |warning| panic!("{warning}")).unwrap_or_else(|problem| panic!("{problem}"))
}

pub fn nominal_logs_are_read_without_a_warning(data: &Path) {
    for (folder, runs) in [("nominal", 100), ("nominal-holdout", 30)] {
        let logs = read(&data.join(folder));
        assert_eq!(logs.runs.len(), runs);
        assert!(logs.runs.iter().all(|run| run.rows.len() == ROWS));
        let lost = |run: &mindgap_logs::Run| run.rows.iter().filter(|row| row.pose.is_none()).count();
        let lost: usize = logs.runs.iter().map(lost).sum();
        let most = runs * (ROWS - 1);
        let (steps, rows) = (samples::motion(&logs).len(), samples::sonar(&logs).len());
        assert_eq!(rows, runs * ROWS - lost, "a row gives a sonar sample unless the tracker lost the robot");
        assert!(most - 2 * lost <= steps && steps <= most, "{steps} steps with {lost} rows lost");
    }
}

pub fn a_real_sonar_at_rest_trains_the_two_sonar_networks(logs: &Path) {
    let (sandbox, logs) = (Sandbox::new(), logs.display());
    let outcome = sandbox.call(&format!("train {logs} --out sim.json"));
    assert_eq!(outcome.code, 0, "{}", outcome.err);
    for network in ["turn", "forward", "lateral"] {
        assert!(outcome.err.contains(&format!("warning: no {network} network: ")), "{}", outcome.err);
    }
    sandbox.run(&format!("evaluate sim.json {logs} --json figures.json"));
    let figures = sandbox.json("figures.json");
    let mut judged: Vec<&String> = figures["networks"].as_object().unwrap().keys().collect();
    judged.sort();
    assert_eq!(judged, ["echo_probability", "echo_value"]);
}

pub fn the_scene_with_four_obstacles_is_read(path: &Path) {
    let scene = Scene::read(path).unwrap_or_else(|problem| panic!("{problem}"));
    assert_eq!((scene.obstacles.len(), scene.starts.len()), (4, 4));
    assert_eq!(scene.target_cm.map(|at| at.to_array()), Some([265.0, 115.0]));
    assert!(scene.starts.iter().all(|start| scene.has_room_for(start.position_cm, 10.0)));
}
