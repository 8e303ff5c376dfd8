//! `mindgap check`, and how other commands treat faulty logs.

use mindgap_tests::command::Sandbox;
use mindgap_tests::rooms::trained;

/// Number of runs in the logs.
const RUNS: usize = 6;

/// Changes the cells of every row of every run.
fn edit_cells(sandbox: &Sandbox, change: impl Fn(&mut [&str])) {
    (0..RUNS).for_each(|run| sandbox.edit_cells(&format!("logs/run-{run:03}.csv"), &change));
}

/// Writes `inf` where there was no echo, as drivers do.
fn with_inf(sandbox: &Sandbox) {
    edit_cells(sandbox, |cells| {
        if cells[6].is_empty() {
            cells[6] = "inf";
        }
    });
}

#[test]
fn good_logs_are_summarised_on_one_screen() {
    let sandbox = Sandbox::with_logs();
    let outcome = sandbox.call("check logs --json check.json");
    assert_eq!((outcome.code, outcome.err.as_str()), (0, ""));
    for what in ["6 runs, 156 rows", "400 ms apart", "No defects found", "all five networks", "fewer than 8 runs"] {
        assert!(outcome.out.contains(what), "{what}:\n{}", outcome.out);
    }
    assert!(outcome.out.lines().count() <= 24, "{}", outcome.out);
    let check = sandbox.json("check.json");
    assert_eq!(
        (&check["schema"], &check["holds"]["runs"], &check["holds"]["rows"]),
        (&1.into(), &6.into(), &156.into())
    );
    for list in ["findings", "missing_networks"] {
        assert_eq!(check[list].as_array().map(Vec::len), Some(0), "{check}");
    }
    assert!(check["refused"].is_null() && check["untestable"].is_array(), "{check}");
    assert_eq!(sandbox.run("check logs --json -"), sandbox.text("check.json"));
}

#[test]
fn all_missing_excitation_is_reported_at_once() {
    let sandbox = Sandbox::with_logs();
    // Turns only left, at one speed, without any reading.
    edit_cells(&sandbox, |cells| (cells[1], cells[2], cells[6]) = ("30", "50", ""));
    sandbox.run("check logs --json check.json");
    let check = sandbox.json("check.json");
    let drive_more = check["drive_more"].to_string();
    for what in ["turns to the right", "straight ahead", "below 30", "beyond 50", "changes within a run", "no reading"]
    {
        assert!(drive_more.contains(what), "{what}: {drive_more}");
    }
    assert_eq!(check["missing_networks"].as_array().map(Vec::len), Some(5), "{check}");
}

#[test]
fn logs_that_cannot_be_read_are_refused() {
    let sandbox = Sandbox::with_logs();
    sandbox.edit("logs/run-001.csv", |text| text.replacen("heading_deg", "heading", 1));
    assert!(sandbox.refused("check logs --json check.json").contains("column heading_deg is missing"));
}

#[test]
fn an_endless_reading_is_none() {
    let sandbox = trained();
    let before = [sandbox.run("evaluate sim.json logs"), sandbox.run("crosscheck sim.json logs --runs 1")];
    with_inf(&sandbox);
    for (call, before) in ["evaluate sim.json logs", "crosscheck sim.json logs --runs 1"].into_iter().zip(before) {
        let outcome = sandbox.call(call);
        assert_eq!((outcome.code, outcome.out), (0, before), "{call}");
        assert_eq!(outcome.err.lines().count(), 1, "{}", outcome.err);
        assert!(outcome.err.starts_with("mindgap: warning: logs: echo_none_number ("), "{}", outcome.err);
    }
    let learned = sandbox.bytes("sim.json");
    assert_eq!(sandbox.call("train logs --out again.json").code, 0);
    assert!(sandbox.bytes("again.json") == learned, "what is learned is the same");
}

#[test]
fn uncorrectable_logs_are_refused_with_a_remedy() {
    let sandbox = trained();
    edit_cells(&sandbox, |cells| cells.swap(1, 2));
    for call in ["train logs --out other.json", "evaluate sim.json logs", "crosscheck sim.json logs"] {
        let refusal = sandbox.refused(call);
        assert!(refusal.starts_with("logs: ") && refusal.contains("left and right seem exchanged"), "{refusal}");
    }
    let output = sandbox.run("check logs");
    assert!(
        output.contains("left_right_exchanged") && output.contains("The logs cannot be used until this is fixed"),
        "{output}"
    );
}

#[test]
fn figures_on_standard_output_stand_alone() {
    let sandbox = trained();
    sandbox.run("evaluate sim.json logs --json figures.json");
    assert_eq!(sandbox.run("evaluate sim.json logs --json -"), sandbox.text("figures.json"));
    assert!(!sandbox.path().join("-").exists());
}
