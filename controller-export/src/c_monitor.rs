//! The monitor on board as C99, which follows the networks of [`c_networks`](crate::c_networks) in one header. Its evidence
//! equals the core's to the bit.

use std::fmt::Write;

use mindgap_core::monitor::{
    CHANNELS, Direction, HELD, Law, MOST_NATS, NAT_BITS, REGAINED_AFTER, Response, SIZES, TRAVELS, Whitening,
};

const MONITOR: &str = include_str!("c_monitor/monitor.h");

/// Returns the text that follows the networks `forward` and `turn` in a header. `names` are those of the directions.
///
/// # Panics
/// When there are more names than directions.
pub fn c_monitor(law: &Law, names: &[&str]) -> String {
    let mut text = String::from(
        "/* AVR processors need special instructions to read their flash. */\n\
         #ifdef __AVR__\n\
         #define MONITOR_READ(address) ((int32_t)(int16_t)pgm_read_word(address))\n\
         #else\n\
         #define MONITOR_READ(address) ((int32_t)*(address))\n\
         #endif\n\n",
    );
    let constants = [
        ("DIRECTIONS", law.directions.len() as i64),
        ("SIZES", SIZES as i64),
        ("HELD", HELD as i64),
        ("TRAVELS", TRAVELS as i64),
        ("MOST_NATS", i64::from(MOST_NATS) << NAT_BITS),
        ("REGAINED_AFTER", i64::from(REGAINED_AFTER)),
        ("MOST_PAUSED_STEPS", i64::from(law.most_paused_steps)),
        ("THRESHOLD", i64::from(law.threshold)),
        ("SHARE_OF_COMMAND", i64::from(law.share_of_command)),
        ("TRAVEL_FORWARD", i64::from(law.travel[0])),
        ("TRAVEL_TURN", i64::from(law.travel[1])),
        ("STRAIGHT_TRAVEL", i64::from(law.straight_travel)),
        ("STEP_MS", i64::from(law.step_ms)),
        ("PER_STEP_MS", i64::from(law.per_step_ms)),
    ];
    for (name, value) in constants {
        let _ = writeln!(text, "#define MONITOR_{name} {value}");
    }
    let _ = writeln!(
        text,
        "\n/* The directions; each has MONITOR_SIZES alternatives, the last two are wider residuals. */"
    );
    for (i, name) in names[..law.directions.len()].iter().enumerate() {
        let _ = writeln!(text, "/* {i}: {name} */");
    }
    let flash = |declaration: String, numbers: Vec<i16>| {
        let numbers: Vec<String> = numbers.iter().map(i16::to_string).collect();
        let lines: String = numbers.chunks(11).map(|line| format!("  {},\n", line.join(", "))).collect();
        format!("static const int16_t {declaration} NETWORK_FLASH = {{\n{lines}}};\n")
    };
    text += &flash(
        format!("monitor_directions[{}]", 7 * law.directions.len()),
        law.directions.iter().flat_map(direction).collect(),
    );
    let functions = |channel: usize| law.correction[channel].functions.as_flattened().iter().copied();
    text += &flash("monitor_functions[]".into(), (0..CHANNELS).flat_map(functions).collect());
    text += &flash("monitor_gains[]".into(), law.whitening.iter().flat_map(gains).collect());
    text += &flash("monitor_by_travel[]".into(), law.whitening.iter().flat_map(|w| w.by_travel).collect());
    let pair = |name: &str, [forward, turn]: [i32; CHANNELS]| {
        format!(
            "static inline int32_t monitor_{name}(uint8_t channel) {{ return channel == 0 ? {forward} : {turn}; }}\n"
        )
    };
    text += &pair("function_shift", law.correction.each_ref().map(|c| i32::from(c.shift)));
    text += &pair("scale", law.whitening.each_ref().map(|w| w.scale));
    text += &pair("scale_shift", law.whitening.each_ref().map(|w| i32::from(w.shift)));
    text + "\n" + MONITOR
}

/// The response, factors of forward and of the turn for each wheel, and whether it grows and is the opposite of the one
/// before.
fn direction(direction: &Direction) -> [i16; 7] {
    let Direction { response, forward, turn, grows, is_opposite } = *direction;
    let response = match response {
        Response::Travel => 0,
        Response::Change => 1,
        Response::Sign => 2,
    };
    [response, forward[0], forward[1], turn[0], turn[1], i16::from(grows), i16::from(is_opposite)]
}

/// Gains of a known and of an unknown error of the tracker, by the steps for which a command is held.
fn gains(whitening: &Whitening) -> Vec<i16> {
    let gains = whitening.gains.as_flattened().iter();
    gains.flat_map(|g| [g.precision, g.error, g.tracker, g.shift]).collect()
}
