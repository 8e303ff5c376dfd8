//! `mindgap check`, and what commands do with logs in which something is wrong.

use mindgap_tests::command::Workshop;
use mindgap_tests::rooms::trained;

/// Runs of the workshop's logs.
const RUNS: usize = 6;

/// Changes the cells of every row of every run.
fn edit_cells(workshop: &Workshop, change: impl Fn(&mut [&str])) {
    (0..RUNS).for_each(|run| workshop.edit_cells(&format!("logs/run-{run:03}.csv"), &change));
}

/// Drivers say `inf` where there was no echo.
fn with_inf(workshop: &Workshop) {
    edit_cells(workshop, |cells| {
        if cells[6].is_empty() {
            cells[6] = "inf";
        }
    });
}

#[test]
fn good_logs_are_told_on_one_screen() {
    let workshop = Workshop::with_logs();
    let done = workshop.call("check logs --json check.json");
    assert_eq!((done.code, done.err.as_str()), (0, ""));
    for what in ["6 runs, 156 rows", "400 ms apart", "No defects found", "all five networks", "fewer than 8 runs"] {
        assert!(done.out.contains(what), "{what}:\n{}", done.out);
    }
    assert!(done.out.lines().count() <= 24, "{}", done.out);
    let check = workshop.json("check.json");
    assert_eq!(
        (&check["schema"], &check["holds"]["runs"], &check["holds"]["rows"]),
        (&1.into(), &6.into(), &156.into())
    );
    for list in ["findings", "missing_networks"] {
        assert_eq!(check[list].as_array().map(Vec::len), Some(0), "{check}");
    }
    assert!(check["refused"].is_null() && check["untestable"].is_array(), "{check}");
    assert_eq!(workshop.done("check logs --json -"), workshop.text("check.json"));
}

#[test]
fn every_missing_thing_is_told_at_once() {
    let workshop = Workshop::with_logs();
    // To the left alone, at one speed, and with nothing heard.
    edit_cells(&workshop, |cells| (cells[1], cells[2], cells[6]) = ("30", "50", ""));
    workshop.done("check logs --json check.json");
    let check = workshop.json("check.json");
    let drive_more = check["drive_more"].to_string();
    for what in ["turns to the right", "straight ahead", "below 30", "beyond 50", "changes within a run", "no reading"]
    {
        assert!(drive_more.contains(what), "{what}: {drive_more}");
    }
    assert_eq!(check["missing_networks"].as_array().map(Vec::len), Some(5), "{check}");
}

#[test]
fn logs_that_cannot_be_read_are_refused() {
    let workshop = Workshop::with_logs();
    workshop.edit("logs/run-001.csv", |text| text.replacen("heading_deg", "heading", 1));
    assert!(workshop.refused("check logs --json check.json").contains("column heading_deg is missing"));
}

#[test]
fn an_endless_reading_is_none() {
    let workshop = trained();
    let before = [workshop.done("evaluate sim.json logs"), workshop.done("crosscheck sim.json logs --runs 1")];
    with_inf(&workshop);
    for (call, before) in ["evaluate sim.json logs", "crosscheck sim.json logs --runs 1"].into_iter().zip(before) {
        let done = workshop.call(call);
        assert_eq!((done.code, done.out), (0, before), "{call}");
        assert_eq!(done.err.lines().count(), 1, "{}", done.err);
        assert!(done.err.starts_with("mindgap: warning: logs: echo_none_number ("), "{}", done.err);
    }
    let learned = workshop.bytes("sim.json");
    assert_eq!(workshop.call("train logs --out again.json").code, 0);
    assert!(workshop.bytes("again.json") == learned, "what is learned is the same");
}

#[test]
fn what_cannot_be_put_right_is_refused_with_what_to_write() {
    let workshop = trained();
    edit_cells(&workshop, |cells| cells.swap(1, 2));
    for call in ["train logs --out other.json", "evaluate sim.json logs", "crosscheck sim.json logs"] {
        let refusal = workshop.refused(call);
        assert!(refusal.starts_with("logs: ") && refusal.contains("left and right seem exchanged"), "{refusal}");
    }
    let told = workshop.done("check logs");
    assert!(
        told.contains("left_right_exchanged") && told.contains("The logs cannot be used until this is fixed"),
        "{told}"
    );
}

#[test]
fn figures_on_standard_output_stand_alone() {
    let workshop = trained();
    workshop.done("evaluate sim.json logs --json figures.json");
    assert_eq!(workshop.done("evaluate sim.json logs --json -"), workshop.text("figures.json"));
    assert!(!workshop.path().join("-").exists());
}
