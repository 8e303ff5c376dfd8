//! Commands that take long, killed at random moments and called again: the same files as from a run without a break, and
//! nothing else.
//!
//! `MINDGAP_KILLS=200 cargo test -p mindgap-tests --test cli -- --nocapture broken_off` kills each of them that often.

use std::env;
use std::process::{Command, Output, Stdio};
use std::thread;
use std::time::Instant;

use mindgap_tests::command::Workshop;
use mindgap_tests::rooms::{challenge, robot, trained, with_scene};
use rand::rngs::SmallRng;
use rand::{RngExt, SeedableRng};

/// Kills of each command, by default,
const KILLS: usize = 20;
/// and of one that takes long.
const FEW: usize = 3;
/// A run is killed before this share of the time of a whole one.
const LATEST: f64 = 0.5;
/// So much is written before a checkpoint is torn, bytes.
const TORN_AT: u64 = 4000;

const EVOLVE: &str = "evolve sim.json --scene scene.toml --max-steps 10 --paper --out controller.toml";
/// How small networks are trained.
const PAPER: &str = "--trainer paper --hidden turn=2 --hidden forward=2 --hidden lateral=2 --hidden echo_probability=2 \
                     --hidden echo_value=2";
/// Most of its time goes into cases.
const MAKE: &str = "challenge make --quick --cases 40 --seed 5 --out blind";

/// Kills a call again and again, until one comes to its end, and compares what it leaves with what one leaves that was
/// never killed; and that until it was killed often enough.
#[track_caller]
fn survives(prepared: &Workshop, call: &[&str], usual: usize) {
    let kills = env::var("MINDGAP_KILLS").ok().and_then(|count| count.parse().ok()).unwrap_or(usual);
    let unbroken = prepared.copy();
    let began = Instant::now();
    let expected = output(&unbroken, call, None).0.expect("nobody kills it");
    let whole = began.elapsed();
    let mut rng = SmallRng::seed_from_u64(20);
    let (mut killed, mut went_on, mut compared) = (0, 0, 0);
    while killed < kills {
        let broken = prepared.copy();
        let found = loop {
            let after = (killed < kills).then(|| whole.mul_f64(rng.random_range(0.0..LATEST)));
            let (found, goes_on) = output(&broken, call, after.map(|after| Instant::now() + after));
            went_on += usize::from(goes_on);
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
        "{call:?}: {killed} kills, went on from a checkpoint {went_on} times, the ends of {compared} runs compared"
    );
}

/// What a call prints, none if it was killed before its end; and whether it said that it goes on.
#[track_caller]
fn output(workshop: &Workshop, call: &[&str], kill_at: Option<Instant>) -> (Option<String>, bool) {
    let mut command = workshop.command("");
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
    (printed, stderr.contains("goes on"))
}

#[track_caller]
fn assert_same(unbroken: &Workshop, broken: &Workshop, call: &[&str]) {
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
fn evolve_survives() {
    survives(&with_scene(), &words(EVOLVE), KILLS);
}

#[test]
fn train_survives() {
    survives(&Workshop::with_logs(), &words(&format!("train logs {PAPER} --out paper.json")), KILLS);
}

#[test]
fn a_challenge_survives() {
    survives(&Workshop::new(), &words(MAKE), KILLS);
}

#[test]
fn a_loop_survives() {
    let workshop = with_scene();
    robot(&workshop, "", "");
    let call = "loop out --sim sim.json --scene scene.toml --max-steps 5 --trials 1 --robot";
    survives(&workshop, &call.split_whitespace().chain(["sh robot.sh"]).collect::<Vec<_>>(), KILLS);
}

#[test]
fn answers_survive() {
    survives(&challenge(2), &words("challenge answer blind"), KILLS);
}

#[test]
fn a_fleet_survives() {
    let workshop = trained();
    for robot in 1..=6 {
        workshop.done(&format!("record --out fleet/{robot} --runs 2 --steps 10 --seed {robot}"));
    }
    survives(&workshop, &words("diagnose sim.json fleet --fleet out"), KILLS);
}

#[test]
fn a_calibration_survives() {
    let call = "challenge calibrate --quick --cases 40 --out calibration.toml --csv cases.csv";
    survives(&Workshop::new(), &words(call), FEW);
}

#[test]
fn a_demo_survives() {
    survives(&Workshop::new(), &words("demo --quick --out demo --html page.html --json facts.json"), FEW);
}

/// A call that was killed when its checkpoint had some pieces in it.
fn broken_evolution() -> Workshop {
    let workshop = with_scene();
    kill_when_kept(&workshop, EVOLVE, "kept");
    workshop
}

fn kill_when_kept(workshop: &Workshop, call: &str, checkpoint: &str) {
    let kept = workshop.path().join(checkpoint);
    let mut running = workshop.command(call).args(["--checkpoint", checkpoint]).spawn().expect("the command starts");
    while kept.metadata().map_or(0, |file| file.len()) < TORN_AT {
        assert!(running.try_wait().expect("a process").is_none(), "it ends before it is killed");
    }
    running.kill().expect("a process of ours");
    running.wait().expect("a process that ends");
}

#[test]
fn of_a_torn_checkpoint_the_beginning_is_used() {
    let unbroken = with_scene();
    unbroken.done(EVOLVE);
    let broken = broken_evolution();
    let mut bytes = broken.bytes("kept");
    bytes.truncate(bytes.len() - 3);
    broken.write("kept", bytes);
    let done = broken.call(&format!("{EVOLVE} --checkpoint kept"));
    assert_eq!(done.code, 0, "{}", done.err);
    let told: Vec<&str> = done.err.lines().collect();
    assert!(
        told.len() == 2 && told[0].contains("kept: its end is torn") && told[1].contains("kept: goes on"),
        "{told:?}"
    );
    assert_same(&unbroken, &broken, &[EVOLVE]);
}

#[test]
fn what_is_called_by_another_path_is_the_same() {
    let unbroken = Workshop::with_logs();
    let broken = unbroken.copy();
    let (folder, call) = (broken.path().display(), |logs: &str, out: &str| format!("train {logs} {PAPER} --out {out}"));
    unbroken.done(&call("logs", "paper.json"));
    // It lies in the folder that is read, of which it is no part by any name.
    kill_when_kept(&broken, &call("logs", "paper.json"), "logs/kept");
    let done = broken.call(&format!("{} --checkpoint ./logs/kept", call(&format!("{folder}/logs"), "./paper.json")));
    assert!(done.code == 0 && done.err.contains("kept: goes on"), "{}", done.err);
    assert_same(&unbroken, &broken, &[PAPER]);
}

#[test]
fn a_checkpoint_of_another_run_is_refused_by_name() {
    let broken = broken_evolution();
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
    assert!(said.contains("of a run with another content of /"), "{said}");
    broken.edit("scene.toml", |text| text.replace("x_cm = 160", "x_cm = 161"));
    assert!(refused(EVOLVE).contains("another content of scene.toml"));
    broken.write("kept", "my own notes\n");
    assert!(refused(EVOLVE).contains("is not a checkpoint that mindgap wrote"));
}

/// What a program says that is the same but for a byte behind its end. A shell writes it: what this process writes may still
/// be open in another test's child, and then it cannot be run.
fn refused_by_another_build(broken: &Workshop) -> String {
    let call = broken.command(&format!("{EVOLVE} --checkpoint kept"));
    let rebuilt = "cp \"$0\" rebuilt && printf x >> rebuilt && exec ./rebuilt \"$@\"";
    let mut shell = Command::new("sh");
    shell.arg("-c").arg(rebuilt).arg(call.get_program()).args(call.get_args()).current_dir(broken.path());
    let done = shell.output().expect("a shell");
    assert_eq!(done.status.code(), Some(1));
    String::from_utf8_lossy(&done.stderr).into_owned()
}
