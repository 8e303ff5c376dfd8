use std::fs;
use std::path::Path;

use mindgap_logs::Logs;

const ROWS: &str =
    "t_ms,left,right,x_cm,y_cm,heading_deg\n0,50,50,0,0,0\n400,50,35,1,0,0\n800,50,20,2,0,0\n1200,0,0,3,0,0\n";

/// Writes a folder of one run of a robot without a sensor, with these further files.
fn folder(files: &[(&str, &str)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let mut robot = mindgap_built_in_robot::default_robot();
    robot.ultrasonic = None;
    let robot = robot.to_text();
    let usual = [("robot.toml", robot.as_str()), ("scene.toml", ""), ("run-000.csv", ROWS)];
    for (name, text) in usual.iter().chain(files) {
        fs::write(folder.path().join(name), text).expect("written");
    }
    folder
}

fn read(folder: &Path) -> (Result<Logs, String>, Vec<String>) {
    let mut warnings = Vec::new();
    let logs = Logs::read(folder, |warning| warnings.push(warning)).map_err(|e| e.to_string());
    (logs, warnings)
}

const COMMANDS: &str = "t_ms,left,right\n-100,50,50\n600,50,20\n1200,0,0\n";

#[test]
fn commands_at_their_own_times_replace_those_of_rows() {
    let folder = folder(&[("commands-000.csv", COMMANDS)]);
    let (logs, warnings) = read(folder.path());
    let logs = logs.expect("logs");
    assert!(warnings.is_empty(), "{warnings:?}");
    let run = &logs.runs[0];
    assert_eq!(run.rows.changes().map(|changes| changes.as_slice().len()), Some(3));
    assert_eq!(run.rows.at(1).command(), [50.0, 35.0]);
    assert_eq!(run.previous_command(0), [50.0, 50.0], "it was set before the first row");

    let mut copy = logs.clone();
    copy.runs[0].rows.edit_each(|row| (row.left, row.right) = (0.0, 0.0));
    copy.write(folder.path()).expect("written");
    assert_eq!(read(folder.path()).0.expect("logs"), logs, "the file counts, not the rows");
}

/// Commands of earlier runs must not act on new ones.
#[test]
fn commands_are_replaced_with_their_runs() {
    let folder = folder(&[("commands-000.csv", COMMANDS)]);
    let mut logs = read(folder.path()).0.expect("logs");
    let rows = logs.runs[0].rows.iter().collect();
    logs.runs[0].rows = rows;
    logs.write(folder.path()).expect("written");
    assert!(!folder.path().join("commands-000.csv").exists());
    assert!(read(folder.path()).0.expect("logs").runs[0].rows.changes().is_none());
}

#[test]
fn resampled_rows_hold_the_means_of_the_same_commands() {
    let folder = folder(&[("commands-000.csv", COMMANDS)]);
    let logs = read(folder.path()).0.expect("logs");
    let longer = logs.resampled(800.0);
    assert_eq!(longer.runs[0].rows.changes(), logs.runs[0].rows.changes());
    assert_eq!(longer.runs[0].rows.at(0).command(), [50.0, 42.5]);
}

#[test]
fn rows_that_contradict_their_commands_are_reported() {
    let folder = folder(&[("commands-000.csv", "t_ms,left,right\n0,20,20\n")]);
    let (logs, warnings) = read(folder.path());
    assert_eq!(logs.expect("logs").runs[0].rows.at(2).command(), [20.0, 20.0]);
    assert!(warnings.len() == 1 && warnings[0].contains("commands-000.csv: left and right of the run"), "{warnings:?}");
}

#[test]
fn invalid_commands_are_rejected_with_file_and_line() {
    for (name, text, what) in [
        (
            "commands-000.csv",
            "t_ms,left,right\n0,1,1\n400,2,2\n300,3,3\n",
            "commands-000.csv:4: t_ms = 300 is not later",
        ),
        ("commands-000.csv", "t_ms,left,right\n0,1,1\n0,2,2\n", "commands-000.csv:3: t_ms = 0 is not later"),
        ("commands-000.csv", "t_ms,left,right\n0,NaN,1\n", "commands-000.csv:2: left = NaN is not a number"),
        ("commands-000.csv", "t_ms,left,right\n0,1,101\n", "commands-000.csv:2: right = 101 lies outside -100..100"),
        ("commands-000.csv", "t_ms,left,right\n0,1,\n", "commands-000.csv:2: right is empty"),
        ("commands-000.csv", "t_ms,left\n0,1\n", "commands-000.csv:1: column right is missing"),
        ("commands-000.csv", "t_ms,left,right\n", "commands-000.csv: has no command"),
        ("commands-005.csv", COMMANDS, "commands-005.csv: there is no run-005.csv beside it"),
    ] {
        let (logs, _) = read(folder(&[(name, text)]).path());
        let said = logs.expect_err(what);
        assert!(said.contains(what) && !said.contains('\n'), "{said}");
    }
    let (logs, warnings) = read(folder(&[("commands-000.csv", "t_ms,left,right,x_cm\n0,50,50,1\n")]).path());
    assert!(logs.is_ok() && warnings.iter().any(|w| w.contains("commands-000.csv:1: unknown column \"x_cm\"")));
}
