//! Kinds of output files, recognised by content: an output may replace a file of its own kind without `--force`.

use std::collections::BTreeMap;

use serde::de::IgnoredAny;

use mindgap_applications::bundle::is_bundle;
use mindgap_files::places::Kind;
use mindgap_import::ros2_bag;
use mindgap_workers::checkpoint;

/// A simulator file.
pub const SIMULATOR: Kind =
    Kind { name: "a simulator", is_own: |content| has_keys(content, &["schema", "origin", "robot"]) };
/// The results of a command, as written by `--json`.
pub const REPORT: Kind = Kind { name: "a report", is_own: is_report };
/// An evolved controller. One without an origin was written by hand and is not replaced.
pub const CONTROLLER: Kind = Kind {
    name: "an evolved controller",
    is_own: |content| text(content).contains("[[tuple]]") && text(content).contains("[origin]"),
};
/// An onboard program or constants for one.
pub const PROGRAM: Kind = Kind { name: "a program", is_own: is_program };
/// The thresholds of the diagnosis.
pub const CALIBRATION: Kind =
    Kind { name: "a calibration", is_own: |content| content.starts_with(b"# Made by: mindgap challenge calibrate") };
/// The form errors of intervals.
pub const FORM_ERRORS: Kind =
    Kind { name: "form errors", is_own: |content| content.starts_with(b"# Made by: mindgap challenge score") };
/// A page for a browser.
pub const PAGE: Kind =
    Kind { name: "a page", is_own: |content| text(content).contains(r#"<meta name="generator" content="mindgap">"#) };
/// Logs with their diagnosis, to be sent.
pub const BUNDLE: Kind = Kind { name: "a bundle", is_own: is_bundle };
/// A ROS 2 bag written by this program.
pub const BAG: Kind = Kind { name: "a bag of mindgap", is_own: ros2_bag::is_own };
/// The formula of a diagnosis.
pub const FORMULA: Kind = Kind { name: "a formula", is_own: |content| text(content).starts_with(FORMULA_SIGN) };
/// First line of a formula's file. Effects without it were written by hand and are not replaced.
pub const FORMULA_SIGN: &str = "# Made by: mindgap diagnose\n";
/// The checkpoint of an interrupted run.
pub const CHECKPOINT: Kind =
    Kind { name: "a checkpoint", is_own: |content| content.starts_with(checkpoint::SIGNATURE) };
/// Files that do not show who wrote them, such as tables and runs in CSV.
pub const UNSIGNED: Kind = Kind { name: "anything", is_own: |_| false };

/// Phrases in the first lines of programs written by `export`, in all formats but the brick's executable.
const PROGRAMS: [&str; 6] = [
    "A six-tuple controller",
    "A simulator's networks in fixed point",
    "A simulator's networks in floating point",
    "commands for the LEGO NXT with standard firmware",
    "commands for a hub with Pybricks firmware",
    "use mindgap_core::fixed_network",
];
/// First bytes of a brick's executable.
const EXECUTABLE: &[u8] = b"MindstormsNXT\0";
/// Number of lines in which one of [`PROGRAMS`] must occur.
const FIRST_LINES: usize = 4;

fn is_program(content: &[u8]) -> bool {
    let mut first_lines = text(content).lines().take(FIRST_LINES);
    content.starts_with(EXECUTABLE) || first_lines.any(|line| PROGRAMS.iter().any(|sign| line.contains(sign)))
}

/// Reports written by `--json`, by keys that no earlier one has.
pub const REPORTS: &[(&[&str], &str)] = &[
    (&["stands_out"], "the diagnosis of a fleet: `mindgap diagnose --fleet`"),
    (&["verdict"], "a diagnosis: `mindgap diagnose --json`"),
    (&["reached_within_cm"], "simulated runs: `mindgap simulate --json`"),
    (&["holds"], "a check of logs: `mindgap check --json`"),
    (&["tracks"], "an import of a brick's logs: `mindgap import --json`"),
    (&["recordings"], "an import of recordings: `mindgap import --json`"),
    (&["events"], "a run of an onboard program: `mindgap brick --json`"),
    (&["lessons"], "an adaptation to runs: `mindgap adapt --json`"),
    (&["threshold_nats"], "a replay through the monitor: `mindgap monitor --json`"),
    (&["trials"], "a loop on the robot: `mindgap loop`"),
    (&["false_alarms"], "a score: `mindgap challenge score --json`"),
    (&["networks", "starts"], "a demonstration: `mindgap demo --json`"),
    (&["networks", "runs"], "a comparison of fixed point with float: `mindgap crosscheck --json`"),
    (&["networks"], "an evaluation: `mindgap evaluate --json`"),
    (&["logs", "effects"], "a recording: `mindgap record --json`"),
    (&["simulator", "evaluations"], "a training: `mindgap train --json`"),
    (&["controller", "generations"], "an evolution: `mindgap evolve --json`"),
    (&["program", "bytes"], "an export: `mindgap export --json`"),
    (&["run", "ending"], "a drive: `mindgap drive --json`"),
    (&["schema", "files"], "the contents of files: `mindgap info --json`"),
];

fn is_report(content: &[u8]) -> bool {
    REPORTS.iter().any(|(keys, _)| has_keys(content, keys)) && !(SIMULATOR.is_own)(content)
}

/// Returns whether the content is a JSON object with these keys.
fn has_keys(content: &[u8], keys: &[&str]) -> bool {
    let object = serde_json::from_slice::<BTreeMap<String, IgnoredAny>>(content);
    object.is_ok_and(|object| keys.iter().all(|key| object.contains_key(*key)))
}

fn text(content: &[u8]) -> &str {
    std::str::from_utf8(content).unwrap_or_default()
}
