//! `mindgap diagnose --drive`: scripts are driven on a robot until one name is left.

use std::fs;
use std::process::Command;
use std::sync::LazyLock;
use std::thread;

use mindgap_tests::command::{Outcome, Sandbox, program};
use mindgap_tests::form::{is_long, short_or_long, spread};
use mindgap_tests::rooms::with_forty_runs;

use super::drivers::assert_nothing_is_left;

/// A small weaker motor, which six runs do not tell from others.
const FAULT: &str = "--effect payload=0.03";

/// Returns a folder with a simulator, and logs in `laden` that leave several names.
fn undecided() -> Sandbox {
    static UNDECIDED: LazyLock<Sandbox> = LazyLock::new(|| {
        let sandbox = with_forty_runs();
        sandbox.run(&format!("record --out laden --runs 6 --seed 5 {FAULT}"));
        sandbox
    });
    UNDECIDED.copy()
}

/// Returns the shell code that drives the built-in robot.
fn good() -> String {
    let mindgap = program().display();
    format!("'{mindgap}' drive \"$1\" --scene laden/scene.toml --out \"$2\" --seed \"$3\" {FAULT}")
}

fn call(sandbox: &Sandbox, options: &str) -> Command {
    let mut command = sandbox.command(&format!("diagnose sim.json laden --out series {options}"));
    command.args(["--drive", "sh 'my driver.sh'"]);
    command
}

fn driven(sandbox: &Sandbox, options: &str) -> Outcome {
    sandbox.execute(call(sandbox, options))
}

#[test]
fn scripts_are_driven_until_the_runs_are_used_up_and_a_series_is_resumed() {
    let sandbox = undecided();
    let drive = good();
    sandbox.write("my driver.sh", format!("echo \"$@\" >> calls\n{drive} > /dev/null\n"));
    let first = driven(&sandbox, "--runs 1 --json first.json");
    assert_eq!(first.code, 0, "{}", first.err);
    assert!(first.out.starts_with("After 1 run in series: "), "{}", first.out);
    let calls = sandbox.text("calls");
    let words: Vec<&str> = calls.split_whitespace().collect();
    assert!(words.len() == 3 && words[0].starts_with('/') && words[0].ends_with("/series/script-000.csv"), "{calls}");
    assert!(words[1].starts_with('/') && words[2].parse::<u64>().is_ok(), "{calls}");
    let script = sandbox.text("series/script-000.csv");
    assert!(script.starts_with("t_ms,left,right\n0,") && script.ends_with(",0,0\n"), "{script}");

    let second = driven(&sandbox, "--runs 2 --json second.json");
    assert_eq!(second.code, 0, "{}", second.err);
    let [first, second] = ["first.json", "second.json"].map(|name| sandbox.json(name));
    assert_eq!(first["driven"][0]["log"], "run-000.csv");
    assert!(first["driven"][0]["expected_nats"].as_f64().is_some_and(|nats| nats > 0.0), "{first}");
    let further = second["driven"].as_array().expect("a list");
    assert!(further.iter().all(|run| run["log"] == "run-001.csv"), "the first run is not repeated: {further:?}");

    // The logs are a folder of logs, and one call gives the same as two.
    sandbox.run("check series");
    if !is_long() {
        return;
    }
    let whole = undecided();
    whole.write("my driver.sh", format!("{} > /dev/null\n", good()));
    assert_eq!(driven(&whole, "--runs 2").code, 0);
    assert_eq!(whole.files("series"), sandbox.files("series"));
}

#[test]
fn a_series_of_other_logs_is_refused() {
    let sandbox = undecided();
    sandbox.write("my driver.sh", "exit 3\n");
    fs::create_dir(sandbox.path().join("series")).expect("a folder");
    sandbox.write("series/notes.txt", "mine");
    let refused = driven(&sandbox, "--runs 1");
    assert!(refused.code == 1 && refused.err.contains("series: already contains \"notes.txt\""), "{}", refused.err);
    fs::remove_file(sandbox.path().join("series/notes.txt")).expect("a file");
    sandbox.write("series/script-000.csv", "t_ms,left,right\n0,1,1\n400,0,0\n");
    sandbox.write("series/robot.toml", sandbox.text("laden/robot.toml").replace("11.5", "12.5"));
    let refused = driven(&sandbox, "--runs 1");
    let problem = "series/robot.toml: differs from that of the first logs: give another folder to --out";
    assert!(refused.code == 1 && refused.err.contains(problem), "{}", refused.err);
}

#[test]
fn drivers_that_fail_twice_end_the_series_in_one_line() {
    let undecided = undecided();
    let other =
        "printf 't_ms,left,right,x_cm,y_cm,heading_deg,echo_cm\\n0,9,9,50,50,0,\\n400,9,9,51,50,0,\\n' > \"$2\"";
    let cases = vec![
        ("exit 4", "failed: exit status: 4"),
        ("sleep 90", "took longer than 4 s and was ended"),
        ("trap '' TERM; sleep 90", "took longer than 4 s and was ended"),
        ("(setsid sleep 90 &) ; exit 0", "was not written by the robot"),
        ("mkfifo \"$2\"", "is not a regular file"),
        ("ln -s \"$PWD/laden/run-000.csv\" \"$2\"", "is not a regular file"),
        ("cp laden/run-000.csv \"$2\"", "is of another drive"),
        (other, "is of another drive: 0 of 2 commands are the script's"),
        ("printf 't_ms,left,right\\n0,0,0\\n' > \"$2\"", "columns x_cm, y_cm, heading_deg, echo_cm are missing"),
    ];
    thread::scope(|scope| {
        for (driver, problem) in spread(cases, short_or_long(4, 9)) {
            let sandbox = undecided.copy();
            scope.spawn(move || {
                sandbox.write("my driver.sh", driver);
                let outcome = driven(&sandbox, "--runs 3 --command-timeout 4 --json result.json");
                assert_eq!((outcome.code, outcome.out.as_str()), (1, ""), "{driver}: {}", outcome.err);
                let last = outcome.err.lines().last().unwrap_or_default();
                assert!(last.contains("run-000.csv failed 2 times, stopped: "), "{driver}: {}", outcome.err);
                assert!(last.contains(problem), "{driver}: {}", outcome.err);
                let left = ["series/run-000.csv", "result.json"].map(|name| sandbox.path().join(name).exists());
                assert_eq!(left, [false; 2], "{driver}");
                assert_nothing_is_left(&sandbox, driver);
            });
        }
    });
}

#[test]
fn a_run_that_fails_once_is_driven_again() {
    let sandbox = undecided();
    let drive = good();
    sandbox.write("my driver.sh", format!("if mkdir once 2> /dev/null; then exit 5; fi\n{drive} > /dev/null\n"));
    // Without a folder for them, the logs are not kept.
    let mut command = sandbox.command("diagnose sim.json laden --runs 1");
    command.args(["--drive", "sh 'my driver.sh'"]);
    let outcome = sandbox.execute(command);
    assert!(outcome.code == 0 && outcome.out.starts_with("After 1 run: "), "{} {}", outcome.out, outcome.err);
    assert!(outcome.err.contains("run 1: failed, nothing learned: "), "{}", outcome.err);
}

/// A file next to foreign logs says neither what is run nor where its logs go.
#[test]
fn a_file_next_to_logs_does_not_choose_the_driver() {
    let sandbox = undecided();
    for (text, key) in [("drive = \"sh evil.sh\"\n", "diagnose.drive"), ("out = \"elsewhere\"\n", "diagnose.out")] {
        sandbox.write("mindgap.toml", format!("[diagnose]\n{text}runs = 1\n"));
        let calls = format!("diagnose sim.json laden {}", if key == "diagnose.drive" { "--out series" } else { "" });
        let mut command = sandbox.command(&calls);
        if key == "diagnose.out" {
            command.args(["--drive", "sh 'my driver.sh'"]);
        }
        let refused = sandbox.execute(command);
        let problem = format!("mindgap.toml:2: a file next to logs cannot set {key}");
        assert!(refused.code == 1 && refused.err.contains(&problem), "{key}: {}", refused.err);
    }
}

#[test]
fn options_of_a_series_belong_together() {
    let sandbox = undecided();
    for options in ["--drive x", "--drive x --out y", "--runs 3", "--out y", "--drive x --runs 0 --out y"] {
        assert_eq!(sandbox.call(&format!("diagnose sim.json laden {options}")).code, 2, "{options}");
    }
}
