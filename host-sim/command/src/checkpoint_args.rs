//! Long commands: checkpoints from which an interrupted run resumes, and the work shared by MPI ranks.

use std::any::TypeId;
use std::collections::BTreeMap;
use std::env;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use clap::{ArgMatches, Args, Command};

use super::logging::status;
use super::warn;
use mindgap_files::is_stream;
use mindgap_files::places::Places;
use mindgap_foundations::error::Result;
use mindgap_workers::Workers;
use mindgap_workers::checkpoint::CreateFile;
use mindgap_workers::task::Task;

/// Id of the option, which does not affect results.
const OPTION: &str = "checkpoint";
/// Placeholder for the path of an input or output.
const GIVEN: &str = "given";

/// The option `--checkpoint` of long commands.
#[derive(Args)]
pub struct CheckpointOption {
    /// Checkpoint file, created at the start of the run. Call the command again with the same arguments to resume; the file is
    /// removed when the run completes (default: the output's name with `.checkpoint`, written once
    /// the run takes over a minute).
    #[arg(long, value_name = "FILE")]
    checkpoint: Option<PathBuf>,
}

/// Where and when a checkpoint is written.
pub struct Checkpoint {
    path: PathBuf,
    begin: CreateFile,
}

impl CheckpointOption {
    /// Returns the checkpoint of an output.
    pub fn for_output(&self, out: &Path) -> Option<Checkpoint> {
        if let Some(path) = &self.checkpoint {
            return Some(Checkpoint { path: path.clone(), begin: CreateFile::AtOnce });
        }
        let mut path = out.components().as_path().as_os_str().to_owned();
        path.push(".checkpoint");
        (!is_stream(out)).then(|| Checkpoint { path: path.into(), begin: CreateFile::AfterAMinute })
    }

    /// Returns the requested file, if any.
    pub fn path(&self) -> &Option<PathBuf> {
        &self.checkpoint
    }
}

impl Checkpoint {
    /// Returns whether an earlier run left a checkpoint.
    pub fn exists(&self) -> bool {
        self.path.exists()
    }
}

/// Begins the work of a command, resuming from its checkpoint if there is one.
///
/// # Errors
/// If the checkpoint is of another run, or other ranks have another task.
pub fn begin(
    workers: &mut Workers,
    is_shared: bool,
    checkpoint: Option<Checkpoint>,
    places: &Places,
    call: (&Command, &ArgMatches),
) -> Result<()> {
    if !is_shared {
        workers.leave_ranks();
    }
    if !is_shared && checkpoint.is_none() {
        return Ok(());
    }
    let place = checkpoint.as_ref().map(|checkpoint| (checkpoint.path.as_path(), checkpoint.begin));
    // Outputs and checkpoints inside an input folder are not part of the input.
    let outputs: Vec<PathBuf> =
        places.outputs().chain(checkpoint.as_ref().map(|checkpoint| checkpoint.path.clone())).collect();
    let count = workers.begin(task(call, places, &outputs), place, warn)?;
    if let Some(checkpoint) = checkpoint.filter(|_| count > 0) {
        status(&format!("{}: resuming, {count} work items already done", checkpoint.path.display()));
    }
    Ok(())
}

/// Returns the identity of the work. Paths are reduced to whether they are given: inputs count by content, and output
/// paths do not affect results. The program itself is an input, since two builds of one version may give other results.
fn task((mut command, mut matches): (&Command, &ArgMatches), places: &Places, outputs: &[PathBuf]) -> Task {
    let mut names = Vec::new();
    let mut arguments = BTreeMap::new();
    let mut next = matches.subcommand();
    while let Some(((name, within), called)) = next.and_then(|next| Some((next, command.find_subcommand(next.0)?))) {
        (command, matches) = (called, within);
        next = matches.subcommand();
        names.push(name);
        for argument in command.get_arguments().filter(|argument| argument.get_id() != OPTION) {
            if let Ok(Some(values)) = matches.try_get_raw(argument.get_id().as_str()) {
                let is_path = argument.get_value_parser().type_id() == TypeId::of::<PathBuf>();
                let is_place = |value: &OsStr| is_path && places.contains(Path::new(value));
                let word = |value| if is_place(value) { GIVEN.into() } else { value.to_string_lossy() };
                let values: Vec<_> = values.map(word).collect();
                let name = argument.get_long().map_or(argument.get_id().to_string(), |long| format!("--{long}"));
                arguments.insert(name, values.join(" "));
            }
        }
    }
    let inputs: Vec<PathBuf> = places.inputs().iter().cloned().chain(env::current_exe()).collect();
    Task::new(names.join(" "), arguments, &inputs, outputs)
}
