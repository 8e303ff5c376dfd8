//! Staging folders: an output folder is built under a temporary name and then moved into place as a whole.
//!
//! A staging folder contains `lock`, held while its process runs; `new`, the folder under construction; and, while an existing
//! folder is exchanged, `old`, its previous files. `new` is renamed to `ready` once all previous files are out of the way, so
//! that another process can tell how to finish the exchange of a killed one.

use std::ffi::OsString;
use std::fs::{self, File, OpenOptions};
use std::io;
use std::path::{Path, PathBuf};

use super::temporary::{InUse, builder, in_use, lock_new};

const LOCK: &str = "lock";
const NEW: &str = "new";
const READY: &str = "ready";
const OLD: &str = "old";
/// Other threads may still be adding files while a folder is removed.
const ATTEMPTS: usize = 100;

/// A staging folder, removed when it is dropped.
pub struct StagingFolder {
    target: PathBuf,
    path: PathBuf,
    _lock: File,
    _in_use: InUse,
}

impl StagingFolder {
    /// Creates a staging folder inside `target`.
    ///
    /// # Errors
    /// When it cannot be created.
    pub fn in_folder(target: &Path) -> io::Result<Self> {
        let mut names = in_use();
        loop {
            let folder = builder().tempdir_in(target)?;
            let lock = match File::create_new(folder.path().join(LOCK)) {
                Ok(lock) if lock_new(&lock, folder.path()) => lock,
                Err(e) if e.kind() != io::ErrorKind::NotFound => return Err(e),
                // Another process removed it as stale.
                _ => continue,
            };
            fs::create_dir(folder.path().join(NEW))?;
            let path = folder.keep();
            names.insert(path.clone());
            return Ok(StagingFolder { target: target.to_owned(), _in_use: InUse(path.clone()), path, _lock: lock });
        }
    }

    /// Returns the folder to fill.
    pub fn new_folder(&self) -> PathBuf {
        self.path.join(NEW)
    }

    /// Replaces the files in the target for which `is_own` holds by the new ones; on failure the target stays as it was.
    ///
    /// # Errors
    /// When something cannot be moved.
    pub fn exchange(&self, is_own: impl Fn(&str) -> bool) -> io::Result<()> {
        let _names = in_use();
        let mut moves = Moves::default();
        // One process at a time, where folders can be locked.
        let target = File::open(&self.target);
        let _ = target.as_ref().map(File::lock);
        let exchanged = self.exchange_with(&mut moves, is_own);
        if exchanged.is_err() {
            moves.undo();
        }
        exchanged
    }

    fn exchange_with(&self, moves: &mut Moves, is_own: impl Fn(&str) -> bool) -> io::Result<()> {
        let [ready, old] = [READY, OLD].map(|name| self.path.join(name));
        fs::create_dir(&old)?;
        // A folder is somebody's, whatever its name is.
        let is_replaced = |name: &OsString| name.to_str().is_some_and(&is_own) && !self.target.join(name).is_dir();
        for name in names_in(&self.target)?.into_iter().filter(is_replaced) {
            moves.rename(self.target.join(&name), old.join(&name))?;
        }
        moves.rename(self.new_folder(), ready.clone())?;
        for name in names_in(&ready)? {
            moves.rename(ready.join(&name), self.target.join(&name))?;
        }
        Ok(())
    }
}

impl Drop for StagingFolder {
    fn drop(&mut self) {
        discard(&self.path);
    }
}

/// Renames that can be undone together.
#[derive(Default)]
struct Moves(Vec<(PathBuf, PathBuf)>);

impl Moves {
    fn rename(&mut self, from: PathBuf, to: PathBuf) -> io::Result<()> {
        fs::rename(&from, &to)?;
        self.0.push((from, to));
        Ok(())
    }

    /// Undoes the renames. What cannot be moved back stays in the staging folder, which is then kept.
    fn undo(self) {
        for (from, to) in self.0.into_iter().rev() {
            let _ = fs::rename(to, from);
        }
    }
}

/// Removes the staging folder of a process that no longer runs, after moving the target's files back.
pub fn clear(path: &Path) {
    match OpenOptions::new().read(true).write(true).open(path.join(LOCK)) {
        Ok(lock) if lock.try_lock().is_ok() => discard(path),
        // The lock is created first: without it the folder is empty, or is not removed.
        Err(e) if e.kind() == io::ErrorKind::NotFound => drop(fs::remove_dir(path)),
        _ => (),
    }
}

/// Removes a staging folder unless it holds files of the target that cannot be moved back. The lock is removed last, so that
/// the next process knows what to remove if this one is killed meanwhile.
pub fn discard(path: &Path) {
    if finish_exchange(path).is_ok() {
        let folders = [NEW, READY, OLD].map(|name| path.join(name));
        let _ = (0..ATTEMPTS).find(|_| folders.iter().all(|folder| remove(folder)) && remove(path));
    }
}

fn remove(folder: &Path) -> bool {
    fs::remove_dir_all(folder).is_ok() || !folder.exists()
}

/// Finishes an interrupted exchange: forward if all previous files were out of the way, otherwise back.
fn finish_exchange(path: &Path) -> io::Result<()> {
    let target = path.parent().unwrap_or(path);
    let Some(from) = [READY, OLD].map(|name| path.join(name)).into_iter().find(|folder| folder.is_dir()) else {
        return Ok(());
    };
    names_in(&from)?.into_iter().try_for_each(|name| fs::rename(from.join(&name), target.join(&name)))
}

/// Lists a folder completely, before anything is moved.
fn names_in(folder: &Path) -> io::Result<Vec<OsString>> {
    fs::read_dir(folder)?.map(|entry| Ok(entry?.file_name())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stale_temp;

    /// A target in which `a` and `b` are old and `theirs` is foreign, after `steps` moves of an exchange with a new `a`.
    fn exchanging(steps: usize) -> (tempfile::TempDir, StagingFolder) {
        let target = tempfile::tempdir().expect("a temporary folder");
        for name in ["a", "b", "theirs"] {
            fs::write(target.path().join(name), "old").expect("a file");
        }
        let staging = StagingFolder::in_folder(target.path()).expect("a staging folder");
        fs::write(staging.new_folder().join("a"), "new").expect("a file");
        let at = |name: &str| staging.path.join(name);
        let moves: [(PathBuf, PathBuf); 4] = [
            (target.path().join("a"), at("old/a")),
            (target.path().join("b"), at("old/b")),
            (at(NEW), at(READY)),
            (at("ready/a"), target.path().join("a")),
        ];
        fs::create_dir(at(OLD)).expect("a folder");
        moves[..steps].iter().for_each(|(from, to)| fs::rename(from, to).expect("a move"));
        (target, staging)
    }

    /// Each file with its content, sorted.
    fn listing(folder: &Path) -> Vec<(String, String)> {
        let mut listing: Vec<_> = names_in(folder)
            .expect("a folder")
            .into_iter()
            .map(|name| {
                let content = fs::read_to_string(folder.join(&name)).unwrap_or_default();
                (name.to_string_lossy().into_owned(), content)
            })
            .collect();
        listing.sort();
        listing
    }

    /// Wherever a process is killed, the target holds all the old or all the new files.
    #[test]
    fn interrupted_exchange_is_finished_or_undone() {
        let files = |all: &[(&str, &str)]| -> Vec<(String, String)> {
            all.iter().map(|(name, content)| (name.to_string(), content.to_string())).collect()
        };
        let old = files(&[("a", "old"), ("b", "old"), ("theirs", "old")]);
        let new = files(&[("a", "new"), ("theirs", "old")]);
        for (steps, expected) in [(0, &old), (1, &old), (2, &old), (3, &new), (4, &new)] {
            let (target, staging) = exchanging(steps);
            stale_temp::clear(target.path());
            assert!(staging.path.is_dir(), "its process still runs");
            // A killed process drops nothing, but its locks are released.
            staging._lock.unlock().expect("a lock");
            std::mem::forget(staging);
            stale_temp::clear(target.path());
            assert_eq!(&listing(target.path()), expected, "after {steps} moves");
        }
    }

    #[test]
    fn failed_exchange_restores_the_target() {
        let target = tempfile::tempdir().expect("a temporary folder");
        fs::write(target.path().join("a"), "old").expect("a file");
        fs::create_dir(target.path().join("a-folder")).expect("a folder");
        // A non-empty folder cannot be replaced by a file.
        fs::create_dir_all(target.path().join("z/theirs")).expect("a folder");
        let staging = StagingFolder::in_folder(target.path()).expect("a staging folder");
        for name in ["a", "z"] {
            fs::write(staging.new_folder().join(name), "new").expect("a file");
        }
        staging.exchange(|name| name == "a").expect_err("z is in the way");
        drop(staging);
        let before = [("a", "old"), ("a-folder", ""), ("z", "")].map(|(name, text)| (name.into(), text.into()));
        assert_eq!(listing(target.path()), before);
    }

    #[test]
    fn folders_stay_whatever_their_names_are() {
        let target = tempfile::tempdir().expect("a temporary folder");
        fs::write(target.path().join("run-000.csv"), "old").expect("a file");
        fs::create_dir(target.path().join("run-001.csv")).expect("a folder");
        let staging = StagingFolder::in_folder(target.path()).expect("a staging folder");
        fs::write(staging.new_folder().join("run-002.csv"), "new").expect("a file");
        staging.exchange(|_| true).expect("exchanged");
        drop(staging);
        let after = [("run-001.csv", ""), ("run-002.csv", "new")].map(|(name, text)| (name.into(), text.into()));
        assert_eq!(listing(target.path()), after);
    }
}
