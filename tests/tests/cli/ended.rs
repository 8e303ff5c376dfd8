//! Commands that are ended from outside, run out of something, or meet another at the same place.

use std::fs::{self, File};
use std::os::unix::process::ExitStatusExt;
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use mindgap_tests::command::{Workshop, program};

/// Takes minutes, and fills a folder all the time.
const LONG: &str = "challenge make --cases 999 --out blind -q";

#[test]
fn a_signal_leaves_nothing() {
    for (signal, number) in [("INT", 2), ("TERM", 15)] {
        let workshop = Workshop::new();
        let mut child = at_work(&workshop);
        kill(&child, signal);
        assert_eq!(child.wait().expect("it ends").signal(), Some(number));
        assert_eq!(workshop.listing(), [], "{signal}");
    }
}

#[test]
fn the_next_start_clears_what_a_killed_process_left() {
    let workshop = Workshop::new();
    let [mut killed, mut other] = [(); 2].map(|()| at_work(&workshop));
    kill(&killed, "KILL");
    assert!(killed.wait().expect("it ends").code().is_none());
    assert_eq!(temporary(&workshop), 2);
    workshop.done("record --out logs --runs 1 --steps 5");
    assert_eq!(temporary(&workshop), 1, "what another process is at work on stays");
    kill(&other, "TERM");
    other.wait().expect("it ends");
    assert_eq!(temporary(&workshop), 0);
}

/// The last of several processes at one place stays, and nothing is a mixture.
#[test]
fn processes_at_one_place_do_not_mix() {
    let workshop = Workshop::new();
    let seeds = [1, 2, 3, 4];
    for seed in seeds {
        workshop.done(&format!("record --out logs-{seed} --runs 8 --steps 5 --seed {seed}"));
    }
    let start = |force: &str| {
        let mut children = seeds.map(|seed| {
            let mut command = workshop.command(&format!("record --out logs --runs 8 --steps 5 --seed {seed} {force}"));
            command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("it starts")
        });
        children.iter_mut().map(|child| child.wait().expect("it ends").code()).collect::<Vec<_>>()
    };
    let assert_one = || {
        let of =
            |folder: &str| (0..8).map(|run| workshop.bytes(&format!("{folder}/run-{run:03}.csv"))).collect::<Vec<_>>();
        let logs = of("logs");
        assert!(seeds.iter().any(|seed| of(&format!("logs-{seed}")) == logs), "a mixture");
        assert_eq!(fs::read_dir(workshop.path().join("logs")).expect("a folder").count(), 8 + 2);
    };
    for _ in 0..4 {
        let codes = start("");
        assert!(codes.iter().all(|code| matches!(code, Some(0 | 1))) && codes.contains(&Some(0)), "{codes:?}");
        assert_one();
        assert_eq!(start("--force"), [Some(0); 4]);
        assert_one();
        fs::remove_dir_all(workshop.path().join("logs")).expect("a folder");
    }
}

#[test]
fn of_what_several_processes_write_into_one_file_one_stays() {
    let workshop = Workshop::with_logs();
    let seeds = [1, 2, 3];
    let train = |out: &str, seed: u32| workshop.command(&format!("train logs --out {out} --seed {seed} -q"));
    let alone = seeds.map(|seed| {
        assert!(train("alone.json", seed).status().expect("it starts").success());
        workshop.bytes("alone.json")
    });
    let children = seeds.map(|seed| train("sim.json", seed).spawn().expect("it starts"));
    children.into_iter().for_each(|mut child| assert!(child.wait().expect("it ends").success()));
    assert!(alone.contains(&workshop.bytes("sim.json")));
    assert_eq!(temporary(&workshop), 0);
}

/// What was written before the clock was set back is of tomorrow.
#[test]
fn a_clock_that_is_set_back_changes_nothing() {
    let workshop = Workshop::with_logs();
    let unchanged = workshop.copy();
    workshop.write(".mindgap-AbCdEf.tmp", "left by a process that was killed");
    let day = Duration::from_secs(24 * 3600);
    for (path, _) in workshop.listing() {
        let file = File::open(path).expect("a file");
        let written = file.metadata().and_then(|about| about.modified()).expect("a time");
        file.set_modified(written + day).expect("a file of one's own");
    }
    for folder in [&workshop, &unchanged] {
        folder.done("train logs --out sim.json");
    }
    assert_eq!(workshop.listing().len(), unchanged.listing().len(), "what was left is gone");
    assert_eq!(workshop.bytes("sim.json"), unchanged.bytes("sim.json"));
}

/// With whatever little, a command does its work or says in a line why not.
#[test]
fn what_runs_out_is_told() {
    let good = Workshop::with_logs();
    let call = "check logs --json facts.json";
    let limited = |limit: &str, call: &str| {
        let mut shell = Command::new("sh");
        shell.args(["-c", &format!("ulimit {limit}; exec {} {call}", program().display())]);
        shell
    };
    // With less it is ended by the system, the loader or Rust's start, before its own first instruction.
    let begins = |kib: &usize| limited(&format!("-v {kib}"), "--version").output().expect("a shell").status.success();
    let least_kib = (1..).map(|i| 2_000 * i).find(begins).expect("a limit");
    let limits = (0..10).map(|i| format!("-v {}", least_kib + 2_000 * i)).chain((4..=10).map(|n| format!("-n {n}")));
    let mut refused = 0;
    for limit in limits.chain(["-f 1".to_owned()]) {
        let workshop = good.copy();
        let mut shell = limited(&limit, call);
        shell.current_dir(workshop.path());
        let before = workshop.listing();
        let done = workshop.run(shell);
        if done.code == 0 {
            continue;
        }
        refused += 1;
        // The loader of programs has words of its own, and so have Rust's library and C's where there is no memory.
        let of_memory =
            ["memory allocation of ", "Fatal glibc error: "].iter().any(|words| done.err.starts_with(words));
        assert!(done.code == 1 || done.err.contains("shared"), "{limit}: {done:?}");
        assert!(of_memory || done.err.lines().count() == 1, "{limit}: {}", done.err);
        workshop.done("check logs --json check.json");
        fs::remove_file(workshop.path().join("check.json")).expect("a file");
        assert_eq!(workshop.listing(), before, "{limit}");
    }
    assert!(refused > 3, "{refused} of them were too little");
}

/// A long command that has begun to fill a folder of its own.
fn at_work(workshop: &Workshop) -> Child {
    let before = temporary(workshop);
    let child = workshop.command(LONG).stdout(Stdio::null()).spawn().expect("it starts");
    let begun = Instant::now();
    while temporary(workshop) == before {
        assert!(begun.elapsed() < Duration::from_secs(60), "nothing is being made");
        sleep(Duration::from_millis(5));
    }
    child
}

fn temporary(workshop: &Workshop) -> usize {
    let entries = fs::read_dir(workshop.path()).expect("a folder");
    entries.flatten().filter(|entry| entry.file_name().to_string_lossy().starts_with(".mindgap-")).count()
}

fn kill(child: &Child, signal: &str) {
    let sent = Command::new("kill").args([format!("-{signal}"), child.id().to_string()]).status();
    assert!(sent.expect("kill is there").success());
}
