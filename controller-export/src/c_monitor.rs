//! The monitor on board as C99, which follows the networks of [`c_networks`](crate::c_networks) in one header. Its evidence
//! equals the core's to the bit.

use std::fmt::Write;

use mindgap_core::monitor::{
    DIRECTIONS, Factor, HELD, LARGER, Law, MOST_NATS, NAT_BITS, REGAINED_AFTER, SIZES, TRAVELS, Whitening,
};

const MONITOR: &str = include_str!("c_monitor/monitor.h");

/// Returns the text that follows the networks `forward` and `turn` in a header. `names` are those of the directions.
pub fn c_monitor(law: &Law, names: &[&str; DIRECTIONS]) -> String {
    let mut text = String::from(
        "/* AVR processors need special instructions to read their flash. */\n\
         #ifdef __AVR__\n\
         #define MONITOR_READ(address) ((int32_t)(int16_t)pgm_read_word(address))\n\
         #else\n\
         #define MONITOR_READ(address) ((int32_t)*(address))\n\
         #endif\n\n",
    );
    let [along, across] = law.travel;
    let constants = [
        ("DIRECTIONS", DIRECTIONS as i64),
        ("SIZES", SIZES as i64),
        ("LARGER", i64::from(LARGER)),
        ("HELD", HELD as i64),
        ("TRAVELS", TRAVELS as i64),
        ("MOST_NATS", i64::from(MOST_NATS) << NAT_BITS),
        ("REGAINED_AFTER", i64::from(REGAINED_AFTER)),
        ("MOST_PAUSED_STEPS", i64::from(law.most_paused_steps)),
        ("THRESHOLD", i64::from(law.threshold)),
        ("STRAIGHT_TRAVEL", i64::from(law.straight_travel)),
        ("SIGN", i64::from(law.sign)),
        ("STEP_MS", i64::from(law.step_ms)),
        ("PER_STEP_MS", i64::from(law.per_step_ms)),
    ];
    for (name, value) in constants {
        let _ = writeln!(text, "#define MONITOR_{name} {value}");
    }
    let factors =
        [("SHARE", law.share_of_command), ("ALONG", along), ("ACROSS", across)].map(|(name, f)| (name, c_factor(f)));
    for (name, factor) in factors {
        let _ = writeln!(text, "#define MONITOR_{name} {factor} /* Factor, shift and limit. */");
    }
    let _ = writeln!(
        text,
        "\n/* The directions; each has MONITOR_SIZES alternatives, the last two are wider residuals. */"
    );
    for (i, name) in names.iter().enumerate() {
        let _ = writeln!(text, "/* {i}: {name} */");
    }
    let flash = |declaration: &str, numbers: Vec<i16>| {
        let numbers: Vec<String> = numbers.iter().map(i16::to_string).collect();
        let lines: String = numbers.chunks(11).map(|line| format!("  {},\n", line.join(", "))).collect();
        format!("static const int16_t {declaration} NETWORK_FLASH = {{\n{lines}}};\n")
    };
    let functions = law.correction.functions.as_flattened().as_flattened();
    text += &flash("monitor_functions[]", functions.to_vec());
    text += &flash("monitor_gains[]", law.whitening.iter().flat_map(gains).collect());
    text += &flash("monitor_by_travel[]", law.whitening.iter().flat_map(|w| w.by_travel).collect());
    text += "/* By channel: of travel, and of its change. */\n";
    text += &flash("monitor_factors[]", law.factors.as_flattened().to_vec());
    text += "/* Factor, shift and limit of residuals, and shift of functions. */\n";
    let scales = law.whitening.iter().zip(law.correction.shifts);
    let scales =
        scales.flat_map(|(w, shift)| [w.scale.factor, i16::from(w.scale.shift), w.scale.most, i16::from(shift)]);
    text += &flash("monitor_scales[]", scales.collect());
    text + "\n" + MONITOR
}

fn c_factor(factor: Factor) -> String {
    let Factor { factor, shift, most } = factor;
    format!("{factor}, {shift}, {most}")
}

/// Gains of a known and of an unknown error of the tracker, by the steps for which a command is held.
fn gains(whitening: &Whitening) -> Vec<i16> {
    let gains = whitening.gains.as_flattened().iter();
    gains.flat_map(|g| [g.precision, g.error, g.tracker, g.shift]).collect()
}
