//! Command lines in the blocks of a document.

use libtest_mimic::Failed;

use crate::is_asked_for;

/// A line that calls the command.
pub struct CommandLine {
    /// Its number in the document, from 1.
    pub number: usize,
    /// The call.
    pub text: String,
    /// Whether it stands in a console that is run.
    pub is_run: bool,
}

/// How blocks are marked whose lines are run,
const CONSOLE: &str = "console";
/// and those whose lines take longer than a test may.
const SLOW: &str = "console,slow";
/// How blocks begin and end.
pub const FENCE: &str = "```";
/// What stands before a command in a console.
pub const PROMPT: &str = "$ ";

/// Whether a block of this kind is run.
pub fn is_run(kind: &str) -> bool {
    kind == CONSOLE || kind == SLOW && is_asked_for("slow")
}

/// The lines of all blocks that call the command; usage, which has placeholders, is none.
pub fn command_lines(text: &str) -> Vec<CommandLine> {
    let mut block: Option<&str> = None;
    let mut found = Vec::new();
    for (i, line) in text.lines().enumerate() {
        if let Some(kind) = line.strip_prefix(FENCE) {
            block = if block.is_some() { None } else { Some(kind) };
            continue;
        }
        let Some(kind) = block else { continue };
        let is_console = kind.starts_with(CONSOLE);
        let call = if is_console { line.strip_prefix(PROMPT) } else { Some(line.trim_start()) };
        let call = call.filter(|call| call.starts_with("mindgap ") && !call.contains(['<', '[']));
        if let Some(call) = call {
            found.push(CommandLine { number: i + 1, text: call.trim_end().into(), is_run: is_run(kind) });
        }
    }
    found
}

/// Whether the command takes every call.
pub fn are_calls(text: &str) -> Result<(), Failed> {
    let wrong: Vec<String> = command_lines(text).iter().filter_map(refusal).collect();
    if wrong.is_empty() { Ok(()) } else { Err(wrong.join("\n").into()) }
}

/// Why the command does not take a call.
fn refusal(CommandLine { number, text, .. }: &CommandLine) -> Option<String> {
    // A comment follows an example; where its output goes is not the command's business.
    let call = text.split("    ").next().and_then(|call| call.split(" > ").next()).unwrap_or_default();
    let Some(words) = shlex::split(call) else { return Some(format!("line {number}: {text}: quotes are open")) };
    let error = mindgap_command::command().try_get_matches_from(words).err()?;
    // Help that is asked for is not an error.
    error.use_stderr().then(|| format!("line {number}: {text}: {error}"))
}
