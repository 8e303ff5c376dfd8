//! `kinematic`, which stands for a simulator file where the textbook will do.

use std::ffi::OsStr;
use std::path::Path;

use mindgap_files as files;
use mindgap_foundations::error::{Error, Result};
use mindgap_models::simulator::Simulator;

/// Stands for a simulator file: the textbook's.
pub const KINEMATIC: &str = "kinematic";

/// Reads a simulator file, or says what was meant by one that is not there.
///
/// # Errors
/// As [`Simulator::read`].
pub fn simulator_beside_textbook(path: &Path) -> Result<Simulator> {
    let meant = files::did_you_mean(&path.to_string_lossy(), [KINEMATIC]);
    if !path.exists() && !meant.is_empty() {
        return Err(Error::in_file(path, format!("is not there{meant}")));
    }
    Simulator::read(path)
}

/// Reads a simulator file where the textbook will not do.
///
/// # Errors
/// As [`Simulator::read`], and when the textbook is meant.
pub fn simulator(path: &Path) -> Result<Simulator> {
    learned(path)?;
    Simulator::read(path)
}

/// Checks that the textbook is not meant where a learned simulator is needed.
///
/// # Errors
/// When it is.
pub fn learned(path: &Path) -> Result<()> {
    if path.as_os_str() == OsStr::new(KINEMATIC) && !path.exists() {
        let what = "stands for the textbook, with which mindgap diagnose compares logs; here a simulator file is needed, \
                    as mindgap train LOGS --out simulator.json makes it";
        return Err(Error::in_file(path, what));
    }
    Ok(())
}
