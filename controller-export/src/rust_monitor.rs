//! The constants of the monitor on board as Rust source, for a program that depends on `mindgap-core`.

use mindgap_core::monitor::{CHANNELS, Direction, Gains, Law, Whitening};

/// Returns a Rust source file with the static `LAW`.
pub fn rust_monitor(law: &Law) -> String {
    let directions: String = law.directions.iter().map(direction).collect();
    let functions = |channel: usize| {
        let rows = law.correction[channel].functions.iter().map(|values| format!("    {values:?},\n"));
        format!("[\n{}]", rows.collect::<String>())
    };
    let correction = |channel: usize, name: &str| {
        format!("        Correction {{ functions: &{name}, shift: {} }},\n", law.correction[channel].shift)
    };
    let whitening: String = law.whitening.iter().map(whitening).collect();
    let correction: String = [correction(0, "OF_FORWARD"), correction(1, "OF_TURN")].concat();
    format!(
        "use mindgap_core::monitor::{{Correction, Direction, Gains, Law, Response, Whitening}};

/// What the monitor knows of the unchanged robot.
pub static LAW: Law = Law {{
    share_of_command: {},
    travel: {:?},
    straight_travel: {},
    step_ms: {},
    per_step_ms: {},
    correction: [
{correction}    ],
    whitening: [
{whitening}    ],
    directions: &[
{directions}    ],
    most_paused_steps: {},
    threshold: {},
}};

static OF_FORWARD: [[i16; 33]; 6] = {};

static OF_TURN: [[i16; 33]; 6] = {};
",
        law.share_of_command,
        law.travel,
        law.straight_travel,
        law.step_ms,
        law.per_step_ms,
        law.most_paused_steps,
        law.threshold,
        functions(0),
        functions(CHANNELS - 1),
    )
}

fn direction(direction: &Direction) -> String {
    let Direction { response, forward, turn, grows, is_opposite } = direction;
    format!(
        "        Direction {{ response: Response::{response:?}, forward: {forward:?}, turn: {turn:?}, grows: {grows}, \
         is_opposite: {is_opposite} }},\n"
    )
}

fn whitening(whitening: &Whitening) -> String {
    let Whitening { scale, shift, gains, by_travel } = whitening;
    let gains: String = gains
        .iter()
        .map(|gains| {
            let gains = gains.iter().map(|Gains { precision, error, tracker, shift }| {
                format!("                    Gains {{ precision: {precision}, error: {error}, tracker: {tracker}, shift: {shift} }},\n")
            });
            format!("                [\n{}                ],\n", gains.collect::<String>())
        })
        .collect();
    format!(
        "        Whitening {{
            scale: {scale},
            shift: {shift},
            gains: [
{gains}            ],
            by_travel: {by_travel:?},
        }},\n"
    )
}
