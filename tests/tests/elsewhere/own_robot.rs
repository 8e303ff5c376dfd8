//! From a robot's streams as they came to their diagnosis, as somebody with a robot of their own goes.

use std::fs;
use std::path::Path;

use mindgap_tests::command::Workshop;

/// The causes of a diagnosis, the largest share first.
fn causes(workshop: &Workshop, diagnosis: &str) -> Vec<String> {
    let diagnosis = workshop.json(diagnosis);
    let effects = diagnosis["effects"].as_array().expect("a list");
    let mut shares: Vec<(f64, String)> = effects
        .iter()
        .map(|effect| (effect["share"].as_f64().unwrap_or(0.0), effect["id"].as_str().expect("a name").to_owned()))
        .collect();
    shares.sort_by(|a, b| b.0.total_cmp(&a.0));
    shares.into_iter().map(|(_, id)| id).collect()
}

/// Three commands and no editor but for the robot's measures lead from streams to the causes that the runs have which
/// somebody made of them by hand.
pub fn streams_lead_to_the_causes_in_three_commands(folder: &Path) {
    let workshop = Workshop::new();
    workshop.done("new mine");
    for name in ["command.csv", "groundtruth.csv"] {
        fs::copy(folder.join("streams").join(name), workshop.path().join("mine/recordings").join(name))
            .expect("a file that can be copied");
    }
    workshop.edit("mine/robot.toml", |text| text.replace("track_cm = 15 ", "track_cm = 23.5 "));
    let said = workshop.done(
        "import streams mine/recordings/command.csv mine/recordings/groundtruth.csv --robot mine/robot.toml --out mine/logs",
    );
    assert!(said.contains("one clock"), "{said}");
    workshop.done("diagnose kinematic mine/logs --json mine/gap.json");
    let by_streams = causes(&workshop, "mine/gap.json");
    workshop.done(&format!("diagnose kinematic {} --json runs.json", folder.display()));
    let by_runs = causes(&workshop, "runs.json");
    for cause in ["turn_loss", "latency"] {
        assert!(by_streams.iter().any(|id| id == cause), "{by_streams:?}");
        assert!(by_runs.iter().any(|id| id == cause), "{by_runs:?}");
    }
}
