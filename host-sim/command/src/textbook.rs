//! `kinematic`, the name of the textbook model in place of a simulator file.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use mindgap_files as files;
use mindgap_foundations::error::{Error, Result};
use mindgap_logs::recording_to_import;
use mindgap_models::simulator::Simulator;

/// Argument that selects the textbook model.
const KINEMATIC: &str = "kinematic";

/// Parses the argument that names a simulator file or the textbook model: a recording must be imported first.
///
/// # Errors
/// If it is named like a recording; the message has the command that imports it.
pub fn not_a_recording(argument: &str) -> std::result::Result<PathBuf, String> {
    match recording_to_import(Path::new(argument)) {
        Some(import) => Err(format!("it is a recording: {import}, then give the logs after {KINEMATIC}")),
        None => Ok(argument.into()),
    }
}

/// Returns the simulator file that an argument names, or `None` for the textbook model.
pub fn simulator_file(argument: &PathBuf) -> Option<&PathBuf> {
    Some(argument).filter(|file| file.as_os_str() != KINEMATIC)
}

/// Reads a simulator file where `kinematic` would be accepted too.
///
/// # Errors
/// As [`Simulator::read`]; a missing file with a name like `kinematic` gives a suggestion.
pub fn simulator_or_textbook(path: &Path) -> Result<Simulator> {
    let meant = files::did_you_mean(&path.to_string_lossy(), [KINEMATIC]);
    if !path.exists() && !meant.is_empty() {
        return Err(Error::in_file(path, format!("does not exist{meant}")));
    }
    Simulator::read(path)
}

/// Reads a simulator file where the textbook model is not accepted.
///
/// # Errors
/// As [`Simulator::read`], or if `kinematic` is given.
pub fn simulator(path: &Path) -> Result<Simulator> {
    learned(path)?;
    Simulator::read(path)
}

/// Checks that a learned simulator is given rather than the textbook model.
///
/// # Errors
/// If `kinematic` is given.
pub fn learned(path: &Path) -> Result<()> {
    if path.as_os_str() == OsStr::new(KINEMATIC) && !path.exists() {
        let what = "is the textbook model, which only mindgap diagnose accepts: give a simulator file, as written by \
                    mindgap train LOGS --out simulator.json";
        return Err(Error::in_file(path, what));
    }
    Ok(())
}
