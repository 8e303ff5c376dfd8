//! Fuzz targets: every reader of user input, everything that runs on a robot, and pairs of implementations that must agree.
//!
//! A target panics when it finds a fault. `fuzz/tests/kept.rs` runs each briefly, and `fuzz/run.sh` runs them for hours.

mod onboard;
mod readers;
mod twins;

use std::cell::RefCell;
use std::fs;
use std::path::Path;

use tempfile::TempDir;

/// A fuzz target, which accepts any bytes.
pub struct Target {
    /// Name of the target and of the folder of its corpus.
    pub name: &'static str,
    /// Runs the target on an input.
    ///
    /// # Panics
    /// Panics when the code under test is at fault.
    pub feed: fn(&[u8]),
}

/// Returns all targets.
pub fn targets() -> impl Iterator<Item = &'static Target> {
    readers::TARGETS.iter().chain(onboard::TARGETS).chain(twins::TARGETS)
}

/// Writes bytes to a temporary file and passes its path to a reader.
fn as_file<T>(name: &str, bytes: &[u8], read: impl FnOnce(&Path) -> T) -> T {
    thread_local! {
        static FOLDER: RefCell<Option<TempDir>> = const { RefCell::new(None) };
    }
    FOLDER.with_borrow_mut(|folder| {
        let folder = folder.get_or_insert_with(|| tempfile::tempdir().expect("a temporary folder"));
        let path = folder.path().join(name);
        fs::write(&path, bytes).expect("a file");
        read(&path)
    })
}
