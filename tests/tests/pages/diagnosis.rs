//! The page of a diagnosis.

use std::fs;
use std::path::PathBuf;
use std::sync::LazyLock;

use mindgap_tests::command::Sandbox;
use mindgap_tests::rooms::trained;

use crate::visit::{LAPTOP, PHONE, Visit, in_all_windows, visit};

/// A folder with the page of a robot that covers less ground and whose readings are too long.
static DIAGNOSED: LazyLock<Sandbox> = LazyLock::new(|| {
    let sandbox = trained();
    sandbox.run("record --out worn --runs 8 --steps 40 --effect drive_scale=0.85 --effect sonar_offset --seed 9");
    sandbox.run("diagnose sim.json worn --html page.html");
    sandbox
});

fn page() -> PathBuf {
    DIAGNOSED.path().join("page.html")
}

#[test]
fn it_is_sound_on_phones_and_laptops_by_day_and_by_night_and_answers_what_one_asks() {
    let look = |visit: Visit| {
        visit
            .set("#moment", "14")
            .text("h1")
            .text("#causes")
            .text("#compared")
            .ask("[...document.querySelectorAll('main > section')].map((part) => part.id).join(' ')")
            .ask("document.querySelectorAll('[data-chart=budget] svg rect').length")
            .ask("document.querySelector('[data-chart=readings] .plane .robot .dots').getAttribute('d').length")
            .ask("document.querySelectorAll('[data-chart=apart] .plane .trail').length")
    };
    let visits = in_all_windows("diagnosis", look);
    for seen in visit(&page(), &visits) {
        let headline = seen.word(1);
        assert!(headline.starts_with("There is a gap, and known effects explain it: "), "{headline}");
        assert!(headline.contains("wheels like those of") && headline.ends_with("% sure)."), "{headline}");
        assert!(seen.word(2).contains("How to check"), "{}", seen.word(2));
        assert!(seen.word(3).contains("seed 1") && seen.word(3).contains("sim.json"), "{}", seen.word(3));
        assert_eq!(seen.word(4), "speeds budget causes where ends replay next compared words");
        assert!(seen.answer(5).as_u64() >= Some(3), "a bar for an effect, for scatter and for what is unexplained");
        assert!(seen.answer(6).as_u64() > Some(0), "readings are drawn over time");
        assert!(seen.answer(7).as_u64() >= Some(2), "distances of simulated robots are drawn over time");
    }
}

#[test]
fn the_replay_moves_with_hand_keyboard_and_time() {
    let place = "document.querySelector('.simulator .body').parentElement.getAttribute('transform')";
    let trail = "document.querySelector('.robot .whole').getAttribute('d')";
    let replayed = Visit::new(LAPTOP, "replay")
        .ask(place)
        .text("#clock")
        .set("#moment", "20")
        .ask(place)
        .text("#clock")
        .text("[data-kind=simulator] [data-field=off]")
        .ask(trail)
        .set("#run", "3")
        .ask(trail)
        .ask("document.getElementById('moment').focus()")
        .press("ArrowRight")
        .ask("document.getElementById('moment').value")
        .ask("document.getElementById('play').click()")
        .ask("new Promise((then) => setTimeout(() => then(Number(document.getElementById('moment').value)), 3000))")
        .ask("document.querySelector('[data-show=effects]').click()")
        .ask("document.querySelector('g.effects').getAttribute('display')");
    let seen = &visit(&page(), &[replayed])[0];
    assert_ne!(seen.answer(0), seen.answer(3), "the simulated robot is elsewhere");
    assert_ne!(seen.answer(1), seen.answer(4), "the clock goes on");
    assert!(seen.word(5).parse::<f64>().is_ok_and(|cm| cm > 0.5), "{} cm away from the robot", seen.word(5));
    assert_ne!(seen.answer(6), seen.answer(8), "another run has another path");
    assert_eq!(seen.answer(11), "1", "an arrow key is a row");
    assert!(seen.answer(13).as_f64().is_some_and(|row| row > 1.0), "time goes by: {}", seen.answer(13));
    assert_eq!(seen.answer(15), "none", "who is not asked for is not shown");
}

/// Names of folders and files, and words in files, are what somebody else wrote.
#[test]
fn markup_and_scripts_in_names_and_files_stay_words() {
    let sandbox = trained();
    let evil = "logs<img/src=x/onerror=evil=1>&\"'".replace('/', "\u{2215}");
    sandbox.run("record --out worn --runs 8 --steps 40 --effect drive_scale=0.85 --seed 9");
    fs::rename(sandbox.path().join("worn"), sandbox.path().join(&evil)).expect("such a name is possible");
    for run in 0..8 {
        let folder = sandbox.path().join(&evil);
        let name = format!("run-{run}<svg onload=evil=1><!--{}.csv", "long".repeat(40));
        fs::rename(folder.join(format!("run-00{run}.csv")), folder.join(name)).expect("such a name is possible");
    }
    sandbox.write(
        "own.toml",
        "[[effect]]\nid = \"caster\"\ndescription = \"</script><script>evil = 1</script><img src=x onerror=evil=1>\"\n\
         parameter = [{ name = \"k\", unit = \"cm/rad\", nominal = 0.0, bounds = [0.0, 20.0] }]\n\
         change = { forward_cm = \"forward_cm - k * abs(turn_rad)\" }\n",
    );
    sandbox.run(&format!("diagnose sim.json {evil} --effects own.toml --html page.html"));
    let foreign = Visit::new(PHONE, "diagnosis-foreign-words")
        .set("#run", "2")
        .ask("typeof evil === 'undefined' && document.images.length === 0")
        .text("option")
        .text(".kind");
    let seen = &visit(&sandbox.path().join("page.html"), &[foreign])[0];
    assert_eq!(seen.answer(1), true);
    assert!(seen.word(2).contains("<svg onload=evil=1><!--"), "{}", seen.word(2));
    assert!(seen.word(3).contains(&evil), "{}", seen.word(3));
}

#[test]
fn logs_without_echoes_or_company_have_pages_too() {
    let sandbox = trained();
    sandbox.run("record --out one-run --runs 1 --steps 60 --seed 4");
    sandbox.run("record --out no-echoes --runs 4 --steps 40 --effect drive_scale=0.8 --seed 5");
    for run in 0..4 {
        sandbox.edit_cells(&format!("no-echoes/run-00{run}.csv"), |cells| cells[6] = "");
    }
    for (logs, picture) in [("one-run", "diagnosis-one-run"), ("no-echoes", "diagnosis-no-echoes")] {
        sandbox.run(&format!("diagnose kinematic {logs} --html {logs}.html"));
        let seen = visit(&sandbox.path().join(format!("{logs}.html")), &[Visit::new(PHONE, picture).text("header")]);
        let not_compared = seen[0].word(0).contains("Not compared: echo rate and sonar reading");
        assert_eq!(not_compared, logs == "no-echoes", "{}", seen[0].word(0));
    }
}
