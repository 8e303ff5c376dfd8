//! What the command tells of itself and of files: help, completions, manual pages, `mindgap info`.

use std::process::Command;

use mindgap_tests::command::Workshop;
use mindgap_tests::faults::{MOTION, SONAR};
use mindgap_tests::rooms::{trained, with_scene};

#[test]
fn help_lists_the_commands_in_the_order_of_work_with_examples() {
    let workshop = Workshop::new();
    let help = workshop.done("--help");
    let place = |word: &str| help.find(word).unwrap_or_else(|| panic!("{word} is missing in\n{help}"));
    let order =
        ["\n  demo", "\nLogs:", "\n  record", "\n  train", "\n  evolve", "\n  export", "\n  diagnose", "\n  info"];
    assert!(order.map(place).is_sorted(), "{help}");
    let diagnose = workshop.done("diagnose --help");
    assert!(diagnose.contains("mindgap diagnose kinematic logs"), "{diagnose}");
}

#[test]
fn files_that_it_writes_are_told() {
    let workshop = with_scene();
    workshop.done("diagnose sim.json logs --json diagnosis.json --html page.html");
    workshop.done("evaluate sim.json logs --json evaluation.json");
    let seed = u64::MAX;
    workshop.done(&format!("evolve sim.json --scene scene.toml --out controller.toml --max-steps 6 --seed {seed}"));
    for (format, ending) in [("arduino", "ino"), ("pybricks", "py"), ("rxe", "rxe")] {
        workshop.done(&format!("export controller.toml --format {format} --out drive.{ending}"));
    }
    workshop.done("manual --out man");
    for (path, what) in [
        ("sim.json", "a simulator, trained (fast) on 6 runs"),
        ("logs", "logs of 6 runs, 156 rows"),
        ("logs/run-000.csv", "a run of 26 rows"),
        ("logs/robot.toml", "a robot with a track of"),
        ("scene.toml", "a scene with 1 obstacle, 0 bare walls, a target and 2 starts"),
        ("diagnosis.json", "a diagnosis: `mindgap diagnose --json`, verdict "),
        ("evaluation.json", "an evaluation"),
        ("page.html", "a page"),
        ("controller.toml", "a controller, 400 ms per step, at most 6 steps; evolved in sim.json for start 1"),
        ("drive.ino", "an onboard program for an Arduino"),
        ("drive.py", "an onboard program for Pybricks"),
        ("drive.rxe", "an onboard program for an NXT"),
        ("man", "manual pages"),
    ] {
        let told = workshop.done(&format!("info {path}"));
        assert!(told.starts_with(&format!("{path}: {what}")), "{told}");
    }
    workshop.write("other.json", "{}");
    assert!(workshop.refused("info other.json").contains("unrecognised JSON"));
    assert!(workshop.refused("info missing.nxc").contains("cannot be read"));
}

#[test]
fn completions_and_manual_pages_know_the_options() {
    let workshop = Workshop::new();
    for shell in ["bash", "zsh", "fish"] {
        assert!(workshop.done(&format!("completions {shell}")).contains("diagnose"), "{shell}");
    }
    workshop.write("mindgap.bash", workshop.done("completions bash"));
    let mut bash = Command::new("bash");
    bash.current_dir(workshop.path());
    bash.args([
        "-c",
        ". ./mindgap.bash && COMP_WORDS=(mindgap diagnose --ht) COMP_CWORD=2 && _mindgap mindgap --ht diagnose && echo $COMPREPLY",
    ]);
    assert_eq!(workshop.run(bash).out, "--html\n", "what bash makes of --ht");
    workshop.done("manual --out man");
    assert!(workshop.text("man/mindgap.1").contains("demo"));
    assert!(workshop.text("man/mindgap-diagnose.1").contains("html"));
}

#[test]
fn what_is_misspelt_is_put_right() {
    let workshop = Workshop::new();
    for (wrong, right) in [("diagnoes", "diagnose"), ("train --ouut x", "--out")] {
        let done = workshop.call(wrong);
        assert_eq!(done.code, 2);
        assert!(done.err.contains(right), "{}", done.err);
    }
}

#[test]
fn figures_are_written_as_svg_and_png() {
    let workshop = with_scene();
    workshop.done("evaluate sim.json logs --figures drawn/networks");
    workshop.done("evolve sim.json --scene scene.toml --out controller.toml --max-steps 6 --figures drawn/evolved");
    workshop.done("simulate sim.json controller.toml --scene scene.toml --figures drawn/simulated");
    for figure in [
        "networks/figure-2-expected-against-predicted",
        "networks/figure-3-sonar-surfaces",
        "evolved/figure-4-simulated-and-real-paths",
        "simulated/figure-4-simulated-and-real-paths",
    ] {
        assert!(workshop.text(&format!("drawn/{figure}.svg")).starts_with("<svg"), "{figure}");
        assert!(workshop.bytes(&format!("drawn/{figure}.png")).starts_with(b"\x89PNG"), "{figure}");
    }
}

#[test]
fn a_page_that_cannot_be_written_is_one_line() {
    let workshop = trained();
    assert!(workshop.refused("evaluate sim.json logs --html nowhere/page.html").contains("nowhere/page.html"));
}

#[test]
fn effects_findings_and_verdicts_are_explained() {
    let workshop = Workshop::new();
    let payload = workshop.done("explain payload");
    for part in [
        "payload (effect)",
        "  in logs ",
        "  imitated by   motor_asymmetry",
        "  check ",
        "  variant       command: loss",
    ] {
        assert!(payload.contains(part), "{part}: {payload}");
    }
    for id in MOTION.iter().chain(&SONAR).map(|fault| fault.id).chain(["scatter", "no_gap", "partly_known"]) {
        assert!(workshop.done(&format!("explain {id}")).starts_with(&format!("{id} (")), "{id}");
    }
    assert!(workshop.done("explain").starts_with("effects: battery_sag, "));
    let refusal = workshop.refused("explain payloads");
    assert_eq!(refusal, "payloads is not an effect, finding or verdict; did you mean payload?");
}
