//! Standard error: errors, warnings, and decisions with `--verbose`.

use std::io::{self, Write};

use log::{Level, LevelFilter, Log, Metadata, Record};

use super::progress;

/// Writes log records to standard error.
struct StderrLogger;

impl Log for StderrLogger {
    fn enabled(&self, metadata: &Metadata) -> bool {
        // Records of other libraries do not help the user.
        metadata.target().starts_with("mindgap") && metadata.level() <= log::max_level()
    }

    fn log(&self, record: &Record) {
        if self.enabled(record.metadata()) {
            let prefix = if record.level() == Level::Warn { "warning: " } else { "" };
            line(&format!("mindgap: {prefix}{}", printable(&record.args().to_string())));
        }
    }

    fn flush(&self) {}
}

/// Logs records up to this level of verbosity.
pub fn set_level(level: LevelFilter) {
    // A second call finds the same logger already installed.
    let _ = log::set_logger(&StderrLogger);
    log::set_max_level(level);
}

/// Prints the error that ended a command.
pub fn error(message: &str) {
    line(&format!("mindgap: {}", printable(message)));
}

/// Prints the status of a long command, unless `--quiet` is given.
pub fn status(message: &str) {
    if !progress::is_quiet() {
        line(&printable(message));
    }
}

/// Escapes control characters and direction marks, since file names may contain anything.
pub fn printable(line: &str) -> String {
    let shown =
        |c: char| if c.is_control() || is_invisible(c) { c.escape_default().to_string() } else { c.to_string() };
    line.chars().map(shown).collect()
}

/// Returns whether a character is an invisible mark of direction or joining, which changes how its neighbours appear.
fn is_invisible(c: char) -> bool {
    matches!(c, '\u{200B}'..='\u{200F}' | '\u{2028}'..='\u{202E}' | '\u{2060}'..='\u{206F}' | '\u{FEFF}')
}

/// Writes a line to standard error and ignores failure.
fn line(text: &str) {
    progress::suspended(|| {
        let _ = writeln!(io::stderr(), "{text}");
    });
}
