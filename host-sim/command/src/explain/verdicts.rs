//! Explanations of the verdicts of a diagnosis and of a loop.

use super::entry::Entry;

/// All verdicts.
pub const VERDICTS: &[Entry] = &[
    Entry {
        id: "no_gap",
        what: "The logs agree with the simulator within its own error, on every channel that was compared.",
        imitated_by: "logs with too little excitation: `not_compared` and the untestable effects show what was not tested",
        check: "Log the runs in which the controller fails, or drive faster, sharper and longer, and diagnose again.",
    },
    Entry {
        id: "known",
        what: "There is a gap, and the named effects explain it. With `scatter` alone, the robot is noisier than the \
               simulator assumes and nothing else differs.",
        imitated_by: "the effects listed as ambiguous: these logs cannot distinguish them",
        check: "Check each named effect by hand as `mindgap explain` describes, or drive the next experiment.",
    },
    Entry {
        id: "partly_known",
        what: "There is a gap. The named effects explain a part of it, and a structured residual is left.",
        imitated_by: "an effect whose variants do not describe this robot exactly",
        check: "Apply the named effects with `--apply`, and diagnose new logs against the result.",
    },
    Entry {
        id: "unknown",
        what: "There is a gap, and no known effect explains it.",
        imitated_by: "a defect of the logs, or several weak effects of which none is confirmed on the held-out runs",
        check: "See where the gap is and what it depends on, run `mindgap check` on the logs, and state a suspected cause \
                as an effect of your own with `--effects`.",
    },
    Entry {
        id: "works",
        what: "The loop ended with a controller that succeeded on the robot often enough and has a high success probability.",
        imitated_by: "",
        check: "Drive `controller.toml` from the same start a few more times.",
    },
    Entry {
        id: "trials_exhausted",
        what: "The loop used up its trials before a controller was confirmed.",
        imitated_by: "",
        check: "See the last line of the report. If noise is the limit, more trials hardly help; otherwise call the loop \
                again with more `--trials`.",
    },
    Entry {
        id: "infeasible",
        what: "The loop found no controller that reaches the target on any plausible robot.",
        imitated_by: "",
        check: "See whether the target is within reach of six tuples, and whether the sensor sees something where the robot \
                has to turn.",
    },
];
