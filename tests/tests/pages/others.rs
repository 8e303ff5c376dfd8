//! The pages of an evaluation and of a controller's runs.

use mindgap_tests::rooms::{trained, with_scene};

use crate::visit::{DARK_LAPTOP, DARK_PHONE, LAPTOP, PHONE, Visit, visit};

#[test]
fn an_evaluation_has_surfaces_that_turn_and_are_hatched() {
    let sandbox = trained();
    sandbox.run("evaluate sim.json logs --html page.html");
    let sheet = "document.querySelector('.turnable canvas').toDataURL()";
    let look = |window, picture| {
        Visit::new(window, picture)
            .ask("document.querySelectorAll('[fill=\"url(#hatch)\"] rect').length")
            .ask(sheet)
            .set("[data-turn='0']", "120")
            .ask(sheet)
    };
    let visits = [
        look(PHONE, "evaluation-phone"),
        look(LAPTOP, "evaluation-laptop"),
        look(DARK_PHONE, "evaluation-phone-dark"),
        look(DARK_LAPTOP, "evaluation-laptop-dark"),
    ];
    for seen in visit(&sandbox.path().join("page.html"), &visits) {
        assert!(seen.answer(0).as_u64() > Some(0), "six runs are not everywhere");
        assert_ne!(seen.answer(1), seen.answer(3), "the sheet turns");
    }
}

#[test]
fn a_simulation_shows_where_runs_end_and_what_the_controller_does() {
    let sandbox = with_scene();
    sandbox.run("evolve sim.json --scene scene.toml --out controller.toml --max-steps 20");
    sandbox.run("simulate sim.json controller.toml --scene scene.toml --runs 1000 --html page.html");
    let look = |window, picture| {
        Visit::new(window, picture)
            .set("#moment", "5")
            .text("#tuples")
            .text("#replay")
            .ask("document.querySelectorAll('[data-chart=turns] span[class$=-swatch]').length")
            .ask("new Set(page.turns.map((turn) => turn.tuple)).size")
    };
    let visits = [
        look(PHONE, "simulation-phone"),
        look(LAPTOP, "simulation-laptop"),
        look(DARK_PHONE, "simulation-phone-dark"),
        look(DARK_LAPTOP, "simulation-laptop-dark"),
    ];
    for seen in visit(&sandbox.path().join("page.html"), &visits) {
        assert!(seen.word(1).contains("until a reading is"), "{}", seen.word(1));
        assert!(seen.word(2).contains("of 1000 runs, evenly spread"), "{}", seen.word(2));
        assert_eq!(seen.answer(3), seen.answer(4), "a legend without tuples that no run holds");
    }
}
