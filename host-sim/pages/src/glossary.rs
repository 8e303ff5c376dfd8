//! What the words of a page mean.

use maud::html;

use super::document::Section;

const WORDS: &[(&str, &str)] = &[
    (
        "gap",
        "What the robot does and the simulator does not expect, beyond the scatter that the simulator knows of. It is \
         what makes a controller work in simulation and fail on the robot.",
    ),
    (
        "effect",
        "One thing that is there in reality and not in the simulator, such as a battery that empties or a sensor that \
         is mounted turned.",
    ),
    (
        "nat",
        "The unit in which likelihood is counted: where the logs are one nat likelier, they are 2.7 times as likely. \
         Thirty nats are beyond any doubt; a tenth of a nat a step adds up to that in 300 steps.",
    ),
    (
        "95 % interval",
        "Had one driven other runs of the same kind, the number would have come out within this range 19 times of 20. \
         It is written in brackets behind the number.",
    ),
    (
        "probability",
        "How often an answer like this one was right on hundreds of made-up robots whose effects were known.",
    ),
    (
        "scatter",
        "The same command from the same place does not lead to the same end. Nothing that follows rules reduces it.",
    ),
    ("unexplained", "What follows circumstances (speed, place, time, distance) and is described by no named effect."),
    (
        "channel",
        "One of the five things that a simulator predicts of a step: its motion forward and sideways, its turn, whether \
         the sonar hears an echo, and what it reads.",
    ),
    ("step", "The time between two commands; a row of a log. Steps are the smallest thing that is compared."),
    (
        "heading",
        "The direction in which the robot looks: 0° is along x, to the right of the map, and 90° along y, upwards.",
    ),
    ("incidence", "The angle between the sensor's axis and the normal of the surface that it meets: 0° is square on."),
    (
        "open loop",
        "The simulator drives by the logged commands alone and is not told where the robot was on the way. Errors \
         add up.",
    ),
];

/// The words that are used in a page's other sections.
pub fn section() -> Section {
    let body = html! { dl { @for (word, meaning) in WORDS { dt { (word) } dd { (meaning) } } } };
    Section { id: "words", title: "Glossary", body }
}
