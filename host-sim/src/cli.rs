//! The command `mindgap`: one file a command, nothing but arguments and printing.
//!
//! A command returns what it has to say, and says it only once everything is done: whoever reads just the first line
//! of it, as `mindgap evaluate ... | head -1` does, stops nothing halfway.

mod adapt;
mod brick;
mod budget_text;
mod challenge;
mod check;
mod crosscheck;
mod demo;
mod diagnose;
mod diagnosis_text;
mod drive;
mod evaluate;
mod evolve;
mod export;
mod guide;
mod import;
mod info;
pub mod kinds;
mod manual;
mod new;
mod progress;
mod record;
mod simulate;
mod table;
mod train;
mod trials;

use std::io::{self, Write};
use std::path::Path;
use std::process::ExitCode;

use clap::{FromArgMatches, Parser, Subcommand};
use serde::Serialize;

use crate::error::{Error, Result};
use crate::files;
use crate::files::places::Places;
use crate::gap::validate::same_robot;
use crate::inspection::Inspection;
use crate::logs::Logs;
use crate::simulator::Simulator;

/// Learns a robot's simulator from its logs, evolves controllers in it, and finds what reality has that it lacks.
#[derive(Parser)]
#[command(name = "mindgap", version)]
struct Cli {
    /// Replace what is at the place of an output, whatever it is; what else lies in a folder stays.
    #[arg(long, global = true)]
    force: bool,
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Adapt(adapt::Adapt),
    Brick(brick::Brick),
    Challenge(challenge::Challenge),
    Check(check::Check),
    Crosscheck(crosscheck::Crosscheck),
    Demo(demo::Demo),
    Diagnose(diagnose::Diagnose),
    Drive(drive::Drive),
    Record(record::Record),
    Train(train::Train),
    Evaluate(evaluate::Evaluate),
    Evolve(evolve::Evolve),
    Simulate(simulate::Simulate),
    Export(export::Export),
    Import(import::Import),
    Loop(trials::Loop),
    New(new::New),
    Info(info::Info),
    Completions(manual::Completions),
    Manual(manual::Manual),
}

/// A command.
trait Run {
    /// What it reads and writes, which is checked before it begins.
    fn places(&self) -> Places;

    /// Does it; returns what there is to say.
    fn run(&self) -> Result<String>;
}

impl Command {
    fn which(&self) -> &dyn Run {
        match self {
            Command::Adapt(command) => command,
            Command::Brick(command) => command,
            Command::Challenge(command) => command,
            Command::Check(command) => command,
            Command::Crosscheck(command) => command,
            Command::Demo(command) => command,
            Command::Diagnose(command) => command,
            Command::Drive(command) => command,
            Command::Record(command) => command,
            Command::Train(command) => command,
            Command::Evaluate(command) => command,
            Command::Evolve(command) => command,
            Command::Simulate(command) => command,
            Command::Export(command) => command,
            Command::Import(command) => command,
            Command::Loop(command) => command,
            Command::New(command) => command,
            Command::Info(command) => command,
            Command::Completions(command) => command,
            Command::Manual(command) => command,
        }
    }
}

/// Runs the command of this process's arguments. Exits with 0 when it did what was asked, 1 when it could not, and 2
/// when the call is wrong.
pub fn run() -> ExitCode {
    let cli = Cli::from_arg_matches(&guide::command().get_matches());
    let Cli { force, command } = cli.unwrap_or_else(|error| error.exit());
    let command = command.which();
    let places = command.places();
    let done = places.check(force).and_then(|()| command.run());
    // What goes to standard output as a file stands alone there.
    match done.and_then(|text| if places.take_standard_output() { Ok(()) } else { say(&text) }) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            complain(&error.to_string());
            ExitCode::FAILURE
        }
    }
}

/// Writes to standard output.
fn say(text: &str) -> Result<()> {
    let lines: Vec<String> = text.lines().map(printable).collect();
    let end = if text.ends_with('\n') { "\n" } else { "" };
    let written = files::to_standard_output((lines.join("\n") + end).as_bytes());
    written.map_err(|e| Error::new(format!("standard output cannot be written: {e}")))
}

/// Writes a line to standard error. That nobody can read it ends nothing.
fn complain(line: &str) {
    let _ = writeln!(io::stderr(), "mindgap: {}", printable(line));
}

/// A line without what moves a terminal's cursor: file names may hold anything.
fn printable(line: &str) -> String {
    let shown = |c: char| if c.is_control() { c.escape_default().to_string() } else { c.to_string() };
    line.chars().map(shown).collect()
}

/// Reads a folder of logs and tells its oddities on standard error.
fn read_logs(folder: &Path) -> Result<Logs> {
    Logs::read(folder, warn)
}

/// Reads a folder of logs from which something is learned or judged: what could be put right in them is told and used.
///
/// # Errors
/// When they cannot be read, or when something in them is wrong that could not be put right.
fn read_sound_logs(folder: &Path) -> Result<Logs> {
    let told = |found| warn(format!("{}: {found}", folder.display()));
    Inspection::of(read_logs(folder)?).sound(told).map_err(|error| error.or_in_file(folder))
}

/// The same of logs that have to be of a simulator's robot.
///
/// # Errors
/// As [`read_sound_logs`], or when they are another robot's.
fn read_logs_of(simulator: &Simulator, folder: &Path) -> Result<Logs> {
    let logs = read_sound_logs(folder)?;
    same_robot(&simulator.robot, &logs.robot)?;
    Ok(logs)
}

/// Writes what a command found as JSON where that is asked for; returns the `text` that tells it.
fn reported(json: Option<&Path>, facts: &impl Serialize, text: String) -> Result<String> {
    json.map_or(Ok(()), |path| files::write_json(path, facts))?;
    Ok(text)
}

/// Tells what does not keep a command from being done.
fn warn(warning: String) {
    complain(&format!("warning: {warning}"));
}
