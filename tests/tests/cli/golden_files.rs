//! Outputs stay the same, byte by byte, until a change is intended: `MINDGAP_BLESS=1` writes new golden files.

use std::fmt::Write;

use mindgap_tests::command::{Sandbox, workspace};
use mindgap_tests::golden::assert_golden;

/// Seed of all golden files.
const SEED: u64 = 2008;

#[test]
fn a_recorded_log_is_unchanged() {
    let sandbox = Sandbox::new();
    sandbox.run(&format!("record --out logs --runs 2 --steps 10 --seed {SEED}"));
    assert_golden("record-seed-2008.csv", &sandbox.text("logs/run-001.csv"));
}

#[test]
fn an_nxc_program_is_unchanged() {
    let sandbox = Sandbox::new();
    sandbox.write(
        "six.toml",
        std::fs::read(workspace().join("tests/tests/golden/controller.toml")).expect("a fixed controller"),
    );
    sandbox.run("export six.toml --format nxc --out six.nxc --display");
    assert_golden("controller.nxc", &sandbox.text("six.nxc"));
}

#[test]
fn an_evolved_controller_and_its_runs_are_unchanged() {
    let sandbox = Sandbox::new();
    sandbox.write("scene.toml", mindgap_tests::rooms::SCENE);
    sandbox.run(&format!("record --out logs --runs 6 --steps 25 --seed {SEED}"));
    sandbox.run(&format!("train logs --out sim.json --seed {SEED}"));
    sandbox.run(&format!("evolve sim.json --scene scene.toml --out c.toml --max-steps 12 --seed {SEED}"));
    let runs = sandbox.run(&format!("simulate sim.json c.toml --scene scene.toml --runs 5 --seed {SEED}"));
    let mut text = sandbox.text("c.toml");
    writeln!(text, "\n{runs}").expect("text takes text");
    assert_golden("evolve-seed-2008.txt", &text);
}
