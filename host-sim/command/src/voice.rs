//! What is said on standard error: errors, warnings, and with `--verbose` what is decided on the way.

use std::io::{self, Write};

use log::{Level, LevelFilter, Log, Metadata, Record};

use super::progress;

/// Writes what this program logs.
struct Voice;

impl Log for Voice {
    fn enabled(&self, of: &Metadata) -> bool {
        // What the libraries tell each other is of no use to anybody who drives a robot.
        of.target().starts_with("mindgap") && of.level() <= log::max_level()
    }

    fn log(&self, record: &Record) {
        if self.enabled(record.metadata()) {
            let sign = if record.level() == Level::Warn { "warning: " } else { "" };
            line(&format!("mindgap: {sign}{}", printable(&record.args().to_string())));
        }
    }

    fn flush(&self) {}
}

/// Says what is as grave as this or graver.
pub fn speak_up_to(level: LevelFilter) {
    // A second logger is refused, and is the same as the first.
    let _ = log::set_logger(&Voice);
    log::set_max_level(level);
}

/// Says why nothing came of a command.
pub fn complain(why: &str) {
    line(&format!("mindgap: {}", printable(why)));
}

/// Says how far a long command is, unless nothing is to be said.
pub fn meanwhile(what: &str) {
    if !progress::is_quiet() {
        line(&printable(what));
    }
}

/// A line without what moves a terminal's cursor or turns text round: file names may hold anything.
pub fn printable(line: &str) -> String {
    let shown = |c: char| if c.is_control() || is_unseen(c) { c.escape_default().to_string() } else { c.to_string() };
    line.chars().map(shown).collect()
}

/// Marks of direction and of joining, which are not seen and change what is seen beside them.
fn is_unseen(c: char) -> bool {
    matches!(c, '\u{200B}'..='\u{200F}' | '\u{2028}'..='\u{202E}' | '\u{2060}'..='\u{206F}' | '\u{FEFF}')
}

/// Writes a line to standard error. That nobody can read it ends nothing.
fn line(text: &str) {
    progress::beside(|| {
        let _ = writeln!(io::stderr(), "{text}");
    });
}
