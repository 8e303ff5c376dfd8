//! The same seed and inputs give the same bytes on any number of threads, and another seed gives others.

use mindgap_tests::command::Workshop;
use mindgap_tests::rooms::with_scene;

/// Calls a command that writes to the file or folder `out` on one and on two threads, and checks that it writes the
/// same; and that it writes something else with another seed.
fn assert_settled(workshop: &Workshop, command: &str) {
    let written = |threads: usize, seed: u64| {
        let copy = workshop.copy();
        let done = copy.call_on_threads(threads, &format!("{command} --out out --seed {seed}"));
        assert_eq!(done.code, 0, "{}", done.err);
        (done.out, copy.files(""))
    };
    let first = written(1, 5);
    assert!(first == written(2, 5), "mindgap {command} depends on the number of threads");
    assert!(first.1 != written(2, 6).1, "mindgap {command} does not depend on the seed");
}

#[test]
fn recording() {
    assert_settled(&Workshop::new(), "record --runs 4 --steps 15 --effect slip");
}

#[test]
fn training() {
    assert_settled(&Workshop::with_logs(), "train logs");
}

#[test]
fn evolution() {
    let workshop = with_scene();
    assert_settled(&workshop, "evolve sim.json --scene scene.toml --max-steps 12");
}

#[test]
fn evolution_as_the_paper_has_it() {
    let workshop = with_scene();
    assert_settled(&workshop, "evolve sim.json --scene scene.toml --max-steps 6 --paper");
}
