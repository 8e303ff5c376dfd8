//! The pages of an evaluation and of a controller's runs.

use std::fs;

use mindgap_tests::rooms::{SCENE, trained};

use crate::browser::{DARK_LAPTOP, LAPTOP, PHONE, Page};

#[test]
fn an_evaluation_has_surfaces_that_turn_and_are_hatched() {
    let workshop = trained();
    workshop.done("evaluate sim.json logs --html page.html");
    let path = workshop.path().join("page.html");
    for (window, name) in
        [(PHONE, "evaluation-phone"), (LAPTOP, "evaluation-laptop"), (DARK_LAPTOP, "evaluation-laptop-dark")]
    {
        let page = Page::open(&path, window);
        page.picture(name);
        page.assert_sound();
        let hatched: usize = page.evaluate("document.querySelectorAll('[fill=\"url(#hatch)\"] rect').length");
        assert!(hatched > 0, "six runs are not everywhere");
        let sheet = "document.querySelector('.turnable canvas').toDataURL()";
        let before: String = page.evaluate(sheet);
        page.set("[data-turn='0']", "120", "input");
        assert_ne!(page.evaluate::<String>(sheet), before, "the sheet turns");
        assert_eq!(page.console(), [""; 0]);
    }
    assert!(fs::metadata(path).expect("a page").len() < 2_000_000);
}

#[test]
fn a_simulation_shows_where_runs_end_and_what_the_controller_does() {
    let workshop = trained();
    workshop.write("scene.toml", SCENE);
    workshop.done("evolve sim.json --scene scene.toml --out controller.toml --max-steps 20");
    workshop.done("simulate sim.json controller.toml --scene scene.toml --runs 300 --html page.html");
    let path = workshop.path().join("page.html");
    for (window, name) in [(PHONE, "simulation-phone"), (LAPTOP, "simulation-laptop")] {
        let page = Page::open(&path, window);
        page.set("#moment", "5", "input");
        page.picture(name);
        page.assert_sound();
        assert!(page.text("#tuples").contains("until a reading is"), "{}", page.text("#tuples"));
        assert!(page.text("#replay").contains("of 300 runs, evenly spread"), "{}", page.text("#replay"));
    }
}
