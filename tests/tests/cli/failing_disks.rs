//! Disks that fail: each call of the system by which a command changes a disk is made to fail, one after the other.
//!
//! `strace` does that: it lists the calls of a run that nothing disturbs, and then fails the one that it is told.

use std::collections::BTreeMap;
use std::fs;
use std::path::PathBuf;
use std::process::Command;

use mindgap_tests::command::{Done, Workshop, program};
use mindgap_tests::rooms::{challenge, robot, trained, with_scene};
use rayon::prelude::*;

use super::import_recordings;

/// By these a disk is changed.
const CALLS: &str = "openat,write,fsync,fchmod,mkdir,mkdirat,rename,renameat,renameat2";
/// What disks say: full, quota used up, read-only, broken, file handles spent, not allowed.
const ERRORS: [&str; 6] = ["ENOSPC", "EDQUOT", "EROFS", "EIO", "EMFILE", "EACCES"];
/// Of the calls of slow commands, and of those that are much like others, so many fail, evenly spread.
const FEW: usize = 4;

/// What there may be after a command that failed.
#[derive(Clone, Copy, PartialEq)]
enum Leaves {
    /// What there was before, or all that it makes.
    AllOrNothing,
    /// Files that are complete, of some of its stages.
    Stages,
    /// Files from which the same call goes on to the same end.
    State,
}
use Leaves::{AllOrNothing, Stages, State};

/// A call of the system: its name, and which of that name it is in its thread, from 1.
#[derive(Clone, Debug)]
struct SystemCall {
    name: String,
    count: usize,
}

#[test]
fn quick_commands_fail_at_every_call() {
    let workshop = with_scene();
    let tuple = "  { left = 55, right = 48, when = \"larger\", threshold_cm = 42 },\n";
    workshop.write("six.toml", format!("step_ms = 400\nmax_steps = 10\ntuple = [\n{}]\n", tuple.repeat(6)));
    workshop.done("export six.toml --format rxe --out six.rxe");
    let formats = ["nxc", "c", "rust", "rxe", "pybricks", "arduino"];
    let exports = formats.map(|format| format!("export six.toml --format {format} --out made.{format}"));
    let calls = [
        "record --out fresh/logs --runs 1 --steps 5",
        "record --out logs --runs 2 --steps 5 --force",
        "check logs --json check.json",
        "train logs --out sim.json",
        "evaluate sim.json logs --json facts.json",
        "simulate sim.json six.toml --scene scene.toml --runs 2 --json runs.json",
        "crosscheck sim.json logs --json facts.json",
        "drive six.toml --scene scene.toml --out run.csv",
        "brick six.rxe --readings 90,20,none --limit-ms 2000 --json events.json",
        "export sim.json --format rust --out networks.rs",
        "export --format nxc-collect --out collect.nxc",
        "new mine",
    ];
    for call in calls {
        assert_whole(&workshop, call, usize::MAX, AllOrNothing);
    }
    for call in exports.iter().map(String::as_str).chain(["manual --out pages"]) {
        assert_whole(&workshop, call, FEW, AllOrNothing);
    }
    assert_whole(&import_recordings::with_streams(), import_recordings::STREAMS, usize::MAX, Stages);
}

#[test]
fn slow_commands_fail_at_some() {
    let workshop = trained();
    workshop.done("record --out slow --runs 4 --steps 25 --seed 9 --effect drive_scale=0.85");
    for (call, leaves) in [
        ("adapt sim.json slow --out better.json", AllOrNothing),
        ("evaluate sim.json logs --json facts.json --html page.html --figures figures", Stages),
        ("diagnose sim.json slow --json facts.json --html page.html --figures figures --apply better.json", Stages),
        ("challenge make --cases 2 --out blind", AllOrNothing),
    ] {
        assert_whole(&workshop, call, FEW, leaves);
    }
}

/// What writes one result after the other, and what keeps a checkpoint: what is there is complete, and goes on.
#[test]
fn long_commands_fail_at_some() {
    let workshop = with_scene();
    assert_whole(&workshop, "evolve sim.json --scene scene.toml --max-steps 5 --paper --out c.toml", FEW, AllOrNothing);
    assert_whole(&challenge(2), "challenge answer blind", FEW, Stages);
}

/// The robot's command is another program, which does not fail: `strace` lets go of it.
#[test]
fn a_loop_fails_at_some() {
    let workshop = with_scene();
    robot(&workshop, "", "");
    let call = "loop out --sim sim.json --scene scene.toml --max-steps 5 --trials 1 --robot 'sh robot.sh'";
    assert_whole(&workshop, call, FEW, State);
}

#[test]
fn a_demo_fails_at_some() {
    assert_whole(&Workshop::new(), "demo --quick --out demo --html page.html --force", FEW, State);
}

/// Files that are late are the same files.
#[test]
fn a_slow_network_folder_changes_nothing() {
    let workshop = Workshop::new();
    let late = workshop.copy();
    workshop.done("record --out logs --runs 1 --steps 5");
    let inject = ["-e", "trace=openat,write,fsync,rename", "-e", "inject=openat,write,fsync,rename:delay_enter=20000"];
    assert_eq!(traced(&late, &inject, "record --out logs --runs 1 --steps 5").code, 0);
    assert_eq!(late.files(""), workshop.files(""));
}

/// Fails calls of a command, and checks what it leaves.
fn assert_whole(workshop: &Workshop, call: &str, most: usize, leaves: Leaves) {
    let undisturbed = workshop.copy();
    let trace = undisturbed.path().join("trace");
    let list = ["-o", trace.to_str().expect("a path in UTF-8"), "-e", &format!("trace={CALLS}")];
    let done = traced(&undisturbed, &list, call);
    assert_eq!(done.code, 0, "{call}: {}", done.err);
    let changes = changes(&fs::read_to_string(&trace).expect("strace is there: install the package strace"));
    assert!(changes.len() > 3, "{call}: {changes:?}");
    fs::remove_file(trace).expect("a trace");
    let (before, after) = (workshop.files(""), undisturbed.files(""));
    let stride = changes.len().div_ceil(most);
    let failing: Vec<(usize, &SystemCall)> = changes.iter().enumerate().step_by(stride).collect();
    failing.par_iter().for_each(|(number, SystemCall { name, count })| {
        let error = ERRORS[number % ERRORS.len()];
        // Once, and from then on, unless nothing could then be said; of a few one or the other in turn.
        let modes = match name.as_str() {
            "write" => &[""][..],
            _ if stride == 1 => &["", "+"],
            _ if (number / stride).is_multiple_of(2) => &[""],
            _ => &["+"],
        };
        for lasts in modes {
            let what = format!("{call}: {name} {count}{lasts}: {error}");
            let failing = workshop.copy();
            let inject = format!("inject={name}:error={error}:when={count}{lasts}");
            let done = traced(&failing, &["-o", "/dev/null", "-e", &format!("trace={name}"), "-e", &inject], call);
            let left = failing.files("");
            if done.code == 0 {
                assert_eq!(left, after, "{what}");
                continue;
            }
            assert_eq!(done.code, 1, "{what}: {}", done.err);
            assert!(done.err.starts_with("mindgap: ") && done.err.lines().count() == 1, "{what}: {}", done.err);
            let is_kept = is_kept(&failing);
            // Where nothing can be opened or renamed any more, what is left waits for the next command.
            assert!(!is_kept || (name.starts_with("rename") || name == "openat") && *lasts == "+", "{what}");
            if is_kept || leaves == State {
                assert_eq!(traced(&failing, &["-o", "/dev/null"], call).code, 0, "{what}");
                assert!(failing.files("") == after, "{what}");
                continue;
            }
            let is_either =
                |file: (&PathBuf, &Vec<u8>)| [&before, &after].iter().any(|all| all.get(file.0) == Some(file.1));
            let is_whole = match leaves {
                AllOrNothing => left == before || left == after,
                Stages | State => left.iter().all(is_either),
            };
            assert!(is_whole, "{what}: {:?} is left", left.keys());
            assert!(before.keys().all(|file| left.contains_key(file) || !after.contains_key(file)), "{what}");
        }
    });
}

/// Runs a command under strace, without what it is not asked for.
fn traced(workshop: &Workshop, options: &[&str], call: &str) -> Done {
    let mut strace = Command::new("strace");
    let words = shlex::split(call).expect("closed quotes");
    strace.current_dir(workshop.path()).args(["-f", "-b", "execve", "-qq"]).args(options).arg(program()).args(words);
    workshop.run(strace)
}

/// The calls of a trace that change a disk, in order.
fn changes(trace: &str) -> Vec<SystemCall> {
    let mut counts: BTreeMap<(&str, &str), usize> = BTreeMap::new();
    let mut changes = Vec::new();
    for line in trace.lines() {
        let Some((thread, call)) = line.split_once(char::is_whitespace) else { continue };
        let Some((name, arguments)) = call.trim_start().split_once('(') else { continue };
        let count = counts.entry((thread, name)).or_default();
        *count += 1;
        let changes_a_disk = match name {
            "openat" => !arguments.contains("O_RDONLY") && !arguments.contains("\"/dev/"),
            "write" => {
                !["1,", "2,"].iter().any(|stream| arguments.starts_with(stream))
                    && !arguments.contains("\\0\\0\\0\", 8")
            }
            // What is there already is not made.
            _ => !arguments.contains("= -1"),
        };
        if changes_a_disk && CALLS.split(',').any(|known| known == name) {
            changes.push(SystemCall { name: name.to_owned(), count: *count });
        }
    }
    changes
}

/// Whether something under a temporary name is left.
fn is_kept(workshop: &Workshop) -> bool {
    workshop.files("").keys().any(|path| path.to_string_lossy().contains(".mindgap-"))
}
