//! The page of a diagnosis.

use std::fs;
use std::sync::LazyLock;

use mindgap_tests::command::Workshop;
use mindgap_tests::rooms::trained;

use crate::browser::{DARK_LAPTOP, DARK_PHONE, LAPTOP, PHONE, Page};

/// A folder with the page of a robot whose wheels are smaller and whose readings are too long.
static DIAGNOSED: LazyLock<Workshop> = LazyLock::new(|| {
    let workshop = trained();
    workshop.done("record --out worn --runs 8 --steps 40 --effect drive_scale=0.85 --effect sonar_offset --seed 9");
    workshop.done("diagnose sim.json worn --html page.html");
    workshop
});

#[test]
fn it_is_sound_on_phones_and_laptops_by_day_and_by_night() {
    let path = DIAGNOSED.path().join("page.html");
    for (window, name) in [
        (PHONE, "diagnosis-phone"),
        (LAPTOP, "diagnosis-laptop"),
        (DARK_PHONE, "diagnosis-phone-dark"),
        (DARK_LAPTOP, "diagnosis-laptop-dark"),
    ] {
        let page = Page::open(&path, window);
        page.set("#moment", "14", "input");
        page.picture(name);
        page.assert_sound();
    }
    assert!(fs::metadata(path).expect("a page").len() < 2_000_000);
}

#[test]
fn it_answers_what_a_roboticist_asks() {
    let page = Page::open(&DIAGNOSED.path().join("page.html"), LAPTOP);
    assert!(page.text("h1").contains("gap between simulator and robot"), "{}", page.text("h1"));
    for part in ["budget", "causes", "where", "ends", "replay", "next", "compared", "words"] {
        assert!(page.evaluate::<bool>(&format!("document.getElementById({part:?}) !== null")), "{part}");
    }
    assert!(page.text("#causes").contains("How to check"));
    assert!(page.text("#compared").contains("seed 1") && page.text("#compared").contains("8"));
    let bars: usize = page.evaluate("document.querySelectorAll('[data-chart=budget] svg rect').length");
    assert!(bars >= 3, "effects, scatter and what is unexplained: {bars}");
}

#[test]
fn the_replay_moves() {
    let page = Page::open(&DIAGNOSED.path().join("page.html"), LAPTOP);
    let body = ".simulator .body";
    let place = format!("document.querySelector({body:?}).parentElement.getAttribute('transform')");
    let begin: String = page.evaluate(&place);
    let clock = page.text("#clock");
    page.set("#moment", "20", "input");
    assert_ne!(page.evaluate::<String>(&place), begin, "the simulated robot is elsewhere");
    assert_ne!(page.text("#clock"), clock);
    let off = page.text("[data-kind=simulator] [data-field=off]");
    assert!(off.parse::<f64>().is_ok_and(|cm| cm > 0.5), "{off} cm away from the robot");
    let trail: String = page.evaluate("document.querySelector('.robot .whole').getAttribute('d')");
    page.set("#run", "3", "change");
    assert_ne!(page.evaluate::<String>("document.querySelector('.robot .whole').getAttribute('d')"), trail);
    page.evaluate::<serde_json::Value>("document.getElementById('play').click()");
    page.wait_for("Number(document.getElementById('moment').value) > 0");
    page.evaluate::<serde_json::Value>("document.querySelector('[data-show=effects]').click()");
    assert!(page.evaluate::<bool>("document.querySelector('g.effects').getAttribute('display') === 'none'"));
    assert_eq!(page.console(), [""; 0]);
}

#[test]
fn the_slider_answers_to_the_keyboard() {
    let page = Page::open(&DIAGNOSED.path().join("page.html"), PHONE);
    page.evaluate::<serde_json::Value>("document.getElementById('moment').focus()");
    let clock = page.text("#clock");
    page.press("ArrowRight");
    page.wait_for("document.getElementById('moment').value === '1'");
    assert_ne!(page.text("#clock"), clock);
}

#[test]
fn it_prints() {
    let pdf = Page::open(&DIAGNOSED.path().join("page.html"), DARK_LAPTOP).pdf();
    let pages = pdf.windows(11).filter(|bytes| bytes == b"/Type /Page").count();
    assert!(pdf.starts_with(b"%PDF-") && pages >= 3, "{pages} pages");
}

/// Names of folders and files, and words in files, are what somebody else wrote.
#[test]
fn markup_and_scripts_in_names_and_files_stay_words() {
    let workshop = trained();
    let evil = "logs<img/src=x/onerror=evil=1>&\"'";
    workshop.done("record --out worn --runs 8 --steps 40 --effect drive_scale=0.85 --seed 9");
    fs::rename(workshop.path().join("worn"), workshop.path().join(evil)).expect("such a name is possible");
    for run in 0..8 {
        let folder = workshop.path().join(evil);
        let name = format!("run-{run}<svg onload=evil=1><!--.csv");
        fs::rename(folder.join(format!("run-00{run}.csv")), folder.join(name)).expect("such a name is possible");
    }
    workshop.write(
        "own.toml",
        "[[effect]]\nid = \"caster\"\ndescription = \"</script><script>evil = 1</script><img src=x onerror=evil=1>\"\n\
         parameter = [{ name = \"k\", unit = \"cm/rad\", nominal = 0.0, bounds = [0.0, 20.0] }]\n\
         change = { forward_cm = \"forward_cm - k * abs(turn_rad)\" }\n",
    );
    workshop.done(&format!("diagnose sim.json {evil} --effects own.toml --html page.html"));
    let page = Page::open(&workshop.path().join("page.html"), PHONE);
    page.set("#run", "2", "change");
    assert!(page.evaluate::<bool>("typeof evil === 'undefined' && document.images.length === 0"));
    assert!(page.text("option").contains("<svg onload=evil=1>"), "{}", page.text("option"));
    assert!(page.text(".kind").contains("<img/src=x/onerror=evil=1>"));
    page.assert_sound();
}

#[test]
fn logs_without_poses_echoes_or_company_have_pages_too() {
    let workshop = trained();
    workshop.done("record --out logs-1 --runs 1 --steps 60 --seed 4");
    let without = |folder: &str, columns: std::ops::Range<usize>| {
        workshop.done(&format!("record --out {folder} --runs 4 --steps 40 --effect drive_scale=0.8 --seed 5"));
        for run in 0..4 {
            workshop.edit_cells(&format!("{folder}/run-00{run}.csv"), |cells| cells[columns.clone()].fill(""));
        }
    };
    without("no-echoes", 6..7);
    for (logs, name) in [("logs-1", "one-run"), ("no-echoes", "no-echoes")] {
        workshop.done(&format!("diagnose kinematic {logs} --html {name}.html"));
        let page = Page::open(&workshop.path().join(format!("{name}.html")), PHONE);
        page.picture(&format!("diagnosis-{name}"));
        page.assert_sound();
    }
}
