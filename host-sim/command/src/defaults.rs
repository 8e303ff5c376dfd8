//! Defaults of options from two files `mindgap.toml`: one next to the logs, and the user's own. Keys are the long names of
//! options: at the top level for all commands, in a table for one command.
//!
//! A file next to logs may come from anyone. It says how something is done, but not which programs run or which files are
//! written, unless the user allows it. The accepted keys follow from the definitions of the command line, and the written
//! files from what a command [says](Places) that it writes; there is no separate list.

use std::any::TypeId;
use std::env;
use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};

use clap::parser::ValueSource;
use clap::{Arg, ArgAction, ArgMatches, Command};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::logging::status;
use mindgap_files as files;
use mindgap_files::places::Places;
use mindgap_foundations::error::{Error, Result};

/// File name of the defaults.
const NAME: &str = "mindgap.toml";
/// Id of positional arguments that are folders of logs.
const LOGS: &str = "logs";
/// Options that cannot have a default. `force` could overwrite files of others.
const NEVER: &[&str] = &["force", "help", "version"];
/// Option that lets a file next to logs set others; such a file cannot set it.
const ALLOW: &str = "allow";
/// Options whose value is a program to run, or the folder of its logs, which is no output where it is resumed.
const PROGRAMS: &[&str] = &["loop.robot", "diagnose.drive", "diagnose.out", "compare.verify"];

/// Defaults that apply to this call.
#[derive(Default)]
pub struct Defaults {
    applied: Vec<Applied>,
    /// Files next to logs that would allow options, with the lines.
    ignored: Vec<(PathBuf, u64)>,
}

/// One default that applies.
struct Applied {
    path: PathBuf,
    line: u64,
    /// Command and option, such as `loop.robot`.
    key: String,
    /// The option as clap displays it.
    option: String,
    argument: OsString,
    /// Whether the file is the user's own.
    is_own: bool,
}

/// Returns the call extended by the defaults of its command that it does not set itself. A file next to the logs takes
/// precedence over the user's own.
///
/// # Errors
/// If a file cannot be read, has a key that is not an option, or a value of the wrong type.
pub fn with_defaults(command: &Command, mut call: Vec<OsString>) -> Result<(Vec<OsString>, Defaults)> {
    // Building copies the general options to every subcommand.
    let mut command = command.clone();
    command.build();
    let mut defaults = Defaults::default();
    // Errors in the call are reported when it is parsed with the defaults.
    let Ok(stated) = command.clone().ignore_errors(true).try_get_matches_from(&call) else {
        return Ok((call, defaults));
    };
    let near = folder(&chain(&command, &stated)).join(NAME);
    for (path, is_own) in [Some((near, false)), own_file().map(|path| (path, true))].into_iter().flatten() {
        if !path.is_file() {
            continue;
        }
        let Ok(stated) = command.clone().ignore_errors(true).try_get_matches_from(&call) else { break };
        let text = files::read_text(&path)?;
        let file = File { path: &path, text: &text, is_own };
        let applied = file.applied(&command, &chain(&command, &stated), &mut defaults.ignored)?;
        let end = call.iter().position(|argument| argument == "--").unwrap_or(call.len());
        call.splice(end..end, applied.iter().map(|applied| applied.argument.clone()));
        defaults.applied.extend(applied);
    }
    Ok((call, defaults))
}

/// Returns the path of the user's own defaults: `$XDG_CONFIG_HOME/mindgap/mindgap.toml`, by default in `~/.config`.
fn own_file() -> Option<PathBuf> {
    let absolute = |name: &str| env::var_os(name).map(PathBuf::from).filter(|folder| folder.is_absolute());
    let folder = absolute("XDG_CONFIG_HOME").or_else(|| Some(env::home_dir()?.join(".config")))?;
    Some(folder.join("mindgap").join(NAME))
}

impl Defaults {
    /// Logs the defaults that apply, and warns of those that are ignored.
    pub fn log(&self) {
        for (path, line) in &self.ignored {
            log::warn!("{}:{line}: {ALLOW} is ignored in a file next to logs", path.display());
        }
        for Applied { path, line, argument, .. } in &self.applied {
            log::info!("{}:{line}: {}", path.display(), argument.to_string_lossy());
        }
    }

    /// Checks that no file next to logs sets which programs run or which files are written, except for the options in
    /// `allowed`, such as `loop.robot`. Prints the settings of this kind.
    ///
    /// # Errors
    /// If a file sets an option that is not allowed.
    pub fn check(&self, places: &Places, allowed: &[String]) -> Result<()> {
        let outputs: Vec<PathBuf> = places.outputs().collect();
        for applied in self.applied.iter().filter(|applied| applied.runs_or_writes(&outputs)) {
            let Applied { path, line, key, argument, is_own, .. } = applied;
            if !is_own && !allowed.contains(key) {
                let what = format!(
                    "a file next to logs cannot set {key}, which decides what is run or written: set it on the command line \
                     or in your own mindgap.toml, or add --allow {key}"
                );
                return Err(Error::at_line(path, *line, what));
            }
            status(&format!("{}:{line}: {}", path.display(), argument.to_string_lossy()));
        }
        Ok(())
    }

    /// Returns the error with the line of the default that caused it; exits the process if the call itself is wrong.
    pub fn locate(&self, error: clap::Error) -> Error {
        let words = error.to_string();
        let option = self.applied.iter().find(|applied| words.contains(&format!("'{}'", applied.option)));
        match option {
            Some(applied) if error.use_stderr() => {
                let first = words.lines().next().unwrap_or_default();
                Error::at_line(&applied.path, applied.line, first.trim_start_matches("error: "))
            }
            _ => error.exit(),
        }
    }
}

impl Applied {
    /// Returns whether the option is a program, or its value one of the files and folders that the command writes.
    fn runs_or_writes(&self, outputs: &[PathBuf]) -> bool {
        let bytes = self.argument.as_encoded_bytes();
        let is_value = |path: &PathBuf| {
            let path: &OsStr = path.as_ref();
            bytes.strip_suffix(path.as_encoded_bytes()).is_some_and(|before| before.ends_with(b"="))
        };
        PROGRAMS.contains(&self.key.as_str()) || outputs.iter().any(is_value)
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
    is_own: bool,
}

impl File<'_> {
    /// Returns the defaults for a chain of commands; the table of the innermost command takes precedence.
    fn applied(
        &self,
        command: &Command,
        chain: &[(&Command, &ArgMatches)],
        ignored: &mut Vec<(PathBuf, u64)>,
    ) -> Result<Vec<Applied>> {
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
        let commands = chain[1..].iter().map(|(command, _)| command.get_name()).collect::<Vec<_>>().join(".");
        let mut applied = Vec::new();
        for option in called.get_arguments() {
            let Some(name) = option.get_long() else { continue };
            let Some((key, value)) = tables.iter().rev().find_map(|table| table.get_key_value(name)) else { continue };
            let line = files::line_at(self.text, key.span().start);
            if name == ALLOW && !self.is_own {
                ignored.push((self.path.to_owned(), line));
            } else if !is_stated(option) && !is_ruled_out(option) {
                let arguments = self.arguments(option, value)?;
                applied.extend(arguments.map(|argument| Applied {
                    path: self.path.to_owned(),
                    line,
                    key: format!("{commands}.{name}"),
                    option: option.to_string(),
                    argument,
                    is_own: self.is_own,
                }));
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
