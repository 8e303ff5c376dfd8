//! Commands that are interrupted, exhaust a resource, or write to the same place as another.

use std::fmt::Display;
use std::fs::{self, File};
use std::os::unix::process::ExitStatusExt;
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use mindgap_tests::command::{Sandbox, program};

/// A command that takes minutes and adds to a folder all the time.
const LONG: &str = "challenge make --cases 999 --out blind -q";

#[test]
fn an_interrupted_command_leaves_no_file() {
    for (signal, number) in [("INT", 2), ("TERM", 15)] {
        let sandbox = Sandbox::new();
        let mut child = at_work(&sandbox);
        kill(child.id(), signal);
        assert_eq!(child.wait().expect("it ends").signal(), Some(number));
        assert_eq!(sandbox.listing(), [], "{signal}");
    }
}

#[test]
fn the_next_command_removes_files_of_a_killed_one() {
    let sandbox = Sandbox::new();
    let [mut killed, mut other] = [(); 2].map(|()| at_work(&sandbox));
    kill(killed.id(), "KILL");
    assert!(killed.wait().expect("it ends").code().is_none());
    assert_eq!(temporary(&sandbox), 2);
    sandbox.run("record --out logs --runs 1 --steps 5");
    assert_eq!(temporary(&sandbox), 1, "what another process is at work on stays");
    kill(other.id(), "TERM");
    other.wait().expect("it ends");
    assert_eq!(temporary(&sandbox), 0);
}

/// The logs of the last of several processes remain, and no mixture of them.
#[test]
fn concurrent_processes_do_not_mix_their_logs() {
    let sandbox = Sandbox::new();
    let seeds = [1, 2, 3, 4];
    for seed in seeds {
        sandbox.run(&format!("record --out logs-{seed} --runs 8 --steps 5 --seed {seed}"));
    }
    let start = |force: &str| {
        let mut children = seeds.map(|seed| {
            let mut command = sandbox.command(&format!("record --out logs --runs 8 --steps 5 --seed {seed} {force}"));
            command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("it starts")
        });
        children.iter_mut().map(|child| child.wait().expect("it ends").code()).collect::<Vec<_>>()
    };
    let assert_one = || {
        let of =
            |folder: &str| (0..8).map(|run| sandbox.bytes(&format!("{folder}/run-{run:03}.csv"))).collect::<Vec<_>>();
        let logs = of("logs");
        assert!(seeds.iter().any(|seed| of(&format!("logs-{seed}")) == logs), "a mixture");
        assert_eq!(fs::read_dir(sandbox.path().join("logs")).expect("a folder").count(), 8 + 2);
    };
    for _ in 0..4 {
        let codes = start("");
        assert!(codes.iter().all(|code| matches!(code, Some(0 | 1))) && codes.contains(&Some(0)), "{codes:?}");
        assert_one();
        assert_eq!(start("--force"), [Some(0); 4]);
        assert_one();
        fs::remove_dir_all(sandbox.path().join("logs")).expect("a folder");
    }
}

#[test]
fn concurrent_writers_of_a_file_leave_one_complete_version() {
    let sandbox = Sandbox::with_logs();
    let seeds = [1, 2, 3];
    let train = |out: &str, seed: u32| sandbox.command(&format!("train logs --out {out} --seed {seed} -q"));
    let alone = seeds.map(|seed| {
        assert!(train("alone.json", seed).status().expect("it starts").success());
        sandbox.bytes("alone.json")
    });
    let children = seeds.map(|seed| train("sim.json", seed).spawn().expect("it starts"));
    children.into_iter().for_each(|mut child| assert!(child.wait().expect("it ends").success()));
    assert!(alone.contains(&sandbox.bytes("sim.json")));
    assert_eq!(temporary(&sandbox), 0);
}

/// Files that were written before the clock was set back have a time in the future.
#[test]
fn a_clock_set_back_changes_nothing() {
    let sandbox = Sandbox::with_logs();
    let unchanged = sandbox.copy();
    sandbox.write(".mindgap-AbCdEf.tmp", "left by a process that was killed");
    let day = Duration::from_secs(24 * 3600);
    for (path, _) in sandbox.listing() {
        let file = File::open(path).expect("a file");
        let written = file.metadata().and_then(|about| about.modified()).expect("a time");
        file.set_modified(written + day).expect("a file of one's own");
    }
    for folder in [&sandbox, &unchanged] {
        folder.run("train logs --out sim.json");
    }
    assert_eq!(sandbox.listing().len(), unchanged.listing().len(), "what was left is gone");
    assert_eq!(sandbox.bytes("sim.json"), unchanged.bytes("sim.json"));
}

/// With any limit on memory, files or their size a command does its work or gives the reason in one line.
#[test]
fn exhausted_resources_are_reported() {
    let good = Sandbox::with_logs();
    let call = "check logs --json facts.json";
    let limited = |limit: &str, call: &str| {
        let mut shell = Command::new("sh");
        shell.args(["-c", &format!("ulimit {limit}; exec {} {call}", program().display())]);
        shell
    };
    // With less memory the system, the loader or the Rust runtime ends it before its first instruction.
    let begins = |kib: &usize| limited(&format!("-v {kib}"), "--version").output().expect("a shell").status.success();
    let least_kib = (1..).map(|i| 2_000 * i).find(begins).expect("a limit");
    let limits = (0..10).map(|i| format!("-v {}", least_kib + 2_000 * i)).chain((4..=10).map(|n| format!("-n {n}")));
    let mut refused = 0;
    for limit in limits.chain(["-f 1".to_owned()]) {
        let sandbox = good.copy();
        let mut shell = limited(&limit, call);
        shell.current_dir(sandbox.path());
        let before = sandbox.listing();
        let outcome = sandbox.execute(shell);
        if outcome.code == 0 {
            continue;
        }
        refused += 1;
        // The loader, and the libraries of Rust and C without memory, have messages of their own.
        let of_memory =
            ["memory allocation of ", "Fatal glibc error: "].iter().any(|words| outcome.err.starts_with(words));
        assert!(outcome.code == 1 || outcome.err.contains("shared"), "{limit}: {outcome:?}");
        assert!(of_memory || outcome.err.lines().count() == 1, "{limit}: {}", outcome.err);
        sandbox.run("check logs --json check.json");
        fs::remove_file(sandbox.path().join("check.json")).expect("a file");
        assert_eq!(sandbox.listing(), before, "{limit}");
    }
    assert!(refused > 3, "{refused} of them were too little");
}

/// Starts a long command and waits until it writes to a folder of its own.
fn at_work(sandbox: &Sandbox) -> Child {
    let before = temporary(sandbox);
    let child = sandbox.command(LONG).stdout(Stdio::null()).spawn().expect("it starts");
    let begun = Instant::now();
    while temporary(sandbox) == before {
        assert!(begun.elapsed() < Duration::from_secs(60), "nothing is being made");
        sleep(Duration::from_millis(5));
    }
    child
}

fn temporary(sandbox: &Sandbox) -> usize {
    let entries = fs::read_dir(sandbox.path()).expect("a folder");
    entries.flatten().filter(|entry| entry.file_name().to_string_lossy().starts_with(".mindgap-")).count()
}

/// Sends a signal to a process.
pub(super) fn kill(id: impl Display, signal: &str) {
    let sent = Command::new("kill").args([format!("-{signal}"), id.to_string()]).status();
    assert!(sent.expect("kill is there").success());
}
