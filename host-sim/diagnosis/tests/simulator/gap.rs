//! The diagnosis on logs of the built-in robot, from the logs alone.

use mindgap_diagnosis::verdict::Verdict;
use mindgap_diagnosis::{Diagnosis, diagnose};
use mindgap_foundations::channel::Channel;
use mindgap_logs::{Logs, Row};
use mindgap_models::simulator::baseline::Baseline;
use mindgap_models::simulator::kinematic;

use crate::{SIMULATOR, logs};

fn diagnosed(logs: &Logs) -> Diagnosis {
    let baseline = Baseline::at_posterior_mean(&SIMULATOR).expect("the simulator knows its scatter");
    diagnose(baseline, logs).expect("there is something to compare")
}

fn ids(diagnosis: &Diagnosis) -> Vec<&str> {
    diagnosis.effects.iter().map(|e| e.id).collect()
}

#[test]
fn a_robot_like_any_other_has_no_gap() {
    let diagnosis = diagnosed(&logs(16, &[], 71));
    assert_eq!(diagnosis.verdict, Verdict::NoGap, "{diagnosis:?}");
    assert!(diagnosis.effects.is_empty() && diagnosis.reduction.is_none());
}

#[test]
fn single_effects_are_named_and_close_the_gap() {
    for effect in ["deadband", "sonar_yaw", "tracker_rotation"] {
        let diagnosis = diagnosed(&logs(16, &[effect], 73));
        assert_eq!(ids(&diagnosis), [effect], "{diagnosis:?}");
        let whole = diagnosis.reduction.as_ref().expect("a gap that shrinks").whole;
        let (closed, [low, high]) = whole.reducible_closed.zip(whole.ci95).expect("an effect");
        assert!(closed > 0.8 && low <= closed && closed <= high, "{effect}: {whole:?}");
    }
}

#[test]
fn the_strength_is_found_again() {
    let diagnosis = diagnosed(&logs(16, &["sonar_offset=3", "drive_scale=0.94"], 74));
    let parameter = |id: &str, name: &str| {
        let found = diagnosis.effects.iter().find(|e| e.id == id).unwrap_or_else(|| panic!("{diagnosis:?}"));
        found.parameters[name].as_f64().expect("a number")
    };
    assert!((parameter("sonar_offset", "cm") - 3.0).abs() < 0.5);
    assert!((parameter("drive_scale", "factor") - 0.94).abs() < 0.02);
}

#[test]
fn what_is_outside_the_table_is_unknown() {
    let diagnosis = diagnosed(&logs(16, &["command_quantisation"], 75));
    assert_eq!(diagnosis.verdict, Verdict::Unknown, "{diagnosis:?}");
    assert!(diagnosis.effects.is_empty() && !diagnosis.strata.is_empty());
}

/// What moves readings one way early in a run and another way late is no scatter, although it looks like it on the
/// whole.
#[test]
fn scatter_that_follows_circumstances_is_no_cause() {
    let diagnosis = diagnosed(&logs(16, &["sonar_drift=0.4"], 78));
    assert_eq!(diagnosis.verdict, Verdict::Unknown, "{diagnosis:?}");
    let mut profiles = diagnosis.profiles.iter();
    assert!(profiles.any(|p| p.depends_on.starts_with("elapsed time")), "{diagnosis:?}");
    assert_eq!(ids(&diagnosed(&logs(16, &["sonar_noise"], 78))), ["sonar_noise"]);
}

/// Tyres without grip lose turns too, but not in proportion, as another track would have it.
#[test]
fn smaller_turns_are_not_taken_for_slip() {
    for effect in ["track_width=1.2", "slip=35"] {
        let diagnosis = diagnosed(&logs(16, &[effect], 79));
        assert!(effect.starts_with(ids(&diagnosis)[0]), "{diagnosis:?}");
    }
}

#[test]
fn without_poses_and_counters_there_is_nothing_to_compare() {
    let mut logs = logs(4, &[], 76);
    let bare = |row: &mut Row| *row = Row { pose: None, rot_left_deg: None, rot_right_deg: None, ..*row };
    logs.runs.iter_mut().for_each(|run| run.rows.edit_each(bare));
    let baseline = Baseline::at_posterior_mean(&SIMULATOR).expect("the simulator knows its scatter");
    assert!(diagnose(baseline, &logs).is_err());
}

#[test]
fn without_readings_motion_is_still_diagnosed() {
    let mut logs = logs(16, &["track_width"], 77);
    logs.runs.iter_mut().for_each(|run| run.rows.edit_each(|row| row.echo_cm = None));
    let diagnosis = diagnosed(&logs);
    assert_eq!(ids(&diagnosis), ["track_width"], "{diagnosis:?}");
    assert!(diagnosis.untestable.contains(&"sonar_noise"));
}

#[test]
fn the_textbook_serves_where_there_is_no_simulator() {
    let logs = logs(16, &[], 78);
    let diagnosis = diagnose(kinematic::baseline(&logs), &logs).expect("there is something to compare");
    assert_ne!(diagnosis.verdict, Verdict::NoGap, "a real robot differs from the textbook");
    // Its motors have no memory: it is off most where a command is new.
    let worst = diagnosis.strata.iter().max_by(|a, b| a.gap.total_cmp(&b.gap)).expect("a place");
    assert!(matches!(worst.channel, Channel::Forward | Channel::Turn), "{worst:?}");
    assert!(["new command", "reverses"].iter().any(|what| worst.context.contains(what)), "{worst:?}");
    let reduction = diagnosis.reduction.as_ref().expect("a gap that shrinks");
    assert!(reduction.whole.reducible_closed.is_some_and(|closed| closed > 0.4), "{reduction:?}");
    assert!(reduction.paths.iter().all(|path| path.after_cm < 0.7 * path.before_cm), "{:?}", reduction.paths);
}

#[test]
fn one_run_is_said_to_be_little() {
    let diagnosis = diagnosed(&logs(1, &["drive_scale"], 79));
    assert!(diagnosis.notes.iter().any(|note| note.starts_with("One run only")), "{:?}", diagnosis.notes);
}
