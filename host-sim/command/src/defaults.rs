//! Defaults of options from a file `mindgap.toml` next to the logs. Keys are the long names of options: at the top level
//! for all commands, in a table for one command.
//!
//! The accepted keys follow from the definitions of the command line; there is no separate list.

use std::any::TypeId;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

use clap::parser::ValueSource;
use clap::{Arg, ArgAction, ArgMatches, Command};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use mindgap_files as files;
use mindgap_foundations::error::{Error, Result};

/// File name of the defaults.
const NAME: &str = "mindgap.toml";
/// Id of positional arguments that are folders of logs.
const LOGS: &str = "logs";
/// Options that cannot have a default. `force` could overwrite files of others.
const NEVER: &[&str] = &["force", "help", "version"];

/// Defaults that apply to this call.
#[derive(Default)]
pub struct Defaults {
    path: PathBuf,
    applied: Vec<Applied>,
}

/// One default that applies.
struct Applied {
    line: u64,
    /// The option as clap displays it.
    option: String,
    argument: OsString,
}

/// Returns the call extended by the defaults of its command that it does not set itself.
///
/// # Errors
/// If the file cannot be read, has a key that is not an option, or a value of the wrong type.
pub fn with_defaults(command: &Command, mut call: Vec<OsString>) -> Result<(Vec<OsString>, Defaults)> {
    // Building copies the general options to every subcommand.
    let mut command = command.clone();
    command.build();
    // Errors in the call are reported when it is parsed with the defaults.
    let Ok(stated) = command.clone().ignore_errors(true).try_get_matches_from(&call) else {
        return Ok((call, Defaults::default()));
    };
    let chain = chain(&command, &stated);
    let path = folder(&chain).join(NAME);
    if !path.is_file() {
        return Ok((call, Defaults::default()));
    }
    let text = files::read_text(&path)?;
    let file = File { path: &path, text: &text };
    let applied = file.applied(&command, &chain)?;
    let end = call.iter().position(|argument| argument == "--").unwrap_or(call.len());
    call.splice(end..end, applied.iter().map(|applied| applied.argument.clone()));
    Ok((call, Defaults { path, applied }))
}

impl Defaults {
    /// Logs the defaults that apply.
    pub fn log(&self) {
        for Applied { line, argument, .. } in &self.applied {
            log::info!("{}:{line}: {}", self.path.display(), argument.to_string_lossy());
        }
    }

    /// Returns the error with the line of the default that caused it; exits the process if the call itself is wrong.
    pub fn locate(&self, error: clap::Error) -> Error {
        let words = error.to_string();
        let option = self.applied.iter().find(|applied| words.contains(&format!("'{}'", applied.option)));
        match option {
            Some(applied) if error.use_stderr() => {
                let first = words.lines().next().unwrap_or_default();
                Error::at_line(&self.path, applied.line, first.trim_start_matches("error: "))
            }
            _ => error.exit(),
        }
    }
}

/// Returns the command and the called subcommands, each with its matches.
fn chain<'c>(command: &'c Command, stated: &'c ArgMatches) -> Vec<(&'c Command, &'c ArgMatches)> {
    let mut chain = vec![(command, stated)];
    while let Some((command, matches)) = chain.last().and_then(|(command, matches)| {
        let (name, matches) = matches.subcommand()?;
        Some((command.find_subcommand(name)?, matches))
    }) {
        chain.push((command, matches));
    }
    chain
}

/// Returns the parent of the folder of logs, or the current folder if the call reads no logs.
fn folder(chain: &[(&Command, &ArgMatches)]) -> PathBuf {
    let logs = chain.iter().find_map(|(_, stated)| stated.try_get_one::<PathBuf>(LOGS).ok().flatten());
    logs.and_then(|logs| logs.parent()).map(Path::to_owned).unwrap_or_default()
}

/// The text of a file of defaults.
struct File<'f> {
    path: &'f Path,
    text: &'f str,
}

impl File<'_> {
    /// Returns the defaults for a chain of commands; the table of the innermost command takes precedence.
    fn applied(&self, command: &Command, chain: &[(&Command, &ArgMatches)]) -> Result<Vec<Applied>> {
        let parsed = DeTable::parse(self.text).map_err(|e| {
            let line = e.span().map_or(1, |span| files::line_at(self.text, span.start));
            Error::at_line(self.path, line, e.message().replace('\n', "; "))
        })?;
        self.check(command, parsed.get_ref())?;
        let (called, _) = chain[chain.len() - 1];
        let mut tables = vec![parsed.get_ref()];
        for (subcommand, _) in &chain[1..] {
            let Some(DeValue::Table(table)) = tables[tables.len() - 1].get(subcommand.get_name()).map(Spanned::get_ref)
            else {
                break;
            };
            tables.push(table);
        }
        let is_stated = |option: &Arg| {
            let stated = |matches: &ArgMatches| {
                let is_known = matches.try_contains_id(option.get_id().as_str()).is_ok();
                is_known && matches.value_source(option.get_id().as_str()) == Some(ValueSource::CommandLine)
            };
            chain.iter().any(|(_, matches)| stated(matches))
        };
        // Options of the call override defaults that conflict with them.
        let conflict =
            |a: &Arg, b: &Arg| called.get_arg_conflicts_with(a).iter().any(|other| other.get_id() == b.get_id());
        let is_ruled_out = |option: &Arg| {
            called
                .get_arguments()
                .filter(|other| is_stated(other))
                .any(|other| conflict(option, other) || conflict(other, option))
        };
        let mut applied = Vec::new();
        for option in called.get_arguments() {
            let Some(name) = option.get_long() else { continue };
            let Some((key, value)) = tables.iter().rev().find_map(|table| table.get_key_value(name)) else { continue };
            if !is_stated(option) && !is_ruled_out(option) {
                let line = files::line_at(self.text, key.span().start);
                let arguments = self.arguments(option, value)?;
                let option = option.to_string();
                applied.extend(arguments.map(|argument| Applied { line, option: option.clone(), argument }));
            }
        }
        Ok(applied)
    }

    /// Rejects keys that are neither a subcommand nor an option of the command or of one of its subcommands.
    fn check(&self, command: &Command, table: &DeTable) -> Result<()> {
        let options = options_within(command);
        for (key, value) in table {
            let (name, line) = (key.get_ref().as_ref(), files::line_at(self.text, key.span().start));
            if let (Some(subcommand), DeValue::Table(inner)) = (command.find_subcommand(name), value.get_ref()) {
                self.check(subcommand, inner)?;
                continue;
            }
            let mut meant = options.iter().filter(|option| option.get_long() == Some(name));
            let Some(first) = meant.next() else {
                let names = options.iter().filter_map(|option| option.get_long());
                let commands = command.get_subcommands().map(Command::get_name);
                let like = files::did_you_mean(name, names.chain(commands));
                return Err(Error::at_line(self.path, line, format!("{name} is not an option of mindgap{like}")));
            };
            if meant.any(|other| other.get_value_names() != first.get_value_names()) {
                let what = format!(
                    "{name} means different things in different commands: put it in the table of one, such as [train]"
                );
                return Err(Error::at_line(self.path, line, what));
            }
        }
        Ok(())
    }

    /// Returns the value of an option as command-line arguments.
    fn arguments(&self, option: &Arg, value: &Spanned<DeValue>) -> Result<std::vec::IntoIter<OsString>> {
        let name = option.get_long().unwrap_or_default();
        let line = files::line_at(self.text, value.span().start);
        let wrong = |what: &str| Error::at_line(self.path, line, format!("{name}: {what}"));
        let takes_value = option.get_action().takes_values();
        let one = |value: &DeValue| match (value, takes_value) {
            (DeValue::Boolean(true), false) => Ok(Some(format!("--{name}").into())),
            (DeValue::Boolean(false), false) => Ok(None),
            (_, false) => Err(wrong("must be true or false")),
            (DeValue::String(text), true) => Ok(Some(self.argument(option, text))),
            (DeValue::Integer(number), true) => Ok(Some(format!("--{name}={number}").into())),
            (DeValue::Float(number), true) => Ok(Some(format!("--{name}={number}").into())),
            _ => Err(wrong("must be a quoted string or a number")),
        };
        let arguments: Result<Vec<Option<OsString>>> = match value.get_ref() {
            DeValue::Array(values) if matches!(option.get_action(), ArgAction::Append) => {
                values.iter().map(|value| one(value.get_ref())).collect()
            }
            single => one(single).map(|argument| vec![argument]),
        };
        Ok(arguments?.into_iter().flatten().collect::<Vec<OsString>>().into_iter())
    }

    /// Returns an option with a string value; relative paths are resolved against the folder of the file of defaults.
    fn argument(&self, option: &Arg, text: &str) -> OsString {
        let mut argument = OsString::from(format!("--{}=", option.get_long().unwrap_or_default()));
        let is_path = option.get_value_parser().type_id() == TypeId::of::<PathBuf>();
        match self.path.parent() {
            Some(folder) if is_path && text != "-" => argument.push(folder.join(text)),
            _ => argument.push(text),
        }
        argument
    }
}

/// Returns the options of a command and of all its subcommands.
fn options_within(command: &Command) -> Vec<&Arg> {
    let own = command.get_arguments().filter(|option| option.get_long().is_some_and(|long| !NEVER.contains(&long)));
    own.chain(command.get_subcommands().flat_map(options_within)).collect()
}
