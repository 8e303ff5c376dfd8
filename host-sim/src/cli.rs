//! The command `mindgap`: one file a command, nothing but arguments and printing.

mod demo;
mod diagnose;
mod evaluate;
mod evolve;
mod export;
mod progress;
mod record;
mod simulate;
mod table;
mod train;

use std::path::Path;
use std::process::ExitCode;

use clap::{Parser, Subcommand};

use crate::logs::Logs;
use crate::problem::Result;

/// Learns a robot's simulator from its logs, evolves controllers in it, and finds what reality has that it lacks.
#[derive(Parser)]
#[command(name = "mindgap", version)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Demo(demo::Demo),
    Diagnose(diagnose::Diagnose),
    Record(record::Record),
    Train(train::Train),
    Evaluate(evaluate::Evaluate),
    Evolve(evolve::Evolve),
    Simulate(simulate::Simulate),
    Export(export::Export),
}

/// Runs the command of this process's arguments. Exits with 0 when it did what was asked, 1 when it could not, and 2
/// when the call is wrong.
pub fn run() -> ExitCode {
    let done = match Cli::parse().command {
        Command::Demo(command) => command.run(),
        Command::Diagnose(command) => command.run(),
        Command::Record(command) => command.run(),
        Command::Train(command) => command.run(),
        Command::Evaluate(command) => command.run(),
        Command::Evolve(command) => command.run(),
        Command::Simulate(command) => command.run(),
        Command::Export(command) => command.run(),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(problem) => {
            eprintln!("mindgap: {problem}");
            ExitCode::FAILURE
        }
    }
}

/// Reads a folder of logs and tells its oddities on standard error.
fn read_logs(folder: &Path) -> Result<Logs> {
    Logs::read(folder, |warning| eprintln!("mindgap: warning: {warning}"))
}
