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
mod diagnosis_page;
mod diagnosis_text;
mod drive;
mod evaluate;
mod evolve;
mod export;
mod import;
mod progress;
mod record;
mod simulate;
mod table;
mod train;
mod trials;

use std::io::{self, ErrorKind, Write};
use std::path::Path;
use std::process::ExitCode;

use clap::{Parser, Subcommand};
use serde::Serialize;

use crate::error::{Error, Result};
use crate::files;
use crate::inspection::Inspection;
use crate::logs::Logs;

/// Learns a robot's simulator from its logs, evolves controllers in it, and finds what reality has that it lacks.
#[derive(Parser)]
#[command(name = "mindgap", version)]
struct Cli {
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
}

/// Runs the command of this process's arguments. Exits with 0 when it did what was asked, 1 when it could not, and 2
/// when the call is wrong.
pub fn run() -> ExitCode {
    let done = match Cli::parse().command {
        Command::Adapt(command) => command.run(),
        Command::Brick(command) => command.run(),
        Command::Challenge(command) => command.run(),
        Command::Check(command) => command.run(),
        Command::Crosscheck(command) => command.run(),
        Command::Demo(command) => command.run(),
        Command::Diagnose(command) => command.run(),
        Command::Drive(command) => command.run(),
        Command::Record(command) => command.run(),
        Command::Train(command) => command.run(),
        Command::Evaluate(command) => command.run(),
        Command::Evolve(command) => command.run(),
        Command::Simulate(command) => command.run(),
        Command::Export(command) => command.run(),
        Command::Import(command) => command.run(),
        Command::Loop(command) => command.run(),
    };
    match done.and_then(|text| say(&text)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("mindgap: {error}");
            ExitCode::FAILURE
        }
    }
}

/// Writes to standard output. That nobody reads on is no error.
fn say(text: &str) -> Result<()> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(e) if e.kind() != ErrorKind::BrokenPipe => {
            Err(Error::new(format!("standard output cannot be written: {e}")))
        }
        _ => Ok(()),
    }
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
    let inspected = Inspection::of(read_logs(folder)?);
    if let Some(why) = inspected.refusal() {
        return Err(Error::in_file(folder, why));
    }
    inspected.findings.iter().for_each(|found| warn(format!("{}: {}", folder.display(), found.line())));
    Ok(inspected.logs)
}

/// Tells what a command found: as `text`, which stands beside the JSON in a file, or as the JSON itself where that goes to
/// standard output, as `-` says.
fn reported(json: Option<&Path>, facts: &impl Serialize, text: String) -> Result<String> {
    match json {
        Some(path) if path.as_os_str() == "-" => files::json(path, facts),
        Some(path) => files::write_json(path, facts).map(|()| text),
        None => Ok(text),
    }
}

/// Tells what does not keep a command from being done.
fn warn(warning: String) {
    eprintln!("mindgap: warning: {warning}");
}
