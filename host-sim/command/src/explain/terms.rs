//! Explanations of words that commands print and files contain.

use super::entry::Entry;

/// All words.
pub const TERMS: &[Entry] = &[
    Entry {
        id: "nat",
        what: "The unit of log-likelihood: one nat more means that the logs are 2.7 times as likely. Three nats are strong \
               evidence, 30 are beyond doubt.",
        imitated_by: "",
        check: "Divide by the number of steps to compare logs of different lengths.",
    },
    Entry {
        id: "kinematic",
        what: "The textbook model, in place of a simulator file: an ideal differential drive and a range sensor with one \
               ideal ray, computed from robot.toml.",
        imitated_by: "",
        check: "Measure every length of robot.toml with a ruler; an error in it looks like a gap of the robot.",
    },
    Entry {
        id: "ambiguous_with",
        what: "Effects that would explain these logs as well as the named one.",
        imitated_by: "",
        check: "Drive the script of `--next-experiment` and diagnose again, or let `--drive` do so until one cause is left.",
    },
    Entry {
        id: "untestable",
        what: "Effects that these logs cannot show: they may be present.",
        imitated_by: "",
        check: "Run `mindgap check` on the logs: it says what to drive.",
    },
    Entry {
        id: "FILL IN",
        what: "Mark on a line of robot.toml or scene.toml whose value is a placeholder or was fitted to the logs.",
        imitated_by: "",
        check: "Measure the length with a ruler, enter it, and delete the mark.",
    },
];
