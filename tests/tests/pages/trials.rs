//! The page of a loop on the robot.

use mindgap_tests::command::Sandbox;
use mindgap_tests::rooms::{SCENE, robot, trained};

use crate::visit::{PHONE, Visit, in_all_windows, visit};

/// A hostile name for a room.
const ROOM: &str = "room<img\u{a0}src=x\u{a0}onerror=evil=1>&'.toml";

/// Runs a loop of `trials` trials and writes its page.
fn looped(trials: usize) -> Sandbox {
    let sandbox = trained();
    sandbox.write(ROOM, SCENE);
    robot(&sandbox, "", "");
    let mut command =
        sandbox.command(&format!("loop out --sim sim.json --max-steps 20 --trials {trials} --html page.html"));
    command.args(["--robot", "sh robot.sh", "--scene", ROOM]);
    let done = sandbox.execute(command);
    assert_eq!(done.code, 0, "{}", done.err);
    sandbox
}

#[test]
fn a_loop_shows_what_was_expected_what_happened_and_what_it_taught() {
    let sandbox = looped(3);
    let trials = sandbox.json("out/loop.json")["trials"].as_array().map_or(0, Vec::len);
    let look = |visit: Visit| {
        visit
            .text("h1")
            .text("#turns table")
            .ask("[...document.querySelectorAll('[data-chart=map]')].filter((map) => map.querySelector('svg')).length")
            .text("#effects")
            .ask("typeof evil === 'undefined' && document.images.length === 0")
            .text(".kind")
    };
    let visits = in_all_windows("loop", look);
    for seen in visit(&sandbox.path().join("page.html"), &visits) {
        assert!(seen.word(0).contains("controller"), "{}", seen.word(0));
        assert!(seen.word(1).contains("reached the target") || seen.word(1).contains("missed it"), "{}", seen.word(1));
        assert_eq!(seen.answer(2).as_u64(), Some(trials as u64), "a map for each trial");
        assert!(!seen.word(3).is_empty());
        assert_eq!(seen.answer(4), true, "a name stays a word");
        assert!(seen.word(5).contains(ROOM), "{}", seen.word(5));
    }
}

#[test]
fn a_loop_that_found_nothing_has_a_page_too() {
    let sandbox = trained();
    // Two steps lead nowhere.
    sandbox.write("scene.toml", SCENE);
    let mut command = sandbox.command("loop out --sim sim.json --scene scene.toml --max-steps 2 --html page.html");
    command.args(["--robot", "false"]);
    let done = sandbox.execute(command);
    assert_eq!(done.code, 0, "{}", done.err);
    let seen = visit(&sandbox.path().join("page.html"), &[Visit::new(PHONE, "loop-out-of-reach").text("h1")]);
    assert!(seen[0].word(0).contains("No controller was found"), "{}", seen[0].word(0));
}
