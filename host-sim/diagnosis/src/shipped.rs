//! Figures that a command of this program measures, as files that are compiled into it. The first line is the command.

use serde::Serialize;
use serde::de::DeserializeOwned;

/// What the first line begins with.
const MADE_BY: &str = "# Made by: ";

/// Reads a file. Failing to do so is a fault of the program; a test of each file reads it.
pub fn read<T: DeserializeOwned>(text: &str) -> T {
    toml::from_str(text).expect("shipped figures are as the command writes them")
}

/// Returns the text of a file of figures.
pub fn to_text(figures: &impl Serialize, command: &str) -> String {
    let figures = toml::to_string(figures).expect("numbers can be written");
    format!("{MADE_BY}{command}\n{figures}")
}

/// Returns the command that made a file.
#[cfg(test)]
pub fn command(text: &str) -> &str {
    text.lines().next().and_then(|line| line.strip_prefix(MADE_BY)).expect("a first line")
}
