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
pub mod defaults;
mod demo;
mod diagnose;
mod diagnosis_text;
mod drive;
mod evaluate;
mod evolve;
mod export;
mod facts;
mod fleet;
mod fleet_text;
mod general;
mod guide;
mod import;
mod info;
pub mod kinds;
mod lasting;
mod manual;
mod new;
mod ports;
mod progress;
mod record;
#[cfg(unix)]
mod signals;
mod simulate;
mod table;
mod textbook;
mod train;
mod trials;
mod voice;

use std::env;
use std::path::Path;
use std::process::ExitCode;

use clap::{FromArgMatches, Parser, Subcommand};
use general::General;
pub use guide::command;
use lasting::Kept;

use mindgap_diagnosis::validate::same_robot;
use mindgap_files as files;
use mindgap_files::places::Places;
use mindgap_foundations::error::{Error, Result};
use mindgap_import::draft::to_fill_in;
use mindgap_logs::Logs;
use mindgap_logs::inspection::Inspection;
use mindgap_models::simulator::Simulator;
use mindgap_workers as workers;

/// Learns a robot's simulator from its logs, evolves controllers in it, and finds what reality has that it lacks.
#[derive(Parser)]
#[command(name = "mindgap", version)]
struct Cli {
    #[command(flatten)]
    general: General,
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

    /// Where it keeps what is done, for a run that goes on after it was broken off; nowhere when it is soon done.
    fn kept(&self) -> Option<Kept> {
        None
    }

    /// Whether ranks that were started together do its work together, and not the first alone.
    fn is_shared(&self) -> bool {
        false
    }
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
    let is_done = workers::end(answer(), |error| voice::complain(&error.to_string()));
    if is_done { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

/// Does what this process's arguments and the defaults beside the logs ask for, and says what there is to say.
fn answer() -> Result<()> {
    #[cfg(unix)]
    signals::heed().map_err(|e| Error::new(format!("signals cannot be heeded: {e}")))?;
    let command = guide::command();
    let (arguments, defaults) = defaults::with_defaults(&command, env::args_os().collect())?;
    let matches = command.clone().try_get_matches_from(arguments).map_err(|error| defaults.blamed_for(error))?;
    let Cli { general, command: asked } = Cli::from_arg_matches(&matches).unwrap_or_else(|error| error.exit());
    workers::join()?;
    general.take_effect()?;
    defaults.tell();
    let asked = asked.which();
    let (places, kept) = (asked.places(), asked.kept());
    if workers::is_first() {
        places.check(general.force, kept.as_ref().is_some_and(Kept::is_there))?;
    } else if asked.is_shared() {
        files::leave_writing();
    } else {
        return Ok(());
    }
    lasting::begin(asked.is_shared(), kept, &places, (&command, &matches))?;
    progress::begin(matches.subcommand_name().unwrap_or_default().to_owned());
    let done = asked.run();
    progress::end();
    let text = done?;
    // What goes to standard output as a file stands alone there.
    if general.quiet || places.take_standard_output() { Ok(()) } else { say(&text) }
}

/// Writes to standard output.
fn say(text: &str) -> Result<()> {
    let lines: Vec<String> = text.lines().map(voice::printable).collect();
    let end = if text.ends_with('\n') { "\n" } else { "" };
    let written = files::to_standard_output((lines.join("\n") + end).as_bytes());
    written.map_err(|e| Error::new(format!("standard output cannot be written: {e}")))
}

/// Reads a folder of logs and tells its oddities on standard error.
fn read_logs(folder: &Path) -> Result<Logs> {
    let logs = Logs::read(folder, warn)?;
    let (runs, rows, step_ms) = (logs.runs.len(), logs.rows(), logs.robot.step_ms);
    log::info!("{}: {runs} runs, {rows} rows, {step_ms} ms apart", folder.display());
    let robot = folder.join("robot.toml");
    let open = to_fill_in(&robot.display().to_string(), &files::read_text(&robot)?);
    if let Some(first) = open.first() {
        let others = if open.len() > 1 { format!(" and {} more", open.len() - 1) } else { String::new() };
        warn(format!("{first}{others}: marked FILL IN, so not measured yet; what is wrong about it looks like a gap"));
    }
    Ok(logs)
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

/// Tells what does not keep a command from being done.
fn warn(warning: String) {
    log::warn!("{warning}");
}
