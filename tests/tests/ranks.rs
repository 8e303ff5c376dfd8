//! `mpirun -n R mindgap …` writes the same files as threads do, and reports a failure in one line.

use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::{Command, Stdio};
use std::thread;
use std::time::Duration;

use mindgap_tests::command::{Outcome, Sandbox, program};
use mindgap_tests::form::short_or_long;
use mindgap_tests::rooms::{challenge, robot, with_scene};

/// Returns a process that runs the command on `count` ranks in a folder.
fn ranks(sandbox: &Sandbox, count: usize, arguments: &str) -> Command {
    let mut command = Command::new("mpirun");
    command.current_dir(sandbox.path()).args(["--allow-run-as-root", "--oversubscribe", "--quiet"]);
    command.args(["-n", &count.to_string()]).arg(program()).args(arguments.split_whitespace());
    command
}

/// Returns the lines of the command itself: `mpirun` adds some on failure.
fn own_lines(outcome: &Outcome) -> Vec<&str> {
    outcome.err.lines().filter(|line| line.starts_with("mindgap: ")).collect()
}

/// Expects the same files and output from `calls` on threads and on any number of ranks.
#[track_caller]
fn same_at_any_number(prepared: &Sandbox, calls: &[&str]) {
    let threads = prepared.copy();
    let outputs: Vec<String> = calls.iter().map(|call| threads.run(call)).collect();
    for count in short_or_long(vec![3], vec![1, 2, 4]) {
        let sandbox = prepared.copy();
        for (call, output) in calls.iter().zip(&outputs) {
            let outcome = sandbox.execute(ranks(&sandbox, count, call));
            assert_eq!(outcome.code, 0, "{count} ranks: {call}: {}", outcome.err);
            assert_eq!(outcome.out, *output, "{count} ranks: {call}");
        }
        let (expected, found) = (threads.files(""), sandbox.files(""));
        assert_eq!(expected.len(), found.len(), "{count} ranks: {calls:?}");
        for (a, b) in expected.iter().zip(&found) {
            assert!(a == b, "{count} ranks: {calls:?}: {} and {}", a.0.display(), b.0.display());
        }
    }
}

#[test]
fn training_and_evolution_do_not_depend_on_the_number_of_ranks() {
    same_at_any_number(&with_scene(), &["train logs --out again.json", EVOLVE]);
}

#[test]
fn a_challenge_does_not_depend_on_the_number_of_ranks() {
    same_at_any_number(&Sandbox::new(), &["challenge make --cases 3 --seed 5 --out blind"]);
    same_at_any_number(&challenge(2), &["challenge answer blind"]);
}

#[test]
fn a_loop_does_not_depend_on_the_number_of_ranks() {
    let sandbox = with_scene();
    robot(&sandbox, "", "");
    let path = sandbox.path().join("robot.sh");
    sandbox.edit("robot.sh", |text| format!("#!/bin/sh\n{text}"));
    fs::set_permissions(&path, fs::Permissions::from_mode(0o755)).expect("a command");
    let call = "loop out --sim sim.json --scene scene.toml --max-steps 20 --trials 1 --robot";
    same_at_any_number(&sandbox, &[&format!("{call} {}", path.display())]);
}

#[test]
fn commands_without_shared_work_run_once() {
    same_at_any_number(&Sandbox::new(), &["record --out logs --runs 2 --steps 5", "check logs"]);
}

const EVOLVE: &str = "evolve sim.json --scene scene.toml --max-steps 20 --paper --out controller.toml";

#[test]
fn a_failure_is_reported_once() {
    let sandbox = with_scene();
    sandbox.edit("scene.toml", |text| text.replace("[target]", "[aim]"));
    let outcome = sandbox.execute(ranks(&sandbox, 3, EVOLVE));
    assert_eq!((outcome.code, own_lines(&outcome).len()), (1, 1), "{outcome:?}");
    assert!(!sandbox.path().join("controller.toml").exists());
}

#[test]
fn ranks_with_other_arguments_or_files_are_refused() {
    let (here, there) = (with_scene(), with_scene());
    there.edit("scene.toml", |text| text.replace("x_cm = 160", "x_cm = 161"));
    let refused = |folder: &Sandbox, more: &str| {
        let mut command = ranks(&here, 1, EVOLVE);
        command.args([":", "-n", "1", "-wdir"]).arg(folder.path()).arg(program());
        command.args(EVOLVE.split_whitespace()).args(more.split_whitespace());
        let outcome = here.execute(command);
        assert_eq!((outcome.code, own_lines(&outcome).len()), (1, 1), "{outcome:?}");
        assert!(!here.path().join("controller.toml").exists());
        own_lines(&outcome)[0].to_owned()
    };
    assert!(refused(&here, "--seed 2").ends_with("rank 1 differs from rank 0: it has --seed 2, not 1"));
    assert!(refused(&there, "").ends_with("it has different content in scene.toml"));
}

#[test]
fn a_run_resumes_from_its_checkpoint_after_a_rank_is_killed() {
    let unbroken = with_scene();
    let broken = unbroken.copy();
    unbroken.run(EVOLVE);
    let call = format!("{EVOLVE} --checkpoint kept");
    let mut command = ranks(&broken, 3, &call);
    let mut running = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("mpirun starts");
    while fs::metadata(broken.path().join("kept")).map_or(0, |file| file.len()) < 20_000 {
        assert!(running.try_wait().expect("a process").is_none(), "it ends before it is killed");
        thread::sleep(Duration::from_millis(5));
    }
    let victim = rank_in(broken.path(), 1).expect("rank 1 runs");
    assert!(Command::new("kill").args(["-9", &victim]).status().expect("kill runs").success());
    assert!(!running.wait().expect("mpirun ends").success());
    let outcome = broken.call(&call);
    assert_eq!(outcome.code, 0, "{}", outcome.err);
    assert!(outcome.err.contains("kept: resuming, "), "{}", outcome.err);
    assert_eq!(unbroken.files(""), broken.files(""));
}

/// Returns the process of a rank that works in a folder.
fn rank_in(folder: &Path, rank: usize) -> Option<String> {
    let folder = folder.canonicalize().ok()?;
    let sign = format!("OMPI_COMM_WORLD_RANK={rank}");
    let is_it = |process: &Path| {
        let environment = fs::read(process.join("environ")).unwrap_or_default();
        fs::read_link(process.join("cwd")).is_ok_and(|cwd| cwd == folder)
            && environment.split(|byte| *byte == 0).any(|variable| variable == sign.as_bytes())
    };
    let process = fs::read_dir("/proc").ok()?.flatten().map(|entry| entry.path()).find(|process| is_it(process))?;
    Some(process.file_name()?.to_str()?.to_owned())
}
