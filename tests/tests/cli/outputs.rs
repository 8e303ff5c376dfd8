//! Nothing is lost: what a command writes replaces only what mindgap made, and goes where it is sent.

use std::fs;
use std::os::unix::fs::{PermissionsExt, symlink};
use std::process::{Command, Stdio};
use std::thread;

use mindgap_tests::command::Workshop;
use mindgap_tests::rooms::trained;

/// Expects that a call is refused without `--force` and done with it.
fn only_with_force(workshop: &Workshop, call: &str, why: &str) {
    let refusal = workshop.refused(call);
    assert!(refusal.contains(why) && refusal.ends_with("--force replaces it"), "{call}: {refusal}");
    workshop.done(&format!("{call} --force"));
}

#[test]
fn logs_are_not_recorded_over() {
    let workshop = Workshop::with_logs();
    workshop.write("logs/diary.txt", "dear diary");
    only_with_force(&workshop, "record --out logs --runs 2 --steps 5", ": give an empty or new folder");
    assert_eq!(workshop.text("logs/diary.txt"), "dear diary", "what is not ours stays even then");
    assert!(!workshop.path().join("logs/run-002.csv").exists(), "what was recorded before does not");
    fs::create_dir(workshop.path().join("empty")).unwrap();
    workshop.done("record --out empty --runs 2 --steps 5");
}

#[test]
fn answers_are_not_lost_with_their_challenge() {
    let workshop = Workshop::new();
    fs::create_dir_all(workshop.path().join("blind/answers")).unwrap();
    workshop.write("blind/answers/000.json", "{}");
    for call in ["challenge make --cases 1 --out blind", "challenge answer blind", "demo --out blind"] {
        assert!(workshop.refused(call).contains(": give an empty or new folder"), "{call}");
    }
}

#[test]
fn a_file_is_replaced_by_its_own_kind_alone() {
    let workshop = trained();
    let learned = workshop.bytes("sim.json");
    workshop.done("train logs --out sim.json");
    assert!(workshop.bytes("sim.json") == learned);
    workshop.write("empty.json", "");
    workshop.done("train logs --out empty.json");

    workshop.done("evaluate sim.json logs --json figures.json");
    workshop.done("evaluate sim.json logs --json figures.json");
    workshop.write("notes.txt", "my notes");
    workshop.write("photo.png", b"\x89PNG\r\n\x1a\n");
    for file in ["notes.txt", "photo.png", "figures.json", "logs/run-000.csv", "logs/robot.toml"] {
        let refusal = workshop.refused(&format!("train logs --out {file}"));
        assert!(refusal.contains("already exists and is not a simulator that mindgap wrote"), "{refusal}");
    }
    only_with_force(&workshop, "train logs --out notes.txt", "is not a simulator");
    workshop.done("check logs --json figures.json");
    only_with_force(&workshop, "check logs --json sim.json", "is not a report that mindgap wrote");
}

/// A controller that somebody wrote by hand says nothing of where it came from.
#[test]
fn what_is_written_by_hand_is_kept() {
    let workshop = Workshop::new();
    let tuple = "  { left = 55, right = 48, when = \"larger\", threshold_cm = 42 },\n";
    workshop.write("c.toml", format!("step_ms = 400\nmax_steps = 10\ntuple = [\n{}]\n", tuple.repeat(6)));
    workshop.write("c.nxc", "// My own program.\n");
    only_with_force(&workshop, "export c.toml --format nxc --out c.nxc", "is not a program that mindgap wrote");
    for format in ["nxc", "rust", "c", "rxe", "nxc-collect"] {
        let input = if format == "nxc-collect" { "" } else { "c.toml" };
        (0..2).for_each(|_| drop(workshop.done(&format!("export {input} --format {format} --out p.{format}"))));
    }
}

#[test]
fn an_input_is_no_output_and_no_place_is_two() {
    let workshop = trained();
    let refusal = workshop.refused("diagnose sim.json logs --apply sim.json");
    assert!(refusal.starts_with("sim.json: is read by the same command"), "{refusal}");
    let refusal = workshop.refused("diagnose kinematic logs --json d --html ./d --force");
    assert_eq!(refusal, "./d: is given for two outputs: give each its own path");
}

#[test]
fn places_are_looked_at_before_work_begins() {
    let workshop = Workshop::new();
    // The logs would be missed next.
    let refusal = workshop.refused("train nothing --out nowhere/sim.json");
    assert_eq!(refusal, "nowhere/sim.json: cannot be written: there is no folder nowhere");
    fs::create_dir(workshop.path().join("folder")).unwrap();
    let refusal = workshop.refused("train nothing --out folder");
    assert_eq!(refusal, "folder: cannot be written: a folder of that name exists");
}

#[test]
fn links_stay_and_modes_too() {
    let workshop = Workshop::with_logs();
    let at = |name: &str| workshop.path().join(name);
    let mode = |name: &str| fs::metadata(at(name)).unwrap().permissions().mode() & 0o777;
    workshop.done("check logs --json check.json");
    fs::set_permissions(at("check.json"), fs::Permissions::from_mode(0o604)).unwrap();
    symlink("check.json", at("link.json")).unwrap();
    let before = workshop.text("check.json");
    workshop.edit("check.json", |text| text + " \n");
    workshop.done("check logs --json link.json");
    assert!(at("link.json").is_symlink() && workshop.text("check.json") == before);
    assert_eq!(mode("check.json"), 0o604);

    let call = workshop.command("");
    let under_mask = format!("umask 027; {} check logs --json masked.json", call.get_program().display());
    let done = Command::new("sh").current_dir(workshop.path()).args(["-c", &under_mask]).output().unwrap();
    assert!(done.status.success());
    assert_eq!(mode("masked.json"), 0o640);
}

#[test]
fn streams_are_written_as_they_stand() {
    let workshop = Workshop::with_logs();
    workshop.done("check logs --json check.json");
    let check = workshop.text("check.json");
    for place in ["-", "/dev/stdout"] {
        assert_eq!(workshop.done(&format!("check logs --json {place}")), check, "{place}");
    }
    workshop.done("check logs --json /dev/null");
    assert!(!fs::metadata("/dev/null").unwrap().is_file());

    let pipe = workshop.path().join("pipe");
    assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    let reader = thread::spawn({
        let pipe = pipe.clone();
        move || fs::read_to_string(pipe).unwrap()
    });
    let mut writing = workshop.command("check logs --json pipe").stdout(Stdio::null()).spawn().unwrap();
    assert_eq!(reader.join().unwrap(), check);
    assert!(writing.wait().unwrap().success() && !fs::metadata(&pipe).unwrap().is_file());
    fs::remove_file(pipe).unwrap();
}

#[test]
fn nobody_at_standard_error_ends_nothing() {
    let workshop = Workshop::with_logs();
    workshop.edit("logs/run-000.csv", |text| text.replacen("battery_mv", "mood", 1));
    let mut command = workshop.command("train logs --out sim.json");
    let mut child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    drop(child.stderr.take());
    assert_eq!(child.wait().unwrap().code(), Some(0));
    assert!(workshop.path().join("sim.json").is_file());
}
