//! The same seed and inputs give the same bytes on any number of threads, and another seed gives others.

use mindgap_tests::command::Sandbox;
use mindgap_tests::rooms::with_scene;

/// Expects a command that writes `out` to write the same on one and on two threads, and something else with another seed.
fn assert_depends_on_seed_only(sandbox: &Sandbox, command: &str) {
    let written = |threads: usize, seed: u64| {
        let copy = sandbox.copy();
        let outcome = copy.call_on_threads(threads, &format!("{command} --out out --seed {seed}"));
        assert_eq!(outcome.code, 0, "{}", outcome.err);
        (outcome.out, copy.files(""))
    };
    let first = written(1, 5);
    assert!(first == written(2, 5), "mindgap {command} depends on the number of threads");
    assert!(first.1 != written(2, 6).1, "mindgap {command} does not depend on the seed");
}

#[test]
fn recording_depends_on_the_seed_only() {
    assert_depends_on_seed_only(&Sandbox::new(), "record --runs 4 --steps 15 --effect slip");
}

#[test]
fn training_depends_on_the_seed_only() {
    assert_depends_on_seed_only(&Sandbox::with_logs(), "train logs");
}

#[test]
fn evolution_depends_on_the_seed_only() {
    let sandbox = with_scene();
    assert_depends_on_seed_only(&sandbox, "evolve sim.json --scene scene.toml --max-steps 4");
}

#[test]
fn the_papers_evolution_depends_on_the_seed_only() {
    let sandbox = with_scene();
    assert_depends_on_seed_only(&sandbox, "evolve sim.json --scene scene.toml --max-steps 6 --paper");
}
