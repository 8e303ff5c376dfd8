//! The page of a fleet.

use std::fs;

use mindgap_tests::rooms::trained;

use crate::visit::{Visit, in_all_windows, visit};

/// What somebody might call a robot.
const ROBOT: &str = "robot<img src=x onerror=evil=1>&\"'";

#[test]
fn a_fleet_shows_what_is_frequent_sorts_its_robots_and_keeps_names_words() {
    let sandbox = trained();
    fs::create_dir(sandbox.path().join("fleet")).expect("a folder");
    for (name, effect) in [("a", ""), ("b", ""), ("c", "--effect motor_asymmetry=0.25"), ("d", "")] {
        let seed = 20 + u32::from(name.as_bytes()[0]);
        sandbox.run(&format!("record --out fleet/{name} --runs 6 --steps 25 --seed {seed} {effect}"));
    }
    let robot = sandbox.path().join("fleet").join(ROBOT);
    fs::rename(sandbox.path().join("fleet/c"), robot).expect("such a name is possible");
    fs::create_dir(sandbox.path().join("fleet/broken<svg onload=evil=1>")).expect("such a name is possible");
    sandbox.run("diagnose sim.json fleet --fleet out");
    let names = "[...document.querySelectorAll('#robots tbody th')].map((robot) => robot.textContent).join('|')";
    let look = |visit: Visit| {
        visit
            .text("h1")
            .ask("document.querySelectorAll('[data-chart=frequencies] svg circle').length")
            .ask(names)
            .ask("document.querySelector('#robots th button').click()")
            .ask("document.querySelector('#robots th button').click()")
            .ask(names)
            .ask("typeof evil === 'undefined' && document.images.length === 0")
            .text("#refused")
    };
    let visits = in_all_windows("fleet", look);
    for seen in visit(&sandbox.path().join("out/fleet.html"), &visits) {
        assert!(seen.word(0).starts_with("4 robots: "), "{}", seen.word(0));
        assert!(seen.answer(1).as_u64() >= Some(1), "a point for an effect");
        assert_eq!(seen.word(2), ["a", "b", "d", ROBOT].join("|"));
        assert_eq!(seen.word(5), [ROBOT, "d", "b", "a"].join("|"), "sorted the other way round");
        assert_eq!(seen.answer(6), true, "a name stays a word");
        assert!(seen.word(7).contains("broken<svg onload=evil=1>"), "{}", seen.word(7));
    }
}
