//! Disk failures: `strace` lists the system calls by which a command changes a disk, then makes them fail one by one.
//!
//! The short form fails a few calls of each command. The long form fails every call of the quick commands.

use std::collections::BTreeMap;
use std::fs;
use std::path::PathBuf;
use std::process::Command;

use mindgap_tests::command::{Outcome, Sandbox, program};
use mindgap_tests::form::{is_skipped, short_or_long, spread};
use mindgap_tests::rooms::{challenge, robot, trained, with_scene};
use rayon::prelude::*;

use super::import_recordings;

/// System calls that change a disk.
const CALLS: &str = "openat,write,fsync,fchmod,mkdir,mkdirat,rename,renameat,renameat2";
/// Disk full, quota exceeded, read-only, hardware error, out of file descriptors, permission denied.
const ERRORS: [&str; 6] = ["ENOSPC", "EDQUOT", "EROFS", "EIO", "EMFILE", "EACCES"];

/// Returns how many calls of a quick command fail, evenly spread.
fn many() -> usize {
    short_or_long(2, usize::MAX)
}

/// Returns how many calls of a slow command fail, or of one that resembles others.
fn few() -> usize {
    short_or_long(1, 8)
}

/// What a failed command may leave.
#[derive(Clone, Copy, PartialEq)]
enum Leaves {
    /// The files from before, or all files that the command makes.
    AllOrNothing,
    /// Complete files of some of its stages.
    Stages,
    /// Files from which the same call resumes to the same end.
    State,
}
use Leaves::{AllOrNothing, Stages, State};

/// A system call: its name, and its number among the calls of that name in its thread, from 1.
#[derive(Clone, Debug)]
struct SystemCall {
    name: String,
    count: usize,
}

#[test]
fn quick_commands_leave_complete_files_when_a_disk_fails() {
    let sandbox = with_scene();
    let tuple = "  { left = 55, right = 48, when = \"larger\", threshold_cm = 42 },\n";
    sandbox.write("six.toml", format!("step_ms = 400\nmax_steps = 10\ntuple = [\n{}]\n", tuple.repeat(6)));
    sandbox.run("export six.toml --format rxe --out six.rxe");
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
        assert_whole(&sandbox, call, many(), AllOrNothing);
    }
    for call in exports.iter().map(String::as_str).chain(["manual --out pages"]) {
        assert_whole(&sandbox, call, few(), AllOrNothing);
    }
    assert_whole(&import_recordings::with_streams(), import_recordings::STREAMS, many(), Stages);
}

#[test]
fn slow_commands_leave_complete_files_when_a_disk_fails() {
    let sandbox = trained();
    sandbox.run("record --out slow --runs 4 --steps 25 --seed 9 --effect drive_scale=0.85");
    let calls = vec![
        ("adapt sim.json slow --out better.json", AllOrNothing),
        ("evaluate sim.json logs --json facts.json --html page.html --figures figures", Stages),
        ("diagnose sim.json slow --json facts.json --html page.html --figures figures --apply better.json", Stages),
        ("challenge make --cases 2 --out blind", AllOrNothing),
    ];
    for (call, leaves) in spread(calls, short_or_long(1, 4)) {
        assert_whole(&sandbox, call, few(), leaves);
    }
}

#[test]
fn evolution_leaves_complete_files_when_a_disk_fails() {
    let sandbox = with_scene();
    assert_whole(
        &sandbox,
        "evolve sim.json --scene scene.toml --max-steps 5 --paper --out c.toml",
        few(),
        AllOrNothing,
    );
}

#[test]
fn answers_of_a_challenge_are_complete_when_a_disk_fails() {
    if is_skipped() {
        return;
    }
    assert_whole(&challenge(2), "challenge answer blind", few(), Stages);
}

/// The robot's command is another program, whose calls do not fail: `strace` detaches from it.
#[test]
fn a_loop_resumes_after_a_disk_failure() {
    let sandbox = with_scene();
    robot(&sandbox, "", "");
    let call = "loop out --sim sim.json --scene scene.toml --max-steps 5 --trials 1 --robot 'sh robot.sh'";
    assert_whole(&sandbox, call, few(), State);
}

#[test]
fn a_demo_resumes_after_a_disk_failure() {
    if is_skipped() {
        return;
    }
    assert_whole(&Sandbox::new(), "demo --quick --out demo --html page.html --force", few(), State);
}

#[test]
fn a_slow_network_folder_changes_no_file() {
    let sandbox = Sandbox::new();
    let late = sandbox.copy();
    sandbox.run("record --out logs --runs 1 --steps 5");
    let inject = ["-e", "trace=openat,write,fsync,rename", "-e", "inject=openat,write,fsync,rename:delay_enter=20000"];
    assert_eq!(traced(&late, &inject, "record --out logs --runs 1 --steps 5").code, 0);
    assert_eq!(late.files(""), sandbox.files(""));
}

/// Makes up to `most` disk calls of a command fail, one per run, and checks the files that each run leaves.
fn assert_whole(sandbox: &Sandbox, call: &str, most: usize, leaves: Leaves) {
    let undisturbed = sandbox.copy();
    let trace = undisturbed.path().join("trace");
    let list = ["-o", trace.to_str().expect("a path in UTF-8"), "-e", &format!("trace={CALLS}")];
    let outcome = traced(&undisturbed, &list, call);
    assert_eq!(outcome.code, 0, "{call}: {}", outcome.err);
    let changes = changes(&fs::read_to_string(&trace).expect("strace is there: install the package strace"));
    assert!(changes.len() > 3, "{call}: {changes:?}");
    fs::remove_file(trace).expect("a trace");
    let (before, after) = (sandbox.files(""), undisturbed.files(""));
    let failing = spread(changes.iter().enumerate().collect(), most);
    failing.par_iter().enumerate().for_each(|(turn, (number, SystemCall { name, count }))| {
        let error = ERRORS[number % ERRORS.len()];
        // One failure, and failures from then on, alternating where not every call is tried. Writes never fail for good: then
        // not even the message could be written.
        let modes = match name.as_str() {
            "write" => &[""][..],
            _ if failing.len() == changes.len() => &["", "+"],
            _ if turn % 2 == 0 => &[""],
            _ => &["+"],
        };
        for lasts in modes {
            let what = format!("{call}: {name} {count}{lasts}: {error}");
            let failing = sandbox.copy();
            let inject = format!("inject={name}:error={error}:when={count}{lasts}");
            let outcome = traced(&failing, &["-o", "/dev/null", "-e", &format!("trace={name}"), "-e", &inject], call);
            let left = failing.files("");
            if outcome.code == 0 {
                assert_eq!(left, after, "{what}");
                continue;
            }
            assert_eq!(outcome.code, 1, "{what}: {}", outcome.err);
            assert!(
                outcome.err.starts_with("mindgap: ") && outcome.err.lines().count() == 1,
                "{what}: {}",
                outcome.err
            );
            let is_kept = is_kept(&failing);
            // Temporary files stay only where nothing can be opened or renamed any more. The next command removes them.
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

/// Runs a command under strace.
fn traced(sandbox: &Sandbox, options: &[&str], call: &str) -> Outcome {
    let mut strace = Command::new("strace");
    let words = shlex::split(call).expect("closed quotes");
    strace.current_dir(sandbox.path()).args(["-f", "-b", "execve", "-qq"]).args(options).arg(program()).args(words);
    sandbox.execute(strace)
}

/// Returns the calls of a trace that change a disk, in order.
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
            // A folder that exists already is not made.
            _ => !arguments.contains("= -1"),
        };
        if changes_a_disk && CALLS.split(',').any(|known| known == name) {
            changes.push(SystemCall { name: name.to_owned(), count: *count });
        }
    }
    changes
}

/// Returns whether a file under a temporary name is left.
fn is_kept(sandbox: &Sandbox) -> bool {
    sandbox.files("").keys().any(|path| path.to_string_lossy().contains(".mindgap-"))
}
