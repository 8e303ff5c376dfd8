//! What the program writes stays the same, byte by byte, until somebody means to change it. `MINDGAP_BLESS=1` renews
//! the files.

use std::fmt::Write;

use mindgap_tests::command::{Workshop, workspace};
use mindgap_tests::golden::assert_golden;

/// The seed of everything here.
const SEED: u64 = 2008;

#[test]
fn the_first_lines_of_a_recorded_log() {
    let workshop = Workshop::new();
    workshop.done(&format!("record --out logs --runs 2 --steps 10 --seed {SEED}"));
    assert_golden("record-seed-2008.csv", &workshop.text("logs/run-001.csv"));
}

#[test]
fn an_nxc_program() {
    let workshop = Workshop::new();
    workshop.write(
        "six.toml",
        std::fs::read(workspace().join("tests/tests/golden/controller.toml")).expect("a fixed controller"),
    );
    workshop.done("export six.toml --format nxc --out six.nxc --display");
    assert_golden("controller.nxc", &workshop.text("six.nxc"));
}

#[test]
fn an_evolved_controller_and_its_runs() {
    let workshop = Workshop::new();
    workshop.write("scene.toml", mindgap_tests::rooms::SCENE);
    workshop.done(&format!("record --out logs --runs 6 --steps 25 --seed {SEED}"));
    workshop.done(&format!("train logs --out sim.json --seed {SEED}"));
    workshop.done(&format!("evolve sim.json --scene scene.toml --out c.toml --max-steps 12 --seed {SEED}"));
    let runs = workshop.done(&format!("simulate sim.json c.toml --scene scene.toml --runs 5 --seed {SEED}"));
    let mut text = workshop.text("c.toml");
    writeln!(text, "\n{runs}").expect("text takes text");
    assert_golden("evolve-seed-2008.txt", &text);
}
