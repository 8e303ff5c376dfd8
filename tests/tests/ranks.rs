//! `mpirun -n R mindgap …`: the same files as from threads, and one line where something is wrong.

use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::{Command, Stdio};
use std::thread;
use std::time::Duration;

use mindgap_tests::command::{Done, Workshop, program};
use mindgap_tests::rooms::{challenge, robot, with_scene};

/// A process with so many ranks in a workshop's folder, each with these arguments.
fn ranks(workshop: &Workshop, count: usize, arguments: &str) -> Command {
    let mut command = Command::new("mpirun");
    command.current_dir(workshop.path()).args(["--allow-run-as-root", "--oversubscribe", "--quiet"]);
    command.args(["-n", &count.to_string()]).arg(program()).args(arguments.split_whitespace());
    command
}

/// The lines that are the command's own: `mpirun` adds some where it fails.
fn own_lines(done: &Done) -> Vec<&str> {
    done.err.lines().filter(|line| line.starts_with("mindgap: ")).collect()
}

/// Threads and any number of ranks leave the same files after `calls`.
#[track_caller]
fn same_at_any_number(prepared: &Workshop, calls: &[&str]) {
    let threads = prepared.copy();
    let told: Vec<String> = calls.iter().map(|call| threads.done(call)).collect();
    for count in [1, 2, 4] {
        let workshop = prepared.copy();
        for (call, told) in calls.iter().zip(&told) {
            let done = workshop.run(ranks(&workshop, count, call));
            assert_eq!(done.code, 0, "{count} ranks: {call}: {}", done.err);
            assert_eq!(done.out, *told, "{count} ranks: {call}");
        }
        let (expected, found) = (threads.files(""), workshop.files(""));
        assert_eq!(expected.len(), found.len(), "{count} ranks: {calls:?}");
        for (a, b) in expected.iter().zip(&found) {
            assert!(a == b, "{count} ranks: {calls:?}: {} and {}", a.0.display(), b.0.display());
        }
    }
}

#[test]
fn training_and_evolution() {
    same_at_any_number(&with_scene(), &["train logs --out again.json", EVOLVE]);
}

#[test]
fn a_challenge() {
    same_at_any_number(&Workshop::new(), &["challenge make --cases 3 --seed 5 --out blind"]);
    same_at_any_number(&challenge(2), &["challenge answer blind"]);
}

#[test]
fn a_loop() {
    let workshop = with_scene();
    robot(&workshop, "", "");
    let path = workshop.path().join("robot.sh");
    workshop.edit("robot.sh", |text| format!("#!/bin/sh\n{text}"));
    fs::set_permissions(&path, fs::Permissions::from_mode(0o755)).expect("a command");
    let call = "loop out --sim sim.json --scene scene.toml --max-steps 20 --trials 1 --robot";
    same_at_any_number(&workshop, &[&format!("{call} {}", path.display())]);
}

#[test]
fn what_is_not_shared_is_done_once() {
    same_at_any_number(&Workshop::new(), &["record --out logs --runs 2 --steps 5", "check logs"]);
}

const EVOLVE: &str = "evolve sim.json --scene scene.toml --max-steps 20 --paper --out controller.toml";

#[test]
fn a_failure_is_told_once() {
    let workshop = with_scene();
    workshop.edit("scene.toml", |text| text.replace("[target]", "[aim]"));
    let done = workshop.run(ranks(&workshop, 3, EVOLVE));
    assert_eq!((done.code, own_lines(&done).len()), (1, 1), "{done:?}");
    assert!(!workshop.path().join("controller.toml").exists());
}

#[test]
fn ranks_with_other_arguments_or_files_are_refused() {
    let (here, there) = (with_scene(), with_scene());
    there.edit("scene.toml", |text| text.replace("x_cm = 160", "x_cm = 161"));
    let refused = |folder: &Workshop, more: &str| {
        let mut command = ranks(&here, 1, EVOLVE);
        command.args([":", "-n", "1", "-wdir"]).arg(folder.path()).arg(program());
        command.args(EVOLVE.split_whitespace()).args(more.split_whitespace());
        let done = here.run(command);
        assert_eq!((done.code, own_lines(&done).len()), (1, 1), "{done:?}");
        assert!(!here.path().join("controller.toml").exists());
        own_lines(&done)[0].to_owned()
    };
    assert!(refused(&here, "--seed 2").ends_with("rank 1 differs from rank 0: it has --seed 2, not 1"));
    assert!(refused(&there, "").ends_with("it has different content in scene.toml"));
}

#[test]
fn after_a_rank_is_killed_the_run_goes_on_from_its_checkpoint() {
    let unbroken = with_scene();
    let broken = unbroken.copy();
    unbroken.done(EVOLVE);
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
    let done = broken.call(&call);
    assert_eq!(done.code, 0, "{}", done.err);
    assert!(done.err.contains("kept: resuming, "), "{}", done.err);
    assert_eq!(unbroken.files(""), broken.files(""));
}

/// The process of a rank that works in a folder.
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
