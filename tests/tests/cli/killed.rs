//! Long-running commands are killed at random moments and called again. They leave the same files as an uninterrupted run
//! and no others.
//!
//! `MINDGAP_SLOW=1 cargo test -p mindgap-tests --test cli -- --nocapture killed` runs the long form, and prints how often
//! each command resumed from a checkpoint.

use std::process::{Command, Output, Stdio};
use std::thread;
use std::time::Instant;

use mindgap_tests::command::Sandbox;
use mindgap_tests::form::{is_skipped, short_or_long};
use mindgap_tests::rooms::{challenge, robot, trained, with_scene};
use rand::rngs::SmallRng;
use rand::{RngExt, SeedableRng};

/// Latest time of a kill, as a share of the duration of an uninterrupted run.
const LATEST: f64 = 0.5;
/// Size of a checkpoint at which its command is killed, bytes.
const KILLED_AT: u64 = 4000;

const EVOLVE: &str = "evolve sim.json --scene scene.toml --max-steps 10 --paper --out controller.toml";
/// Trains small networks by the paper's trainer.
const PAPER: &str = "--trainer paper --hidden turn=2 --hidden forward=2 --hidden lateral=2 --hidden echo_probability=2 \
                     --hidden echo_value=2";
const MAKE: &str = "challenge make --quick --cases 40 --seed 5 --out blind";

/// Returns the number of kills of each command.
fn kills() -> usize {
    short_or_long(2, 200)
}

/// Kills a call at random moments and repeats it until it succeeds, then compares its files with those of an uninterrupted
/// run. Starts over in a fresh folder until there were `kills` kills.
#[track_caller]
fn survives(prepared: &Sandbox, call: &[&str], kills: usize) {
    let unbroken = prepared.copy();
    let began = Instant::now();
    let expected = output(&unbroken, call, None).0.expect("nobody kills it");
    let whole = began.elapsed();
    let mut rng = SmallRng::seed_from_u64(20);
    let (mut killed, mut resumed, mut compared) = (0, 0, 0);
    while killed < kills {
        let broken = prepared.copy();
        let found = loop {
            let after = (killed < kills).then(|| whole.mul_f64(rng.random_range(0.0..LATEST)));
            let (found, is_resumed) = output(&broken, call, after.map(|after| Instant::now() + after));
            resumed += usize::from(is_resumed);
            match found {
                Some(found) => break found,
                None => killed += 1,
            }
        };
        assert_eq!(found, expected, "{call:?}");
        compared += 1;
        assert_same(&unbroken, &broken, call);
    }
    println!(
        "{call:?}: {killed} kills, resumed from a checkpoint {resumed} times, the files of {compared} runs compared"
    );
}

/// What a call prints, none if it was killed before its end; and whether it resumed.
#[track_caller]
fn output(sandbox: &Sandbox, call: &[&str], kill_at: Option<Instant>) -> (Option<String>, bool) {
    let mut command = sandbox.command("");
    let mut running =
        command.args(call).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the command starts");
    if let Some(at) = kill_at {
        thread::sleep(at.saturating_duration_since(Instant::now()));
        running.kill().expect("a process of ours");
    }
    let Output { status, stdout, stderr } = running.wait_with_output().expect("the command ends");
    let stderr = String::from_utf8_lossy(&stderr);
    let printed = status.code().map(|code| {
        assert_eq!(code, 0, "{call:?}: {stderr}");
        String::from_utf8(stdout).expect("the command writes UTF-8")
    });
    (printed, stderr.contains("resuming"))
}

#[track_caller]
fn assert_same(unbroken: &Sandbox, broken: &Sandbox, call: &[&str]) {
    let (expected, found) = (unbroken.files(""), broken.files(""));
    assert!(found.keys().eq(expected.keys()), "{call:?}: {:?}", found.keys());
    for (path, found) in &found {
        assert!(*found == expected[path], "{call:?}: {}", path.display());
    }
}

fn words(call: &str) -> Vec<&str> {
    call.split_whitespace().chain(["--checkpoint", "kept"]).collect()
}

#[test]
fn evolve_resumes_after_kills() {
    survives(&with_scene(), &words(EVOLVE), kills());
}

#[test]
fn train_resumes_after_kills() {
    let call = format!("train logs {PAPER} --out paper.json");
    survives(&Sandbox::with_logs(), &words(&call), kills());
}

#[test]
fn challenge_make_resumes_after_kills() {
    survives(&Sandbox::new(), &words(MAKE), kills());
}

#[test]
fn loop_resumes_after_kills() {
    let sandbox = with_scene();
    robot(&sandbox, "", "");
    let call = "loop out --sim sim.json --scene scene.toml --max-steps 5 --trials 1 --robot";
    survives(&sandbox, &call.split_whitespace().chain(["sh robot.sh"]).collect::<Vec<_>>(), kills());
}

#[test]
fn challenge_answer_resumes_after_kills() {
    if is_skipped() {
        return;
    }
    survives(&challenge(2), &words("challenge answer blind"), kills());
}

#[test]
fn a_fleet_resumes_after_kills() {
    if is_skipped() {
        return;
    }
    let sandbox = trained();
    for robot in 1..=6 {
        sandbox.run(&format!("record --out fleet/{robot} --runs 2 --steps 10 --seed {robot}"));
    }
    survives(&sandbox, &words("diagnose sim.json fleet --fleet out"), kills());
}

#[test]
fn challenge_calibrate_resumes_after_kills() {
    if is_skipped() {
        return;
    }
    let call = "challenge calibrate --quick --cases 40 --out calibration.toml --csv cases.csv";
    survives(&Sandbox::new(), &words(call), 20);
}

#[test]
fn demo_resumes_after_kills() {
    if is_skipped() {
        return;
    }
    let call = "demo --quick --out demo --html page.html --json facts.json";
    survives(&Sandbox::new(), &words(call), 20);
}

/// Returns a folder in which `evolve` was killed after it had written some items to its checkpoint.
fn killed_evolution() -> Sandbox {
    let sandbox = with_scene();
    kill_when_kept(&sandbox, EVOLVE, "kept");
    sandbox
}

fn kill_when_kept(sandbox: &Sandbox, call: &str, checkpoint: &str) {
    let kept = sandbox.path().join(checkpoint);
    let mut running = sandbox.command(call).args(["--checkpoint", checkpoint]).spawn().expect("the command starts");
    while kept.metadata().map_or(0, |file| file.len()) < KILLED_AT {
        assert!(running.try_wait().expect("a process").is_none(), "it ends before it is killed");
    }
    running.kill().expect("a process of ours");
    running.wait().expect("a process that ends");
}

#[test]
fn truncated_checkpoint_resumes_from_last_valid_item() {
    let unbroken = with_scene();
    unbroken.run(EVOLVE);
    let broken = killed_evolution();
    let mut bytes = broken.bytes("kept");
    bytes.truncate(bytes.len() - 3);
    broken.write("kept", bytes);
    let outcome = broken.call(&format!("{EVOLVE} --checkpoint kept"));
    assert_eq!(outcome.code, 0, "{}", outcome.err);
    let lines: Vec<&str> = outcome.err.lines().collect();
    assert!(
        lines.len() == 2 && lines[0].contains("kept: its end is damaged") && lines[1].contains("kept: resuming"),
        "{lines:?}"
    );
    assert_same(&unbroken, &broken, &[EVOLVE]);
}

#[test]
fn a_run_resumes_when_its_paths_are_written_differently() {
    let unbroken = Sandbox::with_logs();
    let broken = unbroken.copy();
    let (folder, call) = (broken.path().display(), |logs: &str, out: &str| format!("train {logs} {PAPER} --out {out}"));
    unbroken.run(&call("logs", "paper.json"));
    // The checkpoint is in the folder of logs, and must not count as one of its files.
    kill_when_kept(&broken, &call("logs", "paper.json"), "logs/kept");
    let outcome = broken.call(&format!("{} --checkpoint ./logs/kept", call(&format!("{folder}/logs"), "./paper.json")));
    assert!(outcome.code == 0 && outcome.err.contains("kept: resuming"), "{}", outcome.err);
    assert_same(&unbroken, &broken, &[PAPER]);
}

#[test]
fn a_checkpoint_of_another_run_is_refused_with_the_difference() {
    let broken = killed_evolution();
    let refused = |call: &str| broken.refused(&format!("{call} --checkpoint kept"));
    assert!(refused(&format!("{EVOLVE} --seed 2")).contains("of a run with --seed 1, not 2"));
    assert!(refused("challenge make --out blind").contains("of a run with the command evolve, not challenge make"));
    let kept = broken.bytes("kept");
    let end = kept.iter().position(|byte| *byte == b'\n').expect("a first line");
    let header = String::from_utf8(kept[..end].to_vec()).expect("JSON");
    let older = header.replacen("\"version\":\"", "\"version\":\"0.", 1);
    broken.write("kept", [older.as_bytes(), &kept[end..]].concat());
    assert!(refused(EVOLVE).contains("of a run with version 0."));
    broken.write("kept", kept);
    let said = refused_by_another_build(&broken);
    assert!(said.contains("of a run with different content in /"), "{said}");
    broken.edit("scene.toml", |text| text.replace("x_cm = 160", "x_cm = 161"));
    assert!(refused(EVOLVE).contains("different content in scene.toml"));
    broken.write("kept", "my own notes\n");
    assert!(refused(EVOLVE).contains("is not a checkpoint that mindgap wrote"));
}

/// Returns what a copy of the program with one more byte at its end prints. A shell makes the copy: a file that this process
/// writes may still be open in the child of another test, and then it cannot be executed.
fn refused_by_another_build(broken: &Sandbox) -> String {
    let call = broken.command(&format!("{EVOLVE} --checkpoint kept"));
    let rebuilt = "cp \"$0\" rebuilt && printf x >> rebuilt && exec ./rebuilt \"$@\"";
    let mut shell = Command::new("sh");
    shell.arg("-c").arg(rebuilt).arg(call.get_program()).args(call.get_args()).current_dir(broken.path());
    let outcome = shell.output().expect("a shell");
    assert_eq!(outcome.status.code(), Some(1));
    String::from_utf8_lossy(&outcome.stderr).into_owned()
}
