//! Help, completions, manual pages, and what `mindgap info` says about files.

use std::process::Command;

use mindgap_tests::command::Sandbox;
use mindgap_tests::faults::{MOTION, SONAR};
use mindgap_tests::rooms::{trained, with_scene};

#[test]
fn help_lists_the_commands_in_the_order_of_use() {
    let sandbox = Sandbox::new();
    let help = sandbox.run("--help");
    let place = |word: &str| help.find(word).unwrap_or_else(|| panic!("{word} is missing in\n{help}"));
    let order =
        ["\n  demo", "\nLogs:", "\n  record", "\n  train", "\n  evolve", "\n  export", "\n  diagnose", "\n  info"];
    assert!(order.map(place).is_sorted(), "{help}");
    let diagnose = sandbox.run("diagnose --help");
    assert!(diagnose.contains("mindgap diagnose kinematic logs"), "{diagnose}");
}

#[test]
fn info_recognises_the_files_that_are_written() {
    let sandbox = with_scene();
    sandbox.run("diagnose sim.json logs --json diagnosis.json --html page.html");
    sandbox.run("evaluate sim.json logs --json evaluation.json");
    let seed = u64::MAX;
    sandbox
        .run(&format!("evolve sim.json --scene scene.toml --out controller.toml --max-steps 6 --paper --seed {seed}"));
    for (format, ending) in [("arduino", "ino"), ("pybricks", "py"), ("rxe", "rxe")] {
        sandbox.run(&format!("export controller.toml --format {format} --out drive.{ending}"));
    }
    sandbox.run("manual --out man");
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
        let output = sandbox.run(&format!("info {path}"));
        assert!(output.starts_with(&format!("{path}: {what}")), "{output}");
    }
    sandbox.write("other.json", "{}");
    assert!(sandbox.refused("info other.json").contains("unrecognised JSON"));
    assert!(sandbox.refused("info missing.nxc").contains("cannot be read"));
}

#[test]
fn completions_and_manual_pages_know_the_options() {
    let sandbox = Sandbox::new();
    for shell in ["bash", "zsh", "fish"] {
        assert!(sandbox.run(&format!("completions {shell}")).contains("diagnose"), "{shell}");
    }
    sandbox.write("mindgap.bash", sandbox.run("completions bash"));
    let mut bash = Command::new("bash");
    bash.current_dir(sandbox.path());
    bash.args([
        "-c",
        ". ./mindgap.bash && COMP_WORDS=(mindgap diagnose --ht) COMP_CWORD=2 && _mindgap mindgap --ht diagnose && echo $COMPREPLY",
    ]);
    assert_eq!(sandbox.execute(bash).out, "--html\n", "what bash makes of --ht");
    sandbox.run("manual --out man");
    assert!(sandbox.text("man/mindgap.1").contains("demo"));
    assert!(sandbox.text("man/mindgap-diagnose.1").contains("html"));
}

#[test]
fn misspelt_commands_and_options_get_a_suggestion() {
    let sandbox = Sandbox::new();
    for (wrong, right) in [("diagnoes", "diagnose"), ("train --ouut x", "--out")] {
        let outcome = sandbox.call(wrong);
        assert_eq!(outcome.code, 2);
        assert!(outcome.err.contains(right), "{}", outcome.err);
    }
}

#[test]
fn figures_are_written_as_svg_and_png() {
    let sandbox = with_scene();
    sandbox.run("evaluate sim.json logs --figures drawn/networks");
    sandbox.run("evolve sim.json --scene scene.toml --out controller.toml --max-steps 6 --figures drawn/evolved");
    sandbox.run("simulate sim.json controller.toml --scene scene.toml --figures drawn/simulated");
    for figure in [
        "networks/figure-2-expected-against-predicted",
        "networks/figure-3-sonar-surfaces",
        "evolved/figure-4-simulated-and-real-paths",
        "simulated/figure-4-simulated-and-real-paths",
    ] {
        assert!(sandbox.text(&format!("drawn/{figure}.svg")).starts_with("<svg"), "{figure}");
        assert!(sandbox.bytes(&format!("drawn/{figure}.png")).starts_with(b"\x89PNG"), "{figure}");
    }
}

#[test]
fn a_page_that_cannot_be_written_is_reported_in_one_line() {
    let sandbox = trained();
    assert!(sandbox.refused("evaluate sim.json logs --html nowhere/page.html").contains("nowhere/page.html"));
}

#[test]
fn effects_findings_and_verdicts_are_explained() {
    let sandbox = Sandbox::new();
    let payload = sandbox.run("explain payload");
    for part in [
        "payload (effect)",
        "  in logs ",
        "  imitated by   motor_asymmetry",
        "  check ",
        "  variant       command: side (left or right), loss",
    ] {
        assert!(payload.contains(part), "{part}: {payload}");
    }
    for id in MOTION.iter().chain(&SONAR).map(|fault| fault.id).chain(["scatter", "no_gap", "partly_known"]) {
        assert!(sandbox.run(&format!("explain {id}")).starts_with(&format!("{id} (")), "{id}");
    }
    assert!(sandbox.run("explain").starts_with("effects: battery_sag, "));
    let refusal = sandbox.refused("explain payloads");
    assert_eq!(refusal, "payloads is not an effect, finding, verdict or term; did you mean payload?");
}
