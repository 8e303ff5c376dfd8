//! Robots' commands that misbehave: once `mindgap loop` has returned, nothing that they started is alive, and no log is
//! taken for another attempt's.

use std::fs;
use std::os::unix::fs::symlink;
use std::os::unix::process::ExitStatusExt;
use std::process::{Child, Command, Stdio};
use std::sync::LazyLock;
use std::thread;
use std::time::{Duration, Instant};

use mindgap_tests::command::{Outcome, Sandbox};
use mindgap_tests::rooms::{robot, with_scene};

use super::ended::kill;

const LOOP: &str = "loop out --sim sim.json --scene scene.toml --max-steps 20 --trials 1";
/// A driver that says when it has begun, and when it was asked to stop its motors.
const POLITE: &str = "trap 'echo > stopped; exit 1' TERM; echo $$ > begun; while :; do sleep 0.1; done";
/// A driver that ignores the request.
const STUBBORN: &str = "trap '' TERM; echo $$ > begun; while :; do sleep 0.1; done";

/// Returns a folder in which a loop has planned its first trial.
fn planned() -> Sandbox {
    static PLANNED: LazyLock<Sandbox> = LazyLock::new(|| {
        let sandbox = with_scene();
        sandbox.write("robot.sh", "exit 3\n");
        assert_eq!(looping(&sandbox).code, 1);
        sandbox
    });
    PLANNED.copy()
}

fn command(sandbox: &Sandbox, options: &str) -> Command {
    let mut command = sandbox.command(&format!("{LOOP} {options}"));
    command.args(["--robot", "sh robot.sh"]);
    command
}

fn looping(sandbox: &Sandbox) -> Outcome {
    sandbox.execute(command(sandbox, "--robot-timeout 1"))
}

/// Returns the ids of the living processes that work in a folder.
fn alive(sandbox: &Sandbox) -> Vec<String> {
    let folder = fs::canonicalize(sandbox.path()).expect("a folder");
    let processes = fs::read_dir("/proc").expect("processes").flatten();
    let here = processes.filter(|process| fs::read_link(process.path().join("cwd")).is_ok_and(|cwd| cwd == folder));
    here.map(|process| process.file_name().to_string_lossy().into_owned()).collect()
}

/// Asserts that no process works in a folder, and that no temporary file is there.
#[track_caller]
pub(super) fn assert_nothing_is_left(sandbox: &Sandbox, driver: &str) {
    assert_eq!(alive(sandbox), Vec::<String>::new(), "{driver}");
    let temporary = sandbox.listing().into_iter().find(|(path, _)| path.to_string_lossy().contains(".mindgap-"));
    assert_eq!(temporary.map(|(path, _)| path), None, "{driver}");
}

#[test]
fn nothing_that_a_driver_started_outlives_the_loop() {
    let planned = planned();
    let late = "took longer than 1 s and was ended";
    let cases = [
        (STUBBORN, late),
        (POLITE, late),
        ("sleep 90 & exit 0", "was not written by the robot"),
        ("setsid sh -c 'trap \"\" TERM HUP; sleep 90; :' & sleep 90", late),
        ("setsid env -i sleep 90 & sleep 0.2; exit 4", "failed: exit status: 4"),
        ("(trap '' TERM; while :; do sh -c 'sleep 90; :' & sleep 0.1; done) & sleep 90", late),
        ("kill -STOP $$", late),
        ("mkfifo \"$4\"", "is not a regular file"),
        ("mkfifo \"$4\"; (echo t_ms > \"$4\") &", "is not a regular file"),
        ("mkfifo \"$4\"; cat sim.json > \"$4\"", late),
        ("ln -s /dev/zero \"$4\"", "is not a regular file"),
        ("ln -s \"$PWD/out/loop.json\" \"$4\"", "is not a regular file"),
        ("mkdir \"$4\"", "is not a regular file"),
        ("truncate -s 1T \"$4\"", "is larger than 32 MB"),
        ("head -c 9000000 /dev/zero > \"$4\"", "trial-1-attempt-2.csv:1: a line of more than 1 MB"),
    ];
    thread::scope(|scope| {
        for (driver, problem) in cases {
            let sandbox = planned.copy();
            scope.spawn(move || {
                sandbox.write("robot.sh", driver);
                let outcome = looping(&sandbox);
                assert_eq!((outcome.code, outcome.out.as_str()), (1, ""), "{driver}: {}", outcome.err);
                assert!(outcome.err.contains(problem), "{driver}: {}", outcome.err);
                assert!(outcome.err.contains("trial 1 failed 2 times, loop stopped"), "{driver}: {}", outcome.err);
                assert_nothing_is_left(&sandbox, driver);
                assert!(sandbox.json("out/loop.json")["trials"][0]["real"].is_null(), "{driver}");
                if driver == POLITE {
                    assert!(sandbox.path().join("stopped").exists(), "the motors had time to stop");
                }
            });
        }
    });
}

/// The first attempt leaves a process that writes a good log during the second, which writes none.
#[test]
fn a_late_log_is_not_taken_for_that_of_another_attempt() {
    let sandbox = planned();
    robot(&sandbox, "", "");
    fs::rename(sandbox.path().join("robot.sh"), sandbox.path().join("good.sh")).expect("a file");
    let first = "(sleep 1; sh good.sh \"$@\") & setsid sh -c 'sleep 1; sh good.sh \"$@\"' sh \"$@\" & exit 1";
    let second = "sleep 3; cp out/*attempt-1.csv \"$4\" 2> /dev/null; ls -d \"${4%/*}\"/*; exit 0";
    sandbox.write("robot.sh", format!("if test -e again; then {second}; fi\ntouch again\n{first}\n"));
    let outcome = sandbox.execute(command(&sandbox, "--robot-timeout 9"));
    assert!(outcome.err.contains("out/trial-1-attempt-2.csv: was not written by the robot"), "{}", outcome.err);
    assert_nothing_is_left(&sandbox, "late");
}

#[test]
fn a_signal_ends_the_driver_too() {
    let planned = planned();
    for (signal, number) in [("TERM", 15), ("INT", 2), ("HUP", 1), ("QUIT", 3)] {
        let sandbox = planned.copy();
        let mut child = driving(&sandbox, POLITE);
        kill(child.id(), signal);
        assert_eq!(child.wait().expect("it ends").signal(), Some(number), "{signal}");
        assert!(sandbox.path().join("stopped").exists(), "{signal}: the motors had time to stop");
        assert_nothing_is_left(&sandbox, signal);
    }
}

#[test]
fn a_second_signal_ends_the_driver_at_once() {
    let sandbox = planned();
    let mut child = driving(&sandbox, STUBBORN);
    let begun = Instant::now();
    kill(child.id(), "INT");
    thread::sleep(Duration::from_millis(300));
    kill(child.id(), "INT");
    child.wait().expect("it ends");
    assert!(begun.elapsed() < Duration::from_secs(2), "{:?}", begun.elapsed());
    assert_nothing_is_left(&sandbox, "hurried");
}

#[test]
fn a_loop_under_nohup_ignores_the_end_of_its_terminal() {
    let sandbox = planned();
    sandbox.write("robot.sh", STUBBORN);
    let mut shell = Command::new("nohup");
    let loops = command(&sandbox, "--robot-timeout 60");
    shell.arg(loops.get_program()).args(loops.get_args()).current_dir(sandbox.path());
    let mut child = begun(&sandbox, shell);
    kill(child.id(), "HUP");
    thread::sleep(Duration::from_millis(300));
    assert!(child.try_wait().expect("a child").is_none());
    kill(child.id(), "TERM");
    child.wait().expect("it ends");
}

/// A folder belongs to one loop, and to the driver of a killed one for as long as that drives.
#[test]
fn a_second_loop_in_a_folder_is_refused() {
    let sandbox = planned();
    let mut child = driving(&sandbox, STUBBORN);
    let refused = || {
        let problem = looping(&sandbox).err;
        assert!(problem.starts_with("mindgap: out: is in use by another process"), "{problem}");
        assert_eq!(problem.lines().count(), 1, "{problem}");
    };
    refused();
    kill(child.id(), "KILL");
    child.wait().expect("it ends");
    refused();
    kill(sandbox.text("begun").trim(), "KILL");
    while !alive(&sandbox).is_empty() {
        thread::sleep(Duration::from_millis(20));
    }
    sandbox.write("robot.sh", "exit 3\n");
    assert!(looping(&sandbox).err.contains("failed: exit status: 3"));
}

#[test]
fn words_of_the_command_may_contain_blanks() {
    let sandbox = planned();
    robot(&sandbox, "", "");
    fs::rename(sandbox.path().join("robot.sh"), sandbox.path().join("my robot.sh")).expect("a file");
    let mut command = sandbox.command(LOOP);
    command.args(["--robot", "sh 'my robot.sh'"]);
    let outcome = sandbox.execute(command);
    assert_eq!(outcome.code, 0, "{}", outcome.err);
    assert!(sandbox.path().join("out/trial-1.csv").exists());
    for (command, problem) in [("sh 'robot.sh", "has an open quote"), ("''", "cannot be started"), (" ", "is empty")] {
        let sandbox = planned();
        let mut call = sandbox.command(LOOP);
        call.args(["--robot", command]);
        let outcome = sandbox.execute(call);
        assert!(outcome.code == 1 && outcome.err.contains(problem), "{command}: {}", outcome.err);
    }
}

/// A folder from elsewhere cannot make the loop read or write outside it.
#[test]
fn files_of_a_loop_lie_in_its_folder() {
    let planned = planned();
    planned.write("private", "private");
    for name in ["../private", "/etc/passwd", "sub/trial-1.csv", "loop.json", ""] {
        for field in ["controller", "log"] {
            let sandbox = planned.copy();
            sandbox.edit("out/loop.json", |text| {
                let mut state: serde_json::Value = serde_json::from_str(&text).expect("JSON");
                state["trials"][0][field] = name.into();
                state.to_string()
            });
            let problem = sandbox.refused(&format!("{LOOP} --robot none"));
            assert!(problem.starts_with("out/loop.json: trial 1: its files must be trial-1.toml"), "{problem}");
        }
    }
    for name in ["loop.json", "trial-1.toml", "trial-1-attempt-1.csv", "trial-1.csv"] {
        let sandbox = planned.copy();
        robot(&sandbox, "", "");
        // Without the file there is nothing to remove.
        let _ = fs::remove_file(sandbox.path().join("out").join(name));
        symlink("../private", sandbox.path().join("out").join(name)).expect("a link");
        let outcome = sandbox.execute(command(&sandbox, ""));
        assert!(outcome.code == 1 && outcome.err.contains(&format!("out/{name}: is a link")), "{}", outcome.err);
        assert_eq!(sandbox.text("private"), "private");
    }
}

/// Starts a loop and waits until its driver drives.
fn driving(sandbox: &Sandbox, driver: &str) -> Child {
    sandbox.write("robot.sh", driver);
    begun(sandbox, command(sandbox, "--robot-timeout 60"))
}

fn begun(sandbox: &Sandbox, mut command: Command) -> Child {
    let child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("it starts");
    let begun = Instant::now();
    while !sandbox.path().join("begun").exists() {
        assert!(begun.elapsed() < Duration::from_secs(60), "nothing drives");
        thread::sleep(Duration::from_millis(20));
    }
    child
}
