//! Outputs replace only files that mindgap wrote, and are written in place to pipes, links and devices.

use std::fs;
use std::os::unix::fs::{PermissionsExt, symlink};
use std::process::{Command, Stdio};
use std::thread;

use mindgap_tests::command::Sandbox;
use mindgap_tests::rooms::trained;

/// Expects a call to be refused without `--force` and to succeed with it.
fn only_with_force(sandbox: &Sandbox, call: &str, why: &str) {
    let refusal = sandbox.refused(call);
    assert!(refusal.contains(why) && refusal.ends_with("--force replaces it"), "{call}: {refusal}");
    sandbox.run(&format!("{call} --force"));
}

#[test]
fn existing_logs_are_replaced_only_by_force() {
    let sandbox = Sandbox::with_logs();
    sandbox.write("logs/diary.txt", "dear diary");
    only_with_force(&sandbox, "record --out logs --runs 2 --steps 5", ": give an empty or new folder");
    assert_eq!(sandbox.text("logs/diary.txt"), "dear diary", "what is not ours stays even then");
    assert!(!sandbox.path().join("logs/run-002.csv").exists(), "what was recorded before does not");
    fs::create_dir(sandbox.path().join("empty")).unwrap();
    sandbox.run("record --out empty --runs 2 --steps 5");
}

#[test]
fn an_answered_challenge_is_not_replaced() {
    let sandbox = Sandbox::new();
    fs::create_dir_all(sandbox.path().join("blind/answers")).unwrap();
    sandbox.write("blind/answers/000.json", "{}");
    for call in ["challenge make --cases 1 --out blind", "challenge answer blind", "demo --out blind"] {
        assert!(sandbox.refused(call).contains(": give an empty or new folder"), "{call}");
    }
}

#[test]
fn a_file_is_replaced_only_by_its_own_kind() {
    let sandbox = trained();
    let learned = sandbox.bytes("sim.json");
    sandbox.run("train logs --out sim.json");
    assert!(sandbox.bytes("sim.json") == learned);
    sandbox.write("empty.json", "");
    sandbox.run("train logs --out empty.json");

    sandbox.run("evaluate sim.json logs --json figures.json");
    sandbox.run("evaluate sim.json logs --json figures.json");
    sandbox.write("notes.txt", "my notes");
    sandbox.write("photo.png", b"\x89PNG\r\n\x1a\n");
    for file in ["notes.txt", "photo.png", "figures.json", "logs/run-000.csv", "logs/robot.toml"] {
        let refusal = sandbox.refused(&format!("train logs --out {file}"));
        assert!(refusal.contains("already exists and is not a simulator that mindgap wrote"), "{refusal}");
    }
    only_with_force(&sandbox, "train logs --out notes.txt", "is not a simulator");
    sandbox.run("check logs --json figures.json");
    only_with_force(&sandbox, "check logs --json sim.json", "is not a report that mindgap wrote");
}

/// A handwritten program lacks the mark of mindgap.
#[test]
fn a_handwritten_file_is_replaced_only_by_force() {
    let sandbox = Sandbox::new();
    let tuple = "  { left = 55, right = 48, when = \"larger\", threshold_cm = 42 },\n";
    sandbox.write("c.toml", format!("step_ms = 400\nmax_steps = 10\ntuple = [\n{}]\n", tuple.repeat(6)));
    sandbox.write("c.nxc", "// My own program.\n");
    only_with_force(&sandbox, "export c.toml --format nxc --out c.nxc", "is not a program that mindgap wrote");
    for format in ["nxc", "rust", "c", "rxe", "nxc-collect"] {
        let input = if format == "nxc-collect" { "" } else { "c.toml" };
        (0..2).for_each(|_| drop(sandbox.run(&format!("export {input} --format {format} --out p.{format}"))));
    }
}

#[test]
fn an_output_may_not_be_an_input_or_another_output() {
    let sandbox = trained();
    let refusal = sandbox.refused("diagnose sim.json logs --apply sim.json");
    assert!(refusal.starts_with("sim.json: is read by the same command"), "{refusal}");
    let refusal = sandbox.refused("diagnose kinematic logs --json d --html ./d --force");
    assert_eq!(refusal, "./d: is given for two outputs: give each its own path");
}

#[test]
fn outputs_are_checked_before_work_begins() {
    let sandbox = Sandbox::new();
    // The missing logs would be reported next.
    let refusal = sandbox.refused("train nothing --out nowhere/sim.json");
    assert_eq!(refusal, "nowhere/sim.json: cannot be written: there is no folder nowhere");
    fs::create_dir(sandbox.path().join("folder")).unwrap();
    let refusal = sandbox.refused("train nothing --out folder");
    assert_eq!(refusal, "folder: cannot be written: a folder of that name exists");
}

#[test]
fn links_and_file_modes_are_kept() {
    let sandbox = Sandbox::with_logs();
    let at = |name: &str| sandbox.path().join(name);
    let mode = |name: &str| fs::metadata(at(name)).unwrap().permissions().mode() & 0o777;
    sandbox.run("check logs --json check.json");
    fs::set_permissions(at("check.json"), fs::Permissions::from_mode(0o604)).unwrap();
    symlink("check.json", at("link.json")).unwrap();
    let before = sandbox.text("check.json");
    sandbox.edit("check.json", |text| text + " \n");
    sandbox.run("check logs --json link.json");
    assert!(at("link.json").is_symlink() && sandbox.text("check.json") == before);
    assert_eq!(mode("check.json"), 0o604);

    let call = sandbox.command("");
    let under_mask = format!("umask 027; {} check logs --json masked.json", call.get_program().display());
    let outcome = Command::new("sh").current_dir(sandbox.path()).args(["-c", &under_mask]).output().unwrap();
    assert!(outcome.status.success());
    assert_eq!(mode("masked.json"), 0o640);
}

#[test]
fn pipes_and_devices_are_written_in_place() {
    let sandbox = Sandbox::with_logs();
    sandbox.run("check logs --json check.json");
    let check = sandbox.text("check.json");
    for place in ["-", "/dev/stdout"] {
        assert_eq!(sandbox.run(&format!("check logs --json {place}")), check, "{place}");
    }
    sandbox.run("check logs --json /dev/null");
    assert!(!fs::metadata("/dev/null").unwrap().is_file());

    let pipe = sandbox.path().join("pipe");
    assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    let reader = thread::spawn({
        let pipe = pipe.clone();
        move || fs::read_to_string(pipe).unwrap()
    });
    let mut writing = sandbox.command("check logs --json pipe").stdout(Stdio::null()).spawn().unwrap();
    assert_eq!(reader.join().unwrap(), check);
    assert!(writing.wait().unwrap().success() && !fs::metadata(&pipe).unwrap().is_file());
    fs::remove_file(pipe).unwrap();
}

#[test]
fn a_closed_standard_error_stops_nothing() {
    let sandbox = Sandbox::with_logs();
    sandbox.edit("logs/run-000.csv", |text| text.replacen("battery_mv", "mood", 1));
    let mut command = sandbox.command("train logs --out sim.json");
    let mut child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    drop(child.stderr.take());
    assert_eq!(child.wait().unwrap().code(), Some(0));
    assert!(sandbox.path().join("sim.json").is_file());
}
