//! Protection of existing files: as in the command, those of others are replaced only on request.

use std::path::PathBuf;

use mindgap_files::places::{Kind, Places};
use pyo3::prelude::*;

use crate::error::raised;

/// Checks that a file may be written.
pub fn file(path: &PathBuf, kind: Kind, force: bool) -> PyResult<()> {
    Places::default().writing([path], kind).check(force, false).map_err(raised)
}

/// Checks that a folder may be filled.
pub fn folder(path: &PathBuf, force: bool) -> PyResult<()> {
    Places::default().filling([path]).check(force, false).map_err(raised)
}
