//! The trace of an emulated program as text.

use std::fmt::Write;

use mindgap_controller_export::brick::{CodeLocation, Drive, Event, EventKind, Report, Termination};

/// Names of the motors.
pub(super) const MOTORS: [char; 3] = ['A', 'B', 'C'];

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

/// Returns the power of a motor, or how it is stopped.
pub(super) fn drive_word(drive: Drive) -> String {
    match drive {
        Drive::Power(power) => power.to_string(),
        Drive::Brake => "brake".into(),
        Drive::Coast => "coast".into(),
    }
}

/// Returns how a program ended, in words.
pub(super) fn end_words(end: Termination) -> String {
    match end {
        Termination::Finished => "finished".into(),
        Termination::Aborted => "aborted by the dark button".into(),
        Termination::OutOfTime => "still running, stopped".into(),
        Termination::Failed(fault) => format!("failed: {fault}"),
    }
}
