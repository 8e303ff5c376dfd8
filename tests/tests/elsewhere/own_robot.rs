//! From the recorded streams of a robot to its diagnosis, as the owner of a new robot would do it.

use std::fs;
use std::path::Path;

use mindgap_tests::command::Sandbox;
use mindgap_tests::form::{is_long, short_or_long};

/// Returns the effects of a diagnosis, the largest share first.
fn causes(sandbox: &Sandbox, diagnosis: &str) -> Vec<String> {
    let diagnosis = sandbox.json(diagnosis);
    let effects = diagnosis["effects"].as_array().expect("a list");
    let mut shares: Vec<(f64, String)> = effects
        .iter()
        .map(|effect| (effect["share"].as_f64().unwrap_or(0.0), effect["id"].as_str().expect("a name").to_owned()))
        .collect();
    shares.sort_by(|a, b| b.0.total_cmp(&a.0));
    shares.into_iter().map(|(_, id)| id).collect()
}

/// Returns the lines of a stream up to a time, which is in the first column.
fn up_to(stream: &str, end_s: f64) -> String {
    let is_before = |line: &&str| {
        let time_s = line.split(',').next().and_then(|cell| cell.parse::<f64>().ok());
        time_s.is_none_or(|time_s| time_s < end_s)
    };
    stream.lines().filter(is_before).map(|line| format!("{line}\n")).collect()
}

/// Three commands, and editing robot.toml, give the same effects as the runs that were prepared by hand from the same
/// streams. The short form leaves those runs out, and uses the first two minutes of the streams.
pub fn streams_lead_to_the_causes_in_three_commands(folder: &Path) {
    let sandbox = Sandbox::new();
    sandbox.run("new mine");
    for name in ["command.csv", "groundtruth.csv"] {
        let stream = fs::read_to_string(folder.join("streams").join(name)).expect("a stream");
        let end_s = short_or_long(120.0, f64::INFINITY);
        sandbox.write(&format!("mine/recordings/{name}"), up_to(&stream, end_s));
    }
    sandbox.edit("mine/robot.toml", |text| text.replace("track_cm = 15 ", "track_cm = 23.5 "));
    let said = sandbox.run(
        "import streams mine/recordings/command.csv mine/recordings/groundtruth.csv --robot mine/robot.toml --out mine/logs",
    );
    assert!(said.contains("one clock"), "{said}");
    let assert_named = |logs: &str| {
        sandbox.run(&format!("diagnose kinematic {logs} --json gap.json --force"));
        let causes = causes(&sandbox, "gap.json");
        for cause in ["turn_loss", "latency"] {
            assert!(causes.iter().any(|id| id == cause), "{logs}: {causes:?}");
        }
    };
    assert_named("mine/logs");
    if is_long() {
        assert_named(&folder.display().to_string());
    }
}
