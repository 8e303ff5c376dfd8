//! What is fed with any bytes: every reader of what users give, what runs on a robot, and twins, two ways to one result.
//!
//! A target panics where something is wrong. `fuzz/tests/kept.rs` feeds each a little, `fuzz/run.sh` for hours.

mod onboard;
mod readers;
mod twins;

use std::cell::RefCell;
use std::fs;
use std::path::Path;

use tempfile::TempDir;

/// Something that takes any bytes.
pub struct Target {
    /// Its name, and that of the folder of its corpus.
    pub name: &'static str,
    /// Takes them.
    ///
    /// # Panics
    /// When something is wrong with what is tested.
    pub feed: fn(&[u8]),
}

/// All of them.
pub fn targets() -> impl Iterator<Item = &'static Target> {
    readers::TARGETS.iter().chain(onboard::TARGETS).chain(twins::TARGETS)
}

/// Hands bytes as a file to what reads files.
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
