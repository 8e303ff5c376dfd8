//! The pages of an evaluation and of a controller's runs.

use mindgap_tests::rooms::{trained, with_scene};

use crate::visit::{Visit, in_all_windows, visit};

#[test]
fn an_evaluation_has_surfaces_that_turn_and_are_hatched() {
    let sandbox = trained();
    sandbox.run("evaluate sim.json logs --html page.html");
    let look = |visit: Visit| {
        visit
            .ask("document.querySelectorAll('[data-chart=surface] svg svg').length")
            .ask("document.querySelectorAll('[data-chart=surface] title').length")
            .ask("document.querySelectorAll('[data-chart=sheet] polygon').length")
            .ask("document.querySelector('[data-chart=surface] title').textContent")
            .ask("document.scripts.length")
    };
    let visits = in_all_windows("evaluation", look);
    for seen in visit(&sandbox.path().join("page.html"), &visits) {
        // Two maps of 48 by 36 cells, each with a hatch in its plane and one in its legend, and two sheets of 24 by 24.
        assert_eq!(seen.answer(0), 4, "six runs are not everywhere");
        assert!((1..2 * 48 * 36).contains(&seen.answer(1).as_u64().unwrap_or(0)), "{} known cells", seen.answer(1));
        assert_eq!(seen.answer(2), 2 * 24 * 24);
        assert!(seen.word(3).contains(" cm, ") && seen.word(3).contains("°: "), "{}", seen.word(3));
        assert_eq!(seen.answer(4), 0, "charts need no scripts");
    }
}

#[test]
fn a_simulation_shows_where_runs_end_and_what_the_controller_does() {
    let sandbox = with_scene();
    sandbox.run("evolve sim.json --scene scene.toml --out controller.toml --max-steps 20");
    sandbox.run("simulate sim.json controller.toml --scene scene.toml --runs 1000 --html page.html");
    let look = |visit: Visit| {
        visit
            .set("#moment", "5")
            .text("#tuples")
            .text("#replay")
            .ask("[...document.querySelectorAll('[data-chart=turns] text')].map((text) => text.textContent).filter((text) => text.startsWith('tuple ')).join()")
            .ask("[...new Set([...document.querySelectorAll('[data-chart=turns] title')].map((title) => title.textContent.split(',')[0]))].sort().join()")
    };
    let visits = in_all_windows("simulation", look);
    for seen in visit(&sandbox.path().join("page.html"), &visits) {
        assert!(seen.word(1).contains("until a reading is"), "{}", seen.word(1));
        assert!(seen.word(2).contains("of 1000 runs, evenly spread"), "{}", seen.word(2));
        assert_eq!(seen.answer(3), seen.answer(4), "a legend without tuples that no run holds");
        assert!(seen.word(3).starts_with("tuple 1"), "{}", seen.word(3));
    }
}
