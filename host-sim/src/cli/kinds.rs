//! What the commands write, recognised by its content: a file of that kind may be written again.

use std::collections::BTreeMap;

use serde::de::IgnoredAny;

use crate::files::places::Kind;

/// A simulator.
pub const SIMULATOR: Kind =
    Kind { name: "a simulator", is_one: |content| has_keys(content, &["schema", "origin", "robot"]) };
/// What `evaluate` found.
pub const EVALUATION: Kind =
    Kind { name: "an evaluation", is_one: |content| has_keys(content, &["schema", "networks"]) };
/// What `simulate` found.
pub const ROLLOUTS: Kind =
    Kind { name: "a report of simulate", is_one: |content| has_keys(content, &["schema", "reached_within_cm"]) };
/// What `crosscheck` found.
pub const CROSSCHECK: Kind =
    Kind { name: "a report of crosscheck", is_one: |content| has_keys(content, &["schema", "networks", "runs"]) };
/// What `check` found.
pub const SURVEY: Kind = Kind { name: "a report of check", is_one: |content| has_keys(content, &["schema", "holds"]) };
/// What `diagnose` found.
pub const DIAGNOSIS: Kind = Kind { name: "a diagnosis", is_one: |content| has_keys(content, &["schema", "verdict"]) };
/// What `import` did.
pub const IMPORT: Kind =
    Kind { name: "a report of import", is_one: |content| has_keys(content, &["schema", "tracks", "logs"]) };
/// What `import streams` and `import bag` did.
pub const RECORDINGS: Kind =
    Kind { name: "a report of import", is_one: |content| has_keys(content, &["schema", "recordings", "sides"]) };
/// What a brick did.
pub const BRICK: Kind =
    Kind { name: "a report of brick", is_one: |content| has_keys(content, &["schema", "events", "motors"]) };
/// The score of a challenge.
pub const SCORE: Kind = Kind { name: "a score", is_one: |content| has_keys(content, &["false_alarms", "detected"]) };
/// A controller that was evolved: one without an origin is somebody's own.
pub const CONTROLLER: Kind = Kind {
    name: "an evolved controller",
    is_one: |content| text(content).contains("[[tuple]]") && text(content).contains("[origin]"),
};
/// An onboard program or constants for one.
pub const PROGRAM: Kind = Kind { name: "a program", is_one: is_program };
/// The thresholds of the diagnosis.
pub const CALIBRATION: Kind =
    Kind { name: "a calibration", is_one: |content| content.starts_with(b"# Made by: mindgap challenge calibrate") };
/// A page of a diagnosis.
pub const PAGE: Kind = Kind { name: "a page", is_one: |content| text(content).contains(PAGE_SIGN) };
/// What a page of a diagnosis ends with.
pub const PAGE_SIGN: &str = "<!-- Made by: mindgap diagnose -->\n";
/// The formula of a diagnosis.
pub const FORMULA: Kind = Kind { name: "a formula", is_one: |content| text(content).starts_with(FORMULA_SIGN) };
/// What the file of a formula begins with: own effects without it are somebody's own.
pub const FORMULA_SIGN: &str = "# Made by: mindgap diagnose\n";
/// What carries no sign of who wrote it, as tables and runs in CSV.
pub const UNSIGNED: Kind = Kind { name: "anything", is_one: |_| false };

/// What stands in the first lines of the programs that `export` writes, in any format but the brick's executable.
const PROGRAMS: [&str; 4] = [
    "A six-tuple controller",
    "A simulator's networks in fixed point",
    "commands for the LEGO NXT with standard firmware",
    "use mindgap_core::fixed_network",
];
/// How a brick's executable begins.
const EXECUTABLE: &[u8] = b"MindstormsNXT\0";
/// A program says in this many lines what it is.
const FIRST_LINES: usize = 4;

fn is_program(content: &[u8]) -> bool {
    let mut first_lines = text(content).lines().take(FIRST_LINES);
    content.starts_with(EXECUTABLE) || first_lines.any(|line| PROGRAMS.iter().any(|sign| line.contains(sign)))
}

/// Whether content is a JSON object with these keys.
fn has_keys(content: &[u8], keys: &[&str]) -> bool {
    let object = serde_json::from_slice::<BTreeMap<String, IgnoredAny>>(content);
    object.is_ok_and(|object| keys.iter().all(|key| object.contains_key(*key)))
}

fn text(content: &[u8]) -> &str {
    std::str::from_utf8(content).unwrap_or_default()
}
