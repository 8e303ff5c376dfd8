//! Faults of log files as spreadsheets, loggers and people make them. `check` names each, and no such log is diagnosed.
//!
//! Faults in the meaning of numbers (units, frames, clocks) are in `tests/inspection.rs`.

use mindgap_tests::command::Sandbox;

/// A fault of a run's file, and a part of the message about it.
struct Fault {
    what: &'static str,
    message: &'static str,
    put: fn(&str) -> Vec<u8>,
}

const fn fault(what: &'static str, message: &'static str, put: fn(&str) -> Vec<u8>) -> Fault {
    Fault { what, message, put }
}

/// Faults of one run that make it unreadable.
const REFUSED: [Fault; 22] = [
    fault("semicolons", ":1: columns are separated by semicolons", |text| text.replace(',', ";").into()),
    fault("tabs", ":1: columns are separated by tabs", |text| text.replace(',', "\t").into()),
    fault("blanks", ":1: columns are separated by spaces", |text| text.replace(',', " ").into()),
    fault("decimal commas", "write numbers with a decimal point", |text| {
        text.replace(',', ";").replace('.', ",").into()
    }),
    fault("quoted decimal commas", ":2: x_cm = \"1,5\" is not a number; write a decimal point", |text| {
        with_cells(text, |_, cells| cells[3] = "\"1,5\"".into())
    }),
    fault("UTF-16 with a mark", ": is UTF-16", |text| {
        [0xFEFF].into_iter().chain(text.encode_utf16()).flat_map(u16::to_le_bytes).collect()
    }),
    fault("UTF-16 without", ": is UTF-16", |text| text.encode_utf16().flat_map(u16::to_be_bytes).collect()),
    fault("Latin-1", ":1: is not UTF-8: save it as UTF-8", |text| {
        let (header, rows) = text.split_once("battery_mv").expect("a column");
        [header.as_bytes(), b"ger\xE4usch", rows.as_bytes()].concat()
    }),
    fault("capitals", ":1: column t_ms is in capitals", |text| {
        let (header, rows) = text.split_once('\n').expect("a header");
        format!("{}\n{rows}", header.to_uppercase()).into()
    }),
    fault("a commented header", ":1: the header starts with the comment sign #", |text| format!("# {text}").into()),
    fault("no header", ":1: the header is missing: write t_ms,left,right,", |text| {
        text.split_once('\n').expect("a header").1.into()
    }),
    fault("other names", ":1: columns left, right are missing; unknown columns are l, r", |text| {
        text.replacen("left,right", "l,r", 1).into()
    }),
    fault("Unix time in ms", "is Unix time in ms: write milliseconds since the start of the run", |text| {
        with_cells(text, |t_ms, cells| cells[0] = format!("{}", 1_731_337_261_000 + t_ms))
    }),
    fault("Unix time in seconds", "is Unix time in s: write milliseconds since the start of the run", |text| {
        with_cells(text, |t_ms, cells| cells[0] = format!("{}", 1_731_337_261.0 + t_ms as f64 / 1000.0))
    }),
    fault("dates", "is not a number but a date; write milliseconds since the start of the run", |text| {
        with_cells(text, |t_ms, cells| cells[0] = format!("2024-11-11T15:01:{:02}Z", t_ms / 1000))
    }),
    fault("two runs in one file", "is not later than the row before (", |text| {
        let rows = text.split_once('\n').expect("a header").1;
        format!("{text}{rows}").into()
    }),
    fault("two files in one", "the header is repeated here; write each run to its own file", |text| {
        format!("{text}{text}").into()
    }),
    fault("rows doubled", ":3: t_ms = 0 is duplicated: write each row once", |text| {
        let mut lines = text.lines();
        let header = lines.next().expect("a header");
        format!("{header}\n{}", lines.map(|line| format!("{line}\n{line}\n")).collect::<String>()).into()
    }),
    fault("a line torn", "cells where the header has 10: incomplete or malformed line", |text| {
        let end = text.trim_end().rfind(',').expect("cells");
        text[..end].into()
    }),
    fault("power of 0..255", "lies outside -100..100", |text| {
        with_cells(text, |_, cells| {
            let power: f64 = cells[1].parse().expect("a command");
            cells[1] = (2.55 * power + 90.0 * power.signum()).to_string();
        })
    }),
    fault("NaN where the tracker lost it", "leave the cell empty if there is no value", |text| {
        with_cells(text, |_, cells| cells[3..6].fill("NaN".into()))
    }),
    fault("words for nothing", "x_cm = \"NA\" is not a number; leave the cell empty if there is no value", |text| {
        with_cells(text, |_, cells| cells[3..6].fill("NA".into()))
    }),
];

/// Faults of all runs together that contradict their robot.toml.
const OF_ALL: [Fault; 2] = [
    fault("every second row missing", "apart, but robot.toml has step_ms = 400", |text| {
        let mut line = 0;
        let is_kept = |_: &&str| {
            line += 1;
            line == 1 || line % 2 == 0
        };
        text.lines().filter(is_kept).map(|line| format!("{line}\n")).collect::<String>().into()
    }),
    fault("seconds", "t_ms seems to be in seconds; write milliseconds", |text| {
        with_cells(text, |t_ms, cells| cells[0] = format!("{}", t_ms as f64 / 1000.0))
    }),
];

/// Returns a text with changed cells in every row below the header. `change` takes the row's time and cells.
fn with_cells(text: &str, change: impl Fn(u64, &mut [String])) -> Vec<u8> {
    let (header, rows) = text.split_once('\n').expect("a header");
    let changed = rows.lines().map(|row| {
        let mut cells: Vec<String> = row.split(',').map(str::to_owned).collect();
        change(cells[0].parse().expect("a time"), &mut cells);
        cells.join(",") + "\n"
    });
    format!("{header}\n{}", changed.collect::<String>()).into()
}

fn assert_refused(good: &Sandbox, fault: &Fault, runs: &[usize]) {
    let sandbox = good.copy();
    for run in runs {
        let file = format!("logs/run-{run:03}.csv");
        sandbox.write(&file, (fault.put)(&sandbox.text(&file)));
    }
    for call in ["check logs", "diagnose kinematic logs --json diagnosis.json"] {
        let refusal = sandbox.refused(call);
        assert!(refusal.contains(fault.message), "{}: {call}: {refusal}", fault.what);
    }
}

#[test]
fn unreadable_logs_are_named_and_not_diagnosed() {
    let good = Sandbox::with_logs();
    REFUSED.iter().for_each(|fault| assert_refused(&good, fault, &[3]));
    OF_ALL.iter().for_each(|fault| assert_refused(&good, fault, &[0, 1, 2, 3, 4, 5]));
}

/// Some editors write a byte order mark at the start of a file.
#[test]
fn a_byte_order_mark_is_ignored_with_a_warning() {
    let sandbox = Sandbox::with_logs();
    let good = sandbox.run("check logs --json -");
    for file in ["run-002.csv", "robot.toml", "scene.toml"].map(|name| format!("logs/{name}")) {
        sandbox.edit(&file, |text| format!("\u{FEFF}{text}"));
    }
    let outcome = sandbox.call("check logs --json -");
    assert_eq!((outcome.code, outcome.out), (0, good));
    let warning = "mindgap: warning: logs/run-002.csv: starts with a byte-order mark (ignored)\n";
    assert_eq!(outcome.err, warning);
}
