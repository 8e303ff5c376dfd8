use super::*;
use crate::test_support::driven;

fn missing(logs: Logs) -> Vec<String> {
    Survey::of(logs).drive_more
}

fn lacks(missing: &[String], what: &str) -> bool {
    missing.iter().any(|sentence| sentence.contains(what))
}

/// Commands of all signs and sizes, each held for five steps, in the first run for ten, and no two runs alike.
fn everything(run: usize, at: usize) -> [f64; 2] {
    const PAIRS: [[f64; 2]; 6] =
        [[90.0, 90.0], [-40.0, 40.0], [30.0, -15.0], [-90.0, -90.0], [12.0, 35.0], [40.0, 10.0]];
    let held = if run == 0 { 10 } else { 5 };
    let [left, right] = PAIRS[(run + at / held) % PAIRS.len()];
    [left + run as f64, right]
}

#[test]
fn amounts_rates_and_ranges_are_counted() {
    let mut logs = driven(8, 31, everything);
    logs.runs[0].rows.edit(3, |row| row.pose = None);
    logs.runs[1].rows.edit(4, |row| row.echo_cm = None);
    let holds = Survey::of(logs).holds;
    assert_eq!((holds.runs, holds.rows, holds.steps), (8, 248, 238));
    assert_eq!((holds.duration_s, holds.step_ms, holds.jitter_ms), (60.0, 250.0, 0.0));
    assert!((holds.with_pose - 247.0 / 248.0).abs() < 1e-12 && (holds.with_reading - 247.0 / 248.0).abs() < 1e-12);
    assert_eq!(holds.left, Some(Range { low: -89.0, high: 97.0 }));
    assert_eq!(holds.right, Some(Range { low: -90.0, high: 90.0 }));
    // A centimetre a step for every ten of command, four steps a second: backwards by -89 and -90, forwards by 97 and 90.
    let speed = holds.forward_cm_s.expect("steps");
    assert!((speed.low + 35.8).abs() < 0.01 && (37.0..37.4).contains(&speed.high), "{speed:?}");
    assert_eq!((holds.held_steps, holds.longest_held_steps), (5.0, 10));
    // Six pairs in six cells of a hundred.
    assert!((holds.command_coverage - 0.06).abs() < 1e-12, "{}", holds.command_coverage);
}

#[test]
fn what_is_driven_is_not_asked_for() {
    let missing = missing(driven(8, 31, everything));
    for what in ["turns", "straight", "below", "show its limit", "held", "changes", "fewer than", "No effect"] {
        assert!(!lacks(&missing, what), "{missing:?}");
    }
}

#[test]
fn what_is_not_driven_is_asked_for() {
    let to_the_left = missing(driven(3, 12, |run, at| [25.0 + ((run + at) % 7) as f64, 60.0]));
    let sentences =
        ["turns to the right", "straight ahead", "below 25", "beyond 60", "longer than 250 ms", "fewer than 8 runs"];
    for what in sentences {
        assert!(lacks(&to_the_left, what), "{what}: {to_the_left:?}");
    }
    assert!(!lacks(&to_the_left, "turns to the left"));
    let briefly = missing(driven(8, 31, |run, at| everything(1 + run, at)));
    assert!(lacks(&briefly, "longer than 5 steps: controllers"), "{briefly:?}");
    assert!(lacks(&missing(driven(8, 12, |run, _| [10.0 * run as f64, 50.0])), "changes within a run"));
    assert!(lacks(&missing(driven(8, 12, |_, _| [0.0; 2])), "No command drives the motors"));
}

#[test]
fn logs_without_anything_to_compare_show_no_effect() {
    let mut empty = driven(8, 12, everything);
    empty.runs.iter_mut().for_each(|run| run.rows.edit_each(|row| (row.pose, row.echo_cm) = (None, None)));
    let survey = Survey::of(empty);
    assert_eq!(survey.untestable.len(), CATALOGUE.len());
    assert_eq!(survey.missing_networks.len(), 5);
    assert!(lacks(&survey.drive_more, "No effect can be identified"), "{:?}", survey.drive_more);
}

#[test]
fn faults_are_found_and_uncorrectable_logs_are_refused() {
    let mut endless = driven(8, 31, everything);
    endless.runs[2].rows.edit(5, |row| row.echo_cm = Some(1e7));
    let survey = Survey::of(endless);
    assert_eq!(survey.findings.iter().map(|found| found.id).collect::<Vec<_>>(), ["echo_none_number"]);
    assert!(survey.refused.is_none() && survey.holds.reading_cm.is_some_and(|cm| cm.high < 400.0));
    let mut exchanged = driven(8, 31, |run, at| {
        [((run * 7 + at * 13) % 9) as f64 * 20.0 - 80.0, ((run * 5 + at * 11) % 7) as f64 * 25.0 - 75.0]
    });
    exchanged.runs.iter_mut().for_each(|run| {
        run.rows.edit_each(|row| (row.left, row.right) = (row.right, row.left));
    });
    let refused = Survey::of(exchanged).refused.expect("a refusal");
    assert!(refused.contains("left and right seem exchanged"), "{refused}");
}
