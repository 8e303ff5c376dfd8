//! Every reader of what users give: it takes what it is given or refuses it, and what it takes holds.

use std::fs;
use std::path::Path;
use std::str;

use mindgap_controller_export::brick::{self, Program, RunConfig, ScriptedWorld, Sonar};
use mindgap_host_sim::built_in_robot::{default_robot, four_obstacles};
use mindgap_host_sim::cli;
use mindgap_host_sim::effects::own;
use mindgap_host_sim::effects::own::expression::Expression;
use mindgap_host_sim::effects::own::variables::Stage;
use mindgap_host_sim::evolve::controller_file::ControllerFile;
use mindgap_host_sim::import::bag::{self, Choice};
use mindgap_host_sim::import::brick_log::BrickLog;
use mindgap_host_sim::import::mapping::Mapping;
use mindgap_host_sim::import::streams;
use mindgap_host_sim::import::track::Track;
use mindgap_host_sim::import::units::Units;
use mindgap_host_sim::inspection::Inspection;
use mindgap_host_sim::logs::{Logs, Robot, Run, Scene, readings, world_script};
use mindgap_host_sim::simulator::Simulator;
use mindgap_host_sim::trials::state::State;

use super::{Target, as_file};

pub const TARGETS: &[Target] = &[
    Target { name: "run", feed: run },
    Target { name: "inspection", feed: inspection },
    Target { name: "scene", feed: scene },
    Target { name: "robot", feed: robot },
    Target { name: "controller", feed: |bytes| drop(as_file("c.toml", bytes, ControllerFile::read)) },
    Target { name: "simulator", feed: |bytes| drop(as_file("s.json", bytes, Simulator::read)) },
    Target { name: "loop-state", feed: |bytes| drop(serde_json::from_slice::<State>(bytes)) },
    Target { name: "own-effects", feed: |bytes| drop(as_file("e.toml", bytes, own::read)) },
    Target { name: "expression", feed: expression },
    Target {
        name: "bag",
        feed: |bytes| drop(as_file("b.mcap", bytes, |path| bag::recording(path, &Choice::default(), 0.0))),
    },
    Target {
        name: "track",
        feed: |bytes| drop(as_file("t.csv", bytes, |path| Track::read(path, &Units::default(), &default_robot()))),
    },
    Target { name: "brick-log", feed: |bytes| drop(as_file("l.csv", bytes, |path| BrickLog::read(path, |_| {}))) },
    Target {
        name: "streams",
        feed: |bytes| {
            drop(as_file("s.csv", bytes, |path| {
                streams::recordings(&[path.into()], &Mapping::default(), &Units::default(), |_, _| ())
            }))
        },
    },
    Target { name: "mapping", feed: |bytes| drop(as_file("m.toml", bytes, Mapping::read)) },
    Target {
        name: "readings",
        feed: |bytes| drop(as_file("r.csv", bytes, |path| readings::read(&path.to_string_lossy()))),
    },
    Target { name: "world-script", feed: |bytes| drop(as_file("w.csv", bytes, world_script::read)) },
    Target { name: "defaults", feed: defaults },
    Target { name: "executable", feed: executable },
];

/// What is read of a run is what another parser reads, and is read again as it is written.
fn run(bytes: &[u8]) {
    let Ok(text) = str::from_utf8(bytes) else { return };
    let Ok(run) = Run::parse(Path::new("run-000.csv"), text, &["t_ms"], |_| {}) else { return };
    // Without quotes and comments, a table is what commas and line ends part.
    if !text.contains(['"', '#', '\r']) {
        let mut lines = text.lines().filter(|line| !line.is_empty());
        let place = lines.next().and_then(|header| header.split(',').position(|name| name.trim() == "t_ms"));
        let place = place.expect("what was read has the column");
        let times_ms = lines.map(|line| line.split(',').nth(place).and_then(|cell| cell.trim().parse::<f64>().ok()));
        assert!(times_ms.eq(run.rows.iter().map(|row| Some(row.t_ms))), "another parser reads other times");
    }
}

fn inspection(bytes: &[u8]) {
    let Ok(text) = str::from_utf8(bytes) else { return };
    let Ok(run) = Run::parse(Path::new("run-000.csv"), text, &["t_ms"], |_| {}) else { return };
    let logs = Logs { robot: default_robot(), scene: four_obstacles(), runs: vec![run] };
    let _ = Inspection::of(logs).sound(|_| {});
}

/// A scene is read again as it is written.
fn scene(bytes: &[u8]) {
    let Ok(text) = str::from_utf8(bytes) else { return };
    let path = Path::new("scene.toml");
    if let Ok(scene) = Scene::parse(path, text) {
        assert_eq!(Scene::parse(path, &scene.to_text()).expect("its own text"), scene);
    }
}

fn robot(bytes: &[u8]) {
    let Ok(text) = str::from_utf8(bytes) else { return };
    let _ = Robot::parse(Path::new("robot.toml"), text);
}

fn expression(bytes: &[u8]) {
    let Ok(text) = str::from_utf8(bytes) else { return };
    let _ = Expression::compile(text, &["k"], Stage::Motion);
}

/// `mindgap.toml` beside logs.
fn defaults(bytes: &[u8]) {
    as_file("mindgap.toml", bytes, |path| {
        let logs = path.with_file_name("logs");
        let call = ["mindgap".into(), "check".into(), logs.into_os_string()];
        let _ = cli::defaults::with_defaults(&cli::command(), call.to_vec());
        fs::remove_file(path).expect("a file");
    });
}

/// A program for a brick, which then runs.
fn executable(bytes: &[u8]) {
    let Ok(program) = Program::load(bytes) else { return };
    let mut world = ScriptedWorld::sonar([Sonar::Echo(40), Sonar::Silent, Sonar::Hangs, Sonar::Echo(9)]);
    brick::run(&program, &mut world, &RunConfig { run_ms: 500, limit_events: 1_000, ..RunConfig::default() });
}
