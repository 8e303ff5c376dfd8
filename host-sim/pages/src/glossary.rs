//! The glossary of a page.

use maud::html;

use super::document::Section;

const WORDS: &[(&str, &str)] = &[
    (
        "gap",
        "The difference between the robot and the simulator, beyond the scatter that the simulator predicts. It makes \
         controllers fail on the robot that work in simulation.",
    ),
    (
        "effect",
        "Something that the real robot has and the simulator lacks, such as a battery that runs down or a sensor that is \
         mounted at an angle.",
    ),
    (
        "nat",
        "The unit of log-likelihood: one nat more means that the logs are 2.7 times as likely. Thirty nats are beyond any \
         doubt; a tenth of a nat per step adds up to that in 300 steps.",
    ),
    (
        "95 % interval",
        "With other runs of the same kind, the number would be within this range 19 times out of 20. It is in brackets \
         after the number.",
    ),
    (
        "probability",
        "The share of answers like this one that were right on hundreds of simulated robots with known effects.",
    ),
    (
        "scatter",
        "The same command from the same place does not lead to the same end. It follows no rule, so no effect reduces it.",
    ),
    (
        "unexplained",
        "The part of the gap that depends on circumstances (speed, place, time, distance) but that no named effect describes.",
    ),
    (
        "channel",
        "One of the five quantities that a simulator predicts for a step: the motion forward and sideways, the turn, \
         whether the sonar receives an echo, and its reading.",
    ),
    ("step", "The time between two commands; a row of a log. Logs and simulator are compared step by step."),
    (
        "heading",
        "The direction in which the robot faces: 0° is along x, to the right on the map, and 90° along y, upwards.",
    ),
    (
        "incidence angle",
        "The angle between the sensor's axis and the normal of the surface that it hits: 0° is head-on.",
    ),
    (
        "open loop",
        "The simulator drives by the logged commands alone, without the robot's logged positions. Errors add up.",
    ),
];

/// The section.
pub fn section() -> Section {
    let body = html! { dl { @for (word, meaning) in WORDS { dt { (word) } dd { (meaning) } } } };
    Section { id: "words", title: "Glossary", body }
}
