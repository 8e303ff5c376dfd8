//! `mindgap bundle`: what is sent when a diagnosis seems wrong.

use std::fs;
use std::io::Read;

use flate2::read::DeflateDecoder;
use mindgap_tests::command::Sandbox;
use mindgap_tests::rooms::trained;
use rawzip::ZipArchive;

use super::schemas::is_described;

/// A name in the names and texts of files, which must not be in a bundle.
const NAME: &str = "annabot";

/// Returns a folder with a simulator and named logs of a robot that covers less ground.
fn named() -> Sandbox {
    let sandbox = trained();
    sandbox.run("record --out worn --runs 8 --steps 40 --effect drive_scale=0.85 --seed 9");
    name(&sandbox, "worn", 8);
    sandbox
}

/// Names everything in a folder of logs that can have a name.
fn name(sandbox: &Sandbox, folder: &str, runs: usize) {
    for file in ["robot.toml", "scene.toml"] {
        sandbox.edit(&format!("{folder}/{file}"), |text| format!("# {NAME}'s\n{text}# {NAME}\n"));
    }
    for run in 0..runs {
        let path = format!("{folder}/run-{run:03}.csv");
        sandbox.edit(&path, |text| {
            let lines = text.lines().enumerate();
            lines.map(|(k, line)| format!("{line},{}\n", if k == 0 { "by_annabot" } else { NAME })).collect()
        });
        let named = sandbox.path().join(folder).join(format!("run-{run}-{NAME}.csv"));
        fs::rename(sandbox.path().join(path), named).expect("such a name is possible");
    }
    sandbox.write(&format!("{folder}/{NAME}.txt"), NAME);
    fs::rename(sandbox.path().join(folder), sandbox.path().join(format!("{folder}-{NAME}"))).expect("a folder");
}

/// Unpacks a bundle into a new folder.
fn unpacked(bundle: &[u8]) -> Sandbox {
    let to = Sandbox::new();
    let archive = ZipArchive::from_slice(bundle).expect("an archive");
    let mut entries = archive.entries();
    while let Some(entry) = entries.next_entry().expect("a file") {
        let name = entry.file_path().try_normalize().expect("a path").as_ref().to_owned();
        let found = archive.get_entry(entry.wayfinder()).expect("a file");
        let mut bytes = Vec::new();
        let mut content = found.verifying_reader(DeflateDecoder::new(found.data()));
        content.read_to_end(&mut bytes).expect("its bytes");
        let path = to.path().join(&name);
        fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
        to.write(&name, bytes);
    }
    to
}

/// Expects that no file has the name, in its path or in its content.
fn assert_nameless(bundle: &Sandbox) {
    for (path, bytes) in bundle.files("") {
        let has_name = |text: &str| text.to_lowercase().contains(NAME);
        assert!(!has_name(&path.to_string_lossy()), "{}", path.display());
        assert!(!has_name(&String::from_utf8(bytes).expect("text")), "{}", path.display());
    }
}

/// Diagnoses an unpacked bundle again, by the command that it states, and expects the same answer.
fn assert_same_answer(bundle: &Sandbox) {
    let about = bundle.json("mindgap-bundle.json");
    let command = about["command"].as_str().expect("a command").strip_prefix("mindgap ").expect("of mindgap");
    bundle.run(command);
    assert_eq!(bundle.text("again.json"), bundle.text("diagnosis.json"));
}

#[test]
fn a_bundle_has_no_names_and_gives_the_same_answer_again() {
    let sandbox = named();
    let folder = format!("worn-{NAME}");
    for (against, files) in [("sim.json", 13), ("kinematic", 12)] {
        sandbox.run(&format!("bundle {against} {folder} --out wrong.zip --seed 3"));
        let bundle = unpacked(&sandbox.bytes("wrong.zip"));
        assert_nameless(&bundle);
        is_described(&bundle, "bundle", "mindgap-bundle.json");
        assert_eq!(bundle.files("").len(), files, "{against}");
        assert!(bundle.text("logs/run-007.csv").starts_with("t_ms,left,right,x_cm,y_cm,heading_deg,echo_cm"));
        assert_same_answer(&bundle);
        // The original gives the same, apart from names.
        sandbox.run(&format!("diagnose {against} {folder} --seed 3 --json named.json"));
        assert_eq!(sandbox.json("named.json")["effects"], bundle.json("diagnosis.json")["effects"]);
    }
}

#[test]
fn sessions_and_their_conditions_are_numbered() {
    let sandbox = trained();
    for (seed, day, effect) in [(11, "one", ""), (12, "two", "--effect track_width=0.8"), (13, "three", "")] {
        sandbox.run(&format!("record --out {day} --runs 6 --steps 40 --seed {seed} {effect}"));
        sandbox.edit(&format!("{day}/robot.toml"), |text| format!("# {NAME}\n{text}"));
        sandbox.write(&format!("{day}/session.toml"), format!("{NAME} = \"{NAME} {day}\"\nload_g = 20\n"));
    }
    sandbox.run("bundle sim.json one two three --out wrong.zip");
    let bundle = unpacked(&sandbox.bytes("wrong.zip"));
    assert_nameless(&bundle);
    assert_eq!(bundle.text("logs-1/session.toml"), "condition-1 = \"value-1\"\ncondition-2 = 20\n");
    assert_same_answer(&bundle);
}

#[test]
fn the_same_logs_give_the_same_bytes_and_only_a_bundle_is_replaced() {
    let sandbox = trained();
    let call = "bundle sim.json logs --out wrong.zip";
    let bytes = |threads: usize| {
        assert_eq!(sandbox.call_on_threads(threads, call).code, 0);
        sandbox.bytes("wrong.zip")
    };
    assert!(bytes(1) == bytes(2), "bytes depend on the number of threads");
    sandbox.write("wrong.zip", b"PK\x03\x04 an archive of photos");
    let refusal = sandbox.refused(call);
    assert!(refusal.contains("already exists and is not a bundle that mindgap wrote"), "{refusal}");
}

#[test]
fn bad_input_leaves_no_bundle() {
    let sandbox = trained();
    sandbox.edit("logs/run-003.csv", |text| text.replacen("0,", "zero,", 1));
    assert!(sandbox.refused("bundle sim.json logs --out wrong.zip").contains("run-003.csv:2"));
    assert!(sandbox.refused("bundle sim.json nowhere --out wrong.zip").contains("nowhere"));
    assert!(sandbox.refused("bundle missing.json logs --out wrong.zip").contains("missing.json"));
}
