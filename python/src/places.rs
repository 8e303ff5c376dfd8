//! What may be written over: as the command does, nothing of others unless it is asked for.

use std::path::PathBuf;

use mindgap_files::places::{Kind, Places};
use pyo3::prelude::*;

use crate::error::raised;

/// Checks a file that is to be written.
pub fn file(path: &PathBuf, kind: Kind, force: bool) -> PyResult<()> {
    Places::default().writing([path], kind).check(force, false).map_err(raised)
}

/// Checks a folder that is to be filled.
pub fn folder(path: &PathBuf, force: bool) -> PyResult<()> {
    Places::default().filling([path]).check(force, false).map_err(raised)
}
