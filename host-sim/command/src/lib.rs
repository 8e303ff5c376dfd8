//! The command `mindgap`: one file per subcommand, limited to arguments and text.
//!
//! A subcommand returns its report as text, which is printed once all work is done: a reader that closes the pipe early,
//! as in `mindgap evaluate ... | head -1`, cannot stop it halfway.

mod adapt;
mod brick;
mod bundle;
mod challenge;
mod check;
mod checkpoint_args;
mod choices;
mod closed_loop;
mod compare;
mod crosscheck;
pub mod defaults;
mod demo;
mod diagnose;
mod drive;
mod evaluate;
mod evolve;
mod experiments;
mod explain;
mod export;
mod fleet;
mod fleet_text;
mod general;
mod guide;
pub mod import;
mod info;
mod json_output;
pub mod kinds;
mod logging;
mod manual;
mod monitor;
mod new;
mod patch_args;
mod ports;
mod progress;
mod record;
mod schema;
mod serve;
#[cfg(unix)]
mod signals;
mod simulate;
mod table;
mod textbook;
mod train;

use std::env;
use std::path::Path;
use std::process::ExitCode;

use checkpoint_args::Checkpoint;
use clap::{FromArgMatches, Parser, Subcommand};
use general::General;
pub use guide::command;

use mindgap_files as files;
use mindgap_files::places::Places;
use mindgap_foundations::error::{Error, Result};
use mindgap_foundations::executor::Executor;
use mindgap_import::draft;
use mindgap_logs::Logs;
use mindgap_logs::heard::Heard;
use mindgap_logs::inspection::Inspection;
use mindgap_logs::robot::same_robot;
use mindgap_models::simulator::Simulator;
use mindgap_workers::Workers;

/// Learn a robot's simulator from its logs, evolve controllers in it, and diagnose the gap between simulator and robot.
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
    Bundle(bundle::Bundle),
    Challenge(challenge::Challenge),
    Check(check::Check),
    Compare(compare::Compare),
    Crosscheck(crosscheck::Crosscheck),
    Demo(demo::Demo),
    Diagnose(diagnose::Diagnose),
    Drive(drive::Drive),
    Record(record::Record),
    Train(train::Train),
    Evaluate(evaluate::Evaluate),
    Evolve(evolve::Evolve),
    Explain(explain::Explain),
    Simulate(simulate::Simulate),
    Export(export::Export),
    Import(import::Import),
    Loop(closed_loop::Loop),
    Monitor(monitor::Monitor),
    New(new::New),
    Info(info::Info),
    Completions(manual::Completions),
    Manual(manual::Manual),
    Schema(schema::Schema),
    Serve(serve::Serve),
}

/// Exit code of `--exit-code` for a gap.
const GAP: u8 = 3;

/// A subcommand.
trait Run {
    /// Returns the paths it reads and writes, which are checked before it runs.
    fn places(&self) -> Places;

    /// Runs the subcommand and returns its report for the terminal.
    ///
    /// # Errors
    /// If the work cannot be done; the error is one line for the user.
    fn run(&self, executor: &dyn Executor) -> Result<String>;

    /// Returns the exit code after a successful run.
    fn exit_code(&self) -> u8 {
        0
    }

    /// Returns the checkpoint from which an interrupted run resumes, or `None` for quick subcommands.
    fn checkpoint(&self) -> Option<Checkpoint> {
        None
    }

    /// Returns whether all MPI ranks share the work; otherwise only the first rank runs.
    fn is_shared(&self) -> bool {
        false
    }
}

impl Command {
    fn as_run(&self) -> &dyn Run {
        match self {
            Command::Adapt(command) => command,
            Command::Brick(command) => command,
            Command::Bundle(command) => command,
            Command::Challenge(command) => command,
            Command::Check(command) => command,
            Command::Compare(command) => command,
            Command::Crosscheck(command) => command,
            Command::Demo(command) => command,
            Command::Diagnose(command) => command,
            Command::Drive(command) => command,
            Command::Record(command) => command,
            Command::Train(command) => command,
            Command::Evaluate(command) => command,
            Command::Evolve(command) => command,
            Command::Explain(command) => command,
            Command::Simulate(command) => command,
            Command::Export(command) => command,
            Command::Import(command) => command,
            Command::Loop(command) => command,
            Command::Monitor(command) => command,
            Command::New(command) => command,
            Command::Info(command) => command,
            Command::Completions(command) => command,
            Command::Manual(command) => command,
            Command::Schema(command) => command,
            Command::Serve(command) => command,
        }
    }
}

/// Runs the command line of this process. Exits with 0 on success (or with what `--exit-code` asks for), 1 on failure and 2 on
/// a usage error.
pub fn run() -> ExitCode {
    let complain = |error: &Error| logging::error(&error.to_string());
    let mut code = 0;
    let is_done = match Workers::join() {
        Ok(mut workers) => {
            let done = answer(&mut workers).map(|answered| code = answered);
            workers.end(done, complain)
        }
        Err(error) => {
            complain(&error);
            false
        }
    };
    if is_done { ExitCode::from(code) } else { ExitCode::FAILURE }
}

/// Parses the arguments and the defaults of `mindgap.toml`, runs the subcommand, prints its report and returns its exit code.
fn answer(workers: &mut Workers) -> Result<u8> {
    #[cfg(unix)]
    signals::install().map_err(|e| Error::new(format!("cannot install signal handlers: {e}")))?;
    let definition = guide::command();
    let (arguments, defaults) = defaults::with_defaults(&definition, env::args_os().collect())?;
    let matches = definition.clone().try_get_matches_from(arguments).map_err(|error| defaults.locate(error))?;
    let Cli { general, command } = Cli::from_arg_matches(&matches).unwrap_or_else(|error| error.exit());
    general.take_effect(workers)?;
    defaults.log();
    let subcommand = command.as_run();
    let (places, checkpoint) = (subcommand.places(), subcommand.checkpoint());
    defaults.check(&places, &general.allow)?;
    if workers.is_first() {
        places.check(general.force, checkpoint.as_ref().is_some_and(Checkpoint::exists))?;
    } else if subcommand.is_shared() {
        files::disable_writing();
    } else {
        return Ok(0);
    }
    checkpoint_args::begin(workers, subcommand.is_shared(), checkpoint, &places, (&definition, &matches))?;
    progress::begin(matches.subcommand_name().unwrap_or_default().to_owned());
    let done = subcommand.run(workers);
    progress::end();
    let text = done?;
    // A file written to standard output is the only thing written there.
    if !general.quiet && !places.use_standard_output() {
        print(&text)?;
    }
    Ok(subcommand.exit_code())
}

/// Prints to standard output.
fn print(text: &str) -> Result<()> {
    let lines: Vec<String> = text.lines().map(logging::printable).collect();
    let end = if text.ends_with('\n') { "\n" } else { "" };
    let written = files::to_standard_output((lines.join("\n") + end).as_bytes());
    written.map_err(|e| Error::new(format!("cannot write to standard output: {e}")))
}

/// Reads a folder of logs and reports its oddities as warnings.
fn read_logs(folder: &Path) -> Result<Logs> {
    read_logs_noting(folder, |_| ())
}

/// Reads a folder of logs; `note` receives each warning too.
fn read_logs_noting(folder: &Path, mut note: impl FnMut(String)) -> Result<Logs> {
    let mut report = |warning: String| {
        warn(warning.clone());
        note(warning);
    };
    let logs = Logs::read(folder, &mut report)?;
    let (runs, rows, step_ms) = (logs.runs.len(), logs.rows(), logs.robot.step_ms);
    log::info!("{}: {runs} runs, {rows} rows, {step_ms} ms apart", folder.display());
    draft::warning(folder)?.into_iter().for_each(report);
    Ok(logs)
}

/// Reads a folder of logs for training or evaluation, corrects what can be corrected, and reports the corrections as
/// warnings.
///
/// # Errors
/// If the logs cannot be read, or have a defect that cannot be corrected.
fn read_sound_logs(folder: &Path) -> Result<Logs> {
    let report = |found| warn(format!("{}: {found}", folder.display()));
    Inspection::new(read_logs(folder)?).into_usable(report).map_err(|error| error.or_in_file(folder))
}

/// Reads logs as [`read_sound_logs`] does, as each range sensor heard them, the first sensor first.
///
/// # Errors
/// As [`read_sound_logs`].
fn read_sound_logs_by_sensor(folder: &Path) -> Result<Vec<Heard>> {
    let report = |found| warn(format!("{}: {found}", folder.display()));
    read_logs(folder)?.usable_by_sensor(report).map_err(|error| error.or_in_file(folder))
}

/// Reads logs as [`read_sound_logs`] does, and checks that they are of the simulator's robot.
///
/// # Errors
/// As [`read_sound_logs`], or if the logs are of another robot.
fn read_logs_of(simulator: &Simulator, folder: &Path) -> Result<Logs> {
    let logs = read_sound_logs(folder)?;
    same_robot(&simulator.robot, &logs.robot)?;
    Ok(logs)
}

/// Logs a warning.
fn warn(warning: String) {
    log::warn!("{warning}");
}
