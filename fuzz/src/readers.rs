//! Every reader of user input: it accepts or rejects any bytes, and accepted values are consistent.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::str;
use std::sync::Arc;

use mindgap_applications::challenge::Folder;
use mindgap_applications::challenge::score::score;
use mindgap_applications::challenge::seal::{Published, Sealed};
use mindgap_applications::closed_loop::Job;
use mindgap_applications::closed_loop::state::{FILE, State};
use mindgap_built_in_robot::effects::ActiveEffect;
use mindgap_built_in_robot::{default_robot, four_obstacles};
use mindgap_command as cli;
use mindgap_command::kinds::{CALIBRATION, CHECKPOINT, CONTROLLER, FORMULA, PAGE, PROGRAM, REPORT, SIMULATOR};
use mindgap_controller_export::names::BrickName;
use mindgap_controller_export::wiring::{MotorPort, SensorPort};
use mindgap_files as files;
use mindgap_foundations::executor::Serial;
use mindgap_import::bag::{self, Choice};
use mindgap_import::brick_log::BrickLog;
use mindgap_import::contents::Contents;
use mindgap_import::mapping::Mapping;
use mindgap_import::statements::Statements;
use mindgap_import::streams;
use mindgap_logs::controller_file::ControllerFile;
use mindgap_logs::inspection::Inspection;
use mindgap_logs::{Logs, Robot, Run, Scene, readings, world_script};
use mindgap_models::effects::applied::AppliedEffect;
use mindgap_models::effects::own;
use mindgap_models::effects::own::expression::Expression;
use mindgap_models::effects::own::variables::Stage;
use mindgap_models::simulator::Simulator;
use mindgap_workers::checkpoint::{Checkpoint, CreateFile};
use mindgap_workers::task::Task;
use serde_json::Value;

use crate::{Target, as_file};

pub const TARGETS: &[Target] = &[
    Target { name: "run", feed: run },
    Target { name: "inspection", feed: inspection },
    Target { name: "scene", feed: scene },
    Target { name: "robot", feed: robot },
    Target { name: "controller", feed: |bytes| drop(as_file("c.toml", bytes, ControllerFile::read)) },
    Target { name: "simulator", feed: |bytes| drop(as_file("s.json", bytes, Simulator::read)) },
    Target { name: "loop-state", feed: loop_state },
    Target { name: "own-effects", feed: |bytes| drop(as_file("e.toml", bytes, own::read)) },
    Target { name: "expression", feed: expression },
    Target {
        name: "bag",
        feed: |bytes| {
            drop(as_file("b.mcap", bytes, |path| bag::recordings(&[path.into()], &Choice::default(), &[], |_| ())))
        },
    },
    Target { name: "track", feed: |bytes| drop(as_file("t.csv", bytes, Contents::of_table)) },
    Target { name: "brick-log", feed: brick_log },
    Target {
        name: "streams",
        feed: |bytes| {
            drop(as_file("s.csv", bytes, |path| streams::recordings(&[path.into()], &Statements::default(), |_, _| ())))
        },
    },
    Target { name: "mapping", feed: |bytes| drop(as_file("m.toml", bytes, Mapping::read)) },
    Target {
        name: "readings",
        feed: |bytes| drop(as_file("r.csv", bytes, |path| readings::read(&path.to_string_lossy()))),
    },
    Target { name: "world-script", feed: |bytes| drop(as_file("w.csv", bytes, world_script::read)) },
    Target { name: "defaults", feed: defaults },
    Target { name: "answer", feed: answer },
    Target { name: "seal", feed: |bytes| drop(as_file("sealed.json", bytes, files::read_json::<Vec<Sealed>>)) },
    Target { name: "cases", feed: cases },
    Target { name: "added", feed: added },
    Target { name: "checkpoint", feed: checkpoint },
    Target { name: "kinds", feed: kinds },
    Target { name: "effect", feed: effect },
    Target { name: "wiring", feed: wiring },
];

/// A run has the times that a simple parser finds.
fn run(bytes: &[u8]) {
    let Ok(text) = str::from_utf8(bytes) else { return };
    let Ok(run) = Run::parse(Path::new("run-000.csv"), text, &["t_ms"], |_| {}) else { return };
    // Without quotes and comments, commas and line ends separate the cells of a table.
    if !text.contains(['"', '#', '\r']) {
        let mut lines = text.lines().filter(|line| !line.is_empty());
        let column = lines.next().and_then(|header| header.split(',').position(|name| name.trim() == "t_ms"));
        let column = column.expect("a run that was read has the column");
        let times_ms = lines.map(|line| line.split(',').nth(column).and_then(|cell| cell.trim().parse::<f64>().ok()));
        assert!(times_ms.eq(run.rows.iter().map(|row| Some(row.t_ms))), "a simple parser reads different times");
    }
}

fn brick_log(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    drop(BrickLog::parse(Path::new("l.csv"), text, &Arc::default(), |_| {}));
}

fn inspection(bytes: &[u8]) {
    let Ok(text) = str::from_utf8(bytes) else { return };
    let Ok(run) = Run::parse(Path::new("run-000.csv"), text, &["t_ms"], |_| {}) else { return };
    let logs = Logs { robot: default_robot(), scene: four_obstacles(), runs: vec![run] };
    let _ = Inspection::new(logs).into_usable(|_| {});
}

/// A scene round-trips through its own text.
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
    // Only checked: a compiled expression stays in memory until the program ends.
    let _ = Expression::check(text, &["k"], Stage::Motion);
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

/// The state in a loop's folder, which names only files of this folder.
fn loop_state(bytes: &[u8]) {
    as_file("scene.toml", b"", |scene| {
        let folder = scene.with_file_name("loop");
        let job = Job {
            executor: &Serial,
            folder: &folder,
            simulator: scene,
            scene,
            start: 1,
            trials: 1,
            max_steps: 1,
            known: &[],
            seed: 1,
        };
        let file = folder.join(FILE);
        let _ = fs::remove_dir_all(&folder);
        fs::create_dir(&folder).expect("a folder");
        State::open(&job).and_then(|fresh| fresh.write(&folder)).expect("an empty folder");
        let fresh: Value = files::read_json(&file).expect("its own file");
        // Any other value belongs to another loop.
        let state = serde_json::from_slice::<Value>(bytes).map(|mut state| {
            if let Some(state) = state.as_object_mut() {
                for key in ["schema", "job"] {
                    state.insert(key.into(), fresh[key].clone());
                }
            }
            state.to_string().into_bytes()
        });
        fs::write(&file, state.unwrap_or_else(|_| bytes.to_vec())).expect("a file");
        for trial in State::open(&job).map_or_else(|_| Vec::new(), |state| state.trials) {
            for name in [&trial.controller, &trial.log] {
                assert!(files::in_folder(&folder, name).is_ok() && name.starts_with("trial-"), "{name}");
            }
        }
    });
}

/// The list of a challenge's cases, whose names lie in its folder.
fn cases(bytes: &[u8]) {
    as_file("cases.csv", bytes, |path| {
        let folder = Folder(path.parent().expect("a folder"));
        for Published { case, robot, .. } in folder.published().unwrap_or_default() {
            assert!(!case.contains('/') && !robot.contains('/') && folder.case(&case).file_name().is_some());
        }
    });
}

/// Scores the diagnosis of a case.
fn answer(bytes: &[u8]) {
    let sealed = Sealed {
        case: "1".into(),
        effects: vec!["motor_asymmetry=0.1".into()],
        driving: "mixed".into(),
        fresh_seed: 1,
        salt: String::new(),
    };
    as_file("sealed.json", b"", |seal| {
        let folder = Folder(seal.parent().expect("a folder"));
        if !folder.answers().exists() {
            let published = Published { case: "1".into(), robot: "1".into(), commitment: sealed.commitment() };
            files::write_csv(&folder.cases(), &[published]).expect("a list of cases");
            fs::create_dir(folder.answers()).expect("a folder");
            fs::write(folder.added("1"), "[]").expect("no effects");
        }
        fs::write(seal, serde_json::to_vec(&[&sealed]).expect("a seal")).expect("a file");
        fs::write(folder.answer("1"), bytes).expect("an answer");
        let _ = score(folder.0, |_, _| {});
    });
}

/// Effects that are applied to a simulator are resolved or rejected.
fn added(bytes: &[u8]) {
    let Ok(added) = serde_json::from_slice::<Vec<AppliedEffect>>(bytes) else { return };
    for effect in &added {
        if let Ok((candidate, values)) = effect.resolve(&default_robot()) {
            assert_eq!(candidate.variant.parameters.len(), values.len());
        }
    }
}

/// A checkpoint of an interrupted run: the valid items before damaged bytes are recovered, and others can be added.
fn checkpoint(bytes: &[u8]) {
    let task = Task::new("evolve".into(), BTreeMap::new(), &[], &[]);
    as_file("a.checkpoint", bytes, |path| {
        let open = || Checkpoint::open(path, &task, CreateFile::AtOnce, |_| {});
        let Ok(mut checkpoint) = open() else { return };
        let count = checkpoint.count();
        let _ = checkpoint.load::<Vec<f64>>((1, 0));
        checkpoint.save((u32::MAX, u32::MAX), &[1.0]).expect("room for a piece");
        let count_after = open().expect("what was written").count();
        assert!((count.max(1)..=count + 1).contains(&count_after), "{count} items and one more gave {count_after}");
    });
}

/// The kind of a file at an output path: a file without a signature is not one of the command's own.
fn kinds(bytes: &[u8]) {
    let kinds = [SIMULATOR, REPORT, CONTROLLER, PROGRAM, CALIBRATION, PAGE, FORMULA, CHECKPOINT];
    let recognised = kinds.iter().filter(|kind| (kind.is_own)(bytes)).count();
    assert!(recognised == 0 || bytes.len() > 8);
}

/// An effect of the built-in robot round-trips through its text.
fn effect(bytes: &[u8]) {
    let Ok(text) = str::from_utf8(bytes) else { return };
    if let Ok(effect) = text.parse::<ActiveEffect>() {
        assert_eq!(effect.to_string().parse(), Ok(effect));
    }
}

fn wiring(bytes: &[u8]) {
    let Ok(text) = str::from_utf8(bytes) else { return };
    let _ = (text.parse::<MotorPort>(), text.parse::<SensorPort>());
    if let Ok(name) = text.parse::<BrickName>() {
        assert!(name.to_string().len() <= 19, "a brick has no room for {name}");
    }
}
