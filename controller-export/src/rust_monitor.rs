//! The constants of the monitor on board as Rust source, for a program that depends on `mindgap-core`.

use mindgap_core::monitor::{CHANNELS, FUNCTIONS, Law, POINTS, Whitening};

/// Returns a Rust source file with the static `LAW`.
pub fn rust_monitor(law: &Law) -> String {
    let functions: String = law.correction.functions.iter().map(function).collect();
    let whitening: String = law.whitening.iter().map(whitening).collect();
    let [along, across] = law.travel;
    format!(
        "use mindgap_core::monitor::{{Correction, Factor, Gains, Law, Whitening}};

/// What the monitor knows of the unchanged robot.
pub static LAW: Law = Law {{
    share_of_command: {:?},
    travel: [{along:?}, {across:?}],
    straight_travel: {},
    step_ms: {},
    per_step_ms: {},
    correction: Correction {{ functions: &FUNCTIONS, shifts: {:?} }},
    whitening: [
{whitening}    ],
    factors: {:?},
    sign: {},
    most_paused_steps: {},
    threshold: {},
}};

static FUNCTIONS: [[[i16; {CHANNELS}]; {POINTS}]; {FUNCTIONS}] = [
{functions}];
",
        law.share_of_command,
        law.straight_travel,
        law.step_ms,
        law.per_step_ms,
        law.correction.shifts,
        law.factors,
        law.sign,
        law.most_paused_steps,
        law.threshold,
    )
}

fn function(values: &[[i16; CHANNELS]; POINTS]) -> String {
    format!("    {values:?},\n")
}

fn whitening(whitening: &Whitening) -> String {
    let Whitening { scale, gains, by_travel } = whitening;
    let gains: String = gains
        .iter()
        .map(|gains| {
            let gains: String = gains.iter().map(|gains| format!("                    {gains:?},\n")).collect();
            format!("                [\n{gains}                ],\n")
        })
        .collect();
    format!(
        "        Whitening {{
            scale: {scale:?},
            gains: [
{gains}            ],
            by_travel: {by_travel:?},
        }},\n"
    )
}
