//! The page of logs.

use mindgap_tests::command::Sandbox;
use mindgap_tests::faults::MOTION;

use crate::visit::{PHONE, Visit, in_all_windows, visit};

#[test]
fn logs_show_paths_speeds_readings_and_defects_without_scripts() {
    let sandbox = Sandbox::new();
    sandbox.run("record --out logs --runs 24 --steps 60");
    let mut logs = sandbox.logs("logs");
    let jumps = MOTION.iter().find(|fault| fault.id == "tracker_jump").expect("a fault");
    (jumps.put)(&mut logs);
    logs.write(&sandbox.path().join("faulty")).expect("a folder");
    sandbox.run("check faulty --html page.html");
    let look = |visit: Visit| {
        visit
            .ask("[...document.querySelectorAll('main > section')].map((part) => part.id).join(' ')")
            .ask("document.scripts.length")
            .text("#defects")
            .ask("[...document.querySelectorAll('[data-chart=driven] title')].filter((title) => title.textContent.endsWith('tracker_jump')).length")
            .ask("document.querySelectorAll('[data-chart=forward] svg').length")
            .ask("document.querySelectorAll('[data-chart=by-distance] circle').length")
            .text("#identified table")
            .text("#paths figcaption")
    };
    let visits = in_all_windows("logs", look);
    for seen in visit(&sandbox.path().join("page.html"), &visits) {
        assert_eq!(seen.word(0), "defects paths speeds readings holds identified");
        assert_eq!(seen.answer(1), 0, "charts need no scripts");
        assert!(seen.word(2).contains("run-004: lines 8, 17, 26, 35 and 44"), "{}", seen.word(2));
        assert_eq!(seen.answer(3), 5, "a mark for each jump");
        assert_eq!(seen.answer(4), 4, "runs over time");
        assert!(seen.answer(5).as_u64() > Some(100), "readings are drawn");
        assert!(seen.word(6).contains("drive scale"), "{}", seen.word(6));
        assert!(seen.word(7).contains("All 24 runs."), "{}", seen.word(7));
    }
}

#[test]
fn names_of_runs_stay_words_and_an_import_has_the_same_page() {
    let sandbox = Sandbox::new();
    let evil = "drive<img src=x onerror=evil=1>&'.csv";
    let row = |k: u32| {
        let t_s = 0.1 * f64::from(k);
        let speed = if (k / 20).is_multiple_of(2) { 0.2 } else { 0.1 };
        format!("{t_s:.1},{speed},0,{:.3},0,0\n", 0.015 * f64::from(k))
    };
    sandbox.write(evil, format!("t_s,v_m_s,w_rad_s,x_m,y_m,yaw_rad\n{}", (0..200).map(row).collect::<String>()));
    let mut command = sandbox.command("import streams --out logs --html page.html");
    command.arg(evil);
    let done = sandbox.execute(command);
    assert_eq!(done.code, 0, "{}", done.err);
    let look = Visit::new(PHONE, "logs-imported")
        .ask("typeof evil === 'undefined' && document.images.length === 0")
        .text("header")
        .ask("document.querySelectorAll('[data-chart=driven] polyline').length > 0");
    let seen = &visit(&sandbox.path().join("page.html"), &[look])[0];
    assert_eq!(seen.answer(0), true);
    assert!(seen.word(1).contains("To fill in: robot.toml"), "{}", seen.word(1));
    assert_eq!(seen.answer(2), true, "a path is drawn");
}
