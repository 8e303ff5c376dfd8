//! Manual pages in Markdown, generated from the definition of the command line.

use clap::builder::StyledStr;
use clap::{Arg, ArgAction, Command};

use super::{HELP, NAME};
use crate::guide;

/// Returns the page of a built command and its subcommands.
pub fn page(command: &Command) -> String {
    section(command, 1)
}

/// Returns the overview of all commands and the options common to them.
pub fn overview(command: &Command) -> String {
    let mut text = heading(command, 1);
    for (title, names) in guide::parts() {
        text += &format!("\n## {title}\n\n");
        for name in names {
            let about = command.find_subcommand(name).and_then(Command::get_about);
            text += &format!("- [{NAME} {name}]({NAME}-{name}.md): {}\n", words(about));
        }
    }
    text += "\n## Options of all commands\n\n";
    text += &options(command).map(entry).collect::<String>();
    text
}

fn section(command: &Command, level: usize) -> String {
    let mut text = heading(command, level);
    let arguments: Vec<&Arg> = command.get_positionals().collect();
    let options: Vec<&Arg> = options(command).filter(|option| !option.is_global_set()).collect();
    for (title, of) in [("Arguments", arguments), ("Options", options)] {
        if !of.is_empty() {
            let entries: String = of.into_iter().map(entry).collect();
            text += &format!("\n{} {title}\n\n{entries}", "#".repeat(level + 1));
        }
    }
    if let Some(after) = command.get_after_help() {
        text += &format!("\n```text\n{}\n```\n", after.to_string().trim_end());
    }
    for inner in command.get_subcommands().filter(|inner| inner.get_name() != HELP) {
        text += &format!("\n{}", section(inner, level + 1));
    }
    text
}

/// Returns the options other than help and version.
fn options(command: &Command) -> impl Iterator<Item = &Arg> {
    let is_usual = |of: &Arg| {
        matches!(of.get_action(), ArgAction::Help | ArgAction::HelpShort | ArgAction::HelpLong | ArgAction::Version)
    };
    command.get_arguments().filter(move |of| !of.is_positional() && !is_usual(of))
}

/// Returns the name, purpose and usage of a command.
fn heading(command: &Command, level: usize) -> String {
    let name = command.get_bin_name().unwrap_or(command.get_name());
    let about = words(command.get_long_about().or(command.get_about()));
    let usage = command.clone().render_usage().to_string();
    let usage = usage.trim_start_matches("Usage:").trim();
    format!("{} {name}\n\n{about}\n\n```text\n{usage}\n```\n", "#".repeat(level))
}

/// Returns an argument or option as a list item.
fn entry(of: &Arg) -> String {
    let short = of.get_short().map_or_else(String::new, |short| format!("`-{short}`, "));
    let mut text = format!("- {short}`{of}`: {}", words(of.get_long_help().or(of.get_help())));
    if of.get_action().takes_values() {
        let defaults: Vec<String> = of.get_default_values().iter().map(|it| format!("`{}`", it.display())).collect();
        if !defaults.is_empty() {
            text += &format!(" Default: {}.", defaults.join(", "));
        }
        for value in of.get_possible_values() {
            text += format!("\n  - `{}`: {}", value.get_name(), words(value.get_help())).trim_end_matches(": ");
        }
    }
    text + "\n"
}

/// Returns a text on one line, ending with a full stop.
fn words(text: Option<&StyledStr>) -> String {
    let text = text.map(ToString::to_string).unwrap_or_default();
    let line = text.split_whitespace().collect::<Vec<&str>>().join(" ");
    if line.is_empty() || line.ends_with('.') { line } else { line + "." }
}
