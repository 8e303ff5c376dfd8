//! Commands that take long: what they have done is kept, so that a run that was broken off goes on, and ranks that were
//! started together do their work together.

use std::any::TypeId;
use std::collections::BTreeMap;
use std::env;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use clap::{ArgMatches, Args, Command};

use super::voice::meanwhile;
use super::warn;
use mindgap_files::is_stream;
use mindgap_files::places::Places;
use mindgap_foundations::error::Result;
use mindgap_workers as workers;
use mindgap_workers::checkpoint::Begin;
use mindgap_workers::task::Task;

/// The name of the option, which says nothing of what is to be done.
const OPTION: &str = "checkpoint";
/// Stands for the path of a place.
const GIVEN: &str = "given";

/// The option of commands that keep what they have done.
#[derive(Args)]
pub struct KeepOption {
    /// Keep what is done here, from the beginning. A run that was broken off, called again in the same way, goes on from
    /// there, and the file goes when the run is done. Left out, the name is that of the output with `.checkpoint`, and
    /// only what takes over a minute is kept.
    #[arg(long, value_name = "FILE")]
    checkpoint: Option<PathBuf>,
}

/// Where and when what is done is kept.
pub struct Kept {
    path: PathBuf,
    begin: Begin,
}

impl KeepOption {
    /// Where what is done for an output is kept.
    pub fn beside(&self, out: &Path) -> Option<Kept> {
        if let Some(path) = &self.checkpoint {
            return Some(Kept { path: path.clone(), begin: Begin::AtOnce });
        }
        let mut path = out.components().as_path().as_os_str().to_owned();
        path.push(".checkpoint");
        (!is_stream(out)).then(|| Kept { path: path.into(), begin: Begin::AfterAMinute })
    }

    /// The file that is asked for.
    pub fn asked(&self) -> &Option<PathBuf> {
        &self.checkpoint
    }
}

impl Kept {
    /// Whether a run before has left something.
    pub fn is_there(&self) -> bool {
        self.path.exists()
    }
}

/// Begins the work of a command, from where a run before stood.
///
/// # Errors
/// When another run stood there, or other ranks have another task.
pub fn begin(is_shared: bool, kept: Option<Kept>, places: &Places, call: (&Command, &ArgMatches)) -> Result<()> {
    if !is_shared {
        workers::go_alone();
    }
    if !is_shared && kept.is_none() {
        return Ok(());
    }
    let checkpoint = kept.as_ref().map(|kept| (kept.path.as_path(), kept.begin));
    // Neither what is written nor what is kept counts where it lies in a folder that is read.
    let outputs: Vec<PathBuf> = places.outputs().chain(kept.as_ref().map(|kept| kept.path.clone())).collect();
    let count = workers::begin(task(call, places, &outputs), checkpoint, warn)?;
    if let Some(kept) = kept.filter(|_| count > 0) {
        meanwhile(&format!("{}: goes on, {count} pieces of work are done", kept.path.display()));
    }
    Ok(())
}

/// What a call asks for. Of its places only that they are given is an argument: what is read counts by its content, and
/// where results go changes none of them. The program is read too: two builds of one version may give other results.
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
                let is_place = |value: &OsStr| is_path && places.contain(Path::new(value));
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
