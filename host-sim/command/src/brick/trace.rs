//! The trace of an emulated program, as text and as JSON.

use std::fmt::Write;

use mindgap_controller_export::brick::{CodeLocation, Drive, Event, EventKind, Report, Termination};
use serde_json::{Value, json};

const MOTORS: [char; 3] = ['A', 'B', 'C'];

/// Returns one line per event, the files, and how the program ended.
pub fn text(report: &Report) -> String {
    let mut text = String::new();
    for Event { t_ms, kind } in &report.events {
        let _ = match kind {
            EventKind::Motor { port, drive } => {
                writeln!(text, "{t_ms:>7} ms  motor {}  {}", MOTORS[*port], drive_word(*drive))
            }
            EventKind::Tone { hz, ms } => writeln!(text, "{t_ms:>7} ms  tone     {hz} Hz for {ms} ms"),
            EventKind::Sound(name) => writeln!(text, "{t_ms:>7} ms  sound    {name:?}"),
            EventKind::Text { x, y, text: drawn } => writeln!(text, "{t_ms:>7} ms  text     {drawn:?} at {x}, {y}"),
        };
    }
    if report.further_events > 0 {
        let _ = writeln!(text, "and {} more events (--limit-events)", report.further_events);
    }
    for (name, content) in &report.files {
        let _ = writeln!(text, "file {name}, {} bytes", content.len());
        for line in String::from_utf8_lossy(content).lines() {
            let _ = writeln!(text, "  {}", line.escape_debug());
        }
    }
    let motors = MOTORS.iter().zip(report.motors).map(|(name, drive)| format!("{name} {}", drive_word(drive)));
    let Report { ended_ms, instructions, pool_bytes, .. } = report;
    let _ = writeln!(
        text,
        "{} after {ended_ms} ms; motors: {}",
        end_words(report.end),
        motors.collect::<Vec<_>>().join(", ")
    );
    if let Some(CodeLocation { clump, word, instruction, .. }) = &report.failed_at {
        let _ = writeln!(text, "at word {word} of clump {clump}: {instruction}");
    }
    let _ = writeln!(text, "{instructions} instructions, {pool_bytes} bytes of memory");
    text
}

/// Returns the trace as JSON.
pub fn json(report: &Report) -> Value {
    let event = |Event { t_ms, kind }: &Event| match kind {
        EventKind::Motor { port, drive: Drive::Power(power) } => {
            json!({"t_ms": t_ms, "motor": MOTORS[*port], "power": power})
        }
        EventKind::Motor { port, drive } => json!({"t_ms": t_ms, "motor": MOTORS[*port], "drive": drive_word(*drive)}),
        EventKind::Tone { hz, ms } => json!({"t_ms": t_ms, "tone_hz": hz, "tone_ms": ms}),
        EventKind::Sound(name) => json!({"t_ms": t_ms, "sound": name}),
        EventKind::Text { x, y, text } => json!({"t_ms": t_ms, "text": text, "x": x, "y": y}),
    };
    let files: serde_json::Map<_, _> = report
        .files
        .iter()
        .map(|(name, content)| (name.clone(), Value::from(String::from_utf8_lossy(content).into_owned())))
        .collect();
    let failed_at = report.failed_at.as_ref().map(
        |CodeLocation { clump, word, instruction, .. }| json!({"clump": clump, "word": word, "instruction": instruction}),
    );
    json!({
        "schema": 1,
        "end": end_words(report.end),
        "failed_at": failed_at,
        "ended_ms": report.ended_ms,
        "instructions": report.instructions,
        "pool_bytes": report.pool_bytes,
        "motors": report.motors.map(drive_word),
        "events": report.events.iter().map(event).collect::<Vec<_>>(),
        "further_events": report.further_events,
        "files": files,
    })
}

fn drive_word(drive: Drive) -> String {
    match drive {
        Drive::Power(power) => power.to_string(),
        Drive::Brake => "brake".into(),
        Drive::Coast => "coast".into(),
    }
}

fn end_words(end: Termination) -> String {
    match end {
        Termination::Finished => "finished".into(),
        Termination::Aborted => "aborted by the dark button".into(),
        Termination::OutOfTime => "still running, stopped".into(),
        Termination::Failed(fault) => format!("failed: {fault}"),
    }
}
