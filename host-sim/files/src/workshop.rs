//! A folder under a temporary name, in which another is made before all of it is put in its place.
//!
//! In it lie `lock`, held while its process is at work; `new`, what is being made; and while a folder that was there already
//! is exchanged, `old`, what was in it. `new` becomes `ready` once all that is old is out of the way: so whoever finds the
//! workshop of a killed process knows which way to go on.

use std::ffi::OsString;
use std::fs::{self, File, OpenOptions};
use std::io;
use std::path::{Path, PathBuf};

use super::temporary::{InUse, builder, in_use, is_kept};

const LOCK: &str = "lock";
const NEW: &str = "new";
const READY: &str = "ready";
const OLD: &str = "old";
/// Other threads may still be adding files to what is removed.
const ATTEMPTS: usize = 100;

/// A workshop, gone when it is dropped.
pub struct Workshop {
    home: PathBuf,
    path: PathBuf,
    _lock: File,
    _in_use: InUse,
}

impl Workshop {
    /// A new workshop in a folder.
    ///
    /// # Errors
    /// When it cannot be made.
    pub fn in_folder(home: &Path) -> io::Result<Self> {
        let mut names = in_use();
        loop {
            let folder = builder().tempdir_in(home)?;
            let lock = match File::create_new(folder.path().join(LOCK)) {
                Ok(lock) if is_kept(&lock, folder.path()) => lock,
                Err(e) if e.kind() != io::ErrorKind::NotFound => return Err(e),
                // Somebody who clears leftovers was faster.
                _ => continue,
            };
            fs::create_dir(folder.path().join(NEW))?;
            let path = folder.keep();
            names.insert(path.clone());
            return Ok(Workshop { home: home.to_owned(), _in_use: InUse(path.clone()), path, _lock: lock });
        }
    }

    /// The folder that is filled.
    pub fn new_folder(&self) -> PathBuf {
        self.path.join(NEW)
    }

    /// Puts what was made in place of what is `ours` in its home; when that fails, everything there is as it was.
    ///
    /// # Errors
    /// When something cannot be moved.
    pub fn exchange(&self, ours: impl Fn(&str) -> bool) -> io::Result<()> {
        let _whole = in_use();
        let mut moves = Moves::default();
        // One process after the other, where folders have locks.
        let home = File::open(&self.home);
        let _ = home.as_ref().map(File::lock);
        let exchanged = self.exchange_by(&mut moves, ours);
        if exchanged.is_err() {
            moves.undo();
        }
        exchanged
    }

    fn exchange_by(&self, moves: &mut Moves, ours: impl Fn(&str) -> bool) -> io::Result<()> {
        let [ready, old] = [READY, OLD].map(|name| self.path.join(name));
        fs::create_dir(&old)?;
        for name in names_in(&self.home)?.into_iter().filter(|name| name.to_str().is_some_and(&ours)) {
            moves.make(self.home.join(&name), old.join(&name))?;
        }
        moves.make(self.new_folder(), ready.clone())?;
        for name in names_in(&ready)? {
            moves.make(ready.join(&name), self.home.join(&name))?;
        }
        Ok(())
    }
}

impl Drop for Workshop {
    fn drop(&mut self) {
        discard(&self.path);
    }
}

/// Renamings that are taken back together.
#[derive(Default)]
struct Moves(Vec<(PathBuf, PathBuf)>);

impl Moves {
    fn make(&mut self, from: PathBuf, to: PathBuf) -> io::Result<()> {
        fs::rename(&from, &to)?;
        self.0.push((from, to));
        Ok(())
    }

    /// What cannot be taken back stays in the workshop, and the workshop with it.
    fn undo(self) {
        for (from, to) in self.0.into_iter().rev() {
            let _ = fs::rename(to, from);
        }
    }
}

/// Removes the workshop of a process that is no longer at work; what it had taken out of its home is put back first.
pub fn clear(path: &Path) {
    match OpenOptions::new().read(true).write(true).open(path.join(LOCK)) {
        Ok(lock) if lock.try_lock().is_ok() => discard(path),
        // Nothing comes before the lock: the folder is empty, or is not removed.
        Err(e) if e.kind() == io::ErrorKind::NotFound => drop(fs::remove_dir(path)),
        _ => (),
    }
}

/// Removes a workshop unless something in it belongs into its home and cannot be put there. The lock goes last: by it the
/// next one knows what to remove where this is killed meanwhile.
pub fn discard(path: &Path) {
    if settle(path).is_ok() {
        let folders = [NEW, READY, OLD].map(|name| path.join(name));
        let _ = (0..ATTEMPTS).find(|_| folders.iter().all(|folder| is_removed(folder)) && is_removed(path));
    }
}

fn is_removed(folder: &Path) -> bool {
    fs::remove_dir_all(folder).is_ok() || !folder.exists()
}

/// Ends an exchange that was broken off: goes on where all of the old was out of the way, and back where it was not.
fn settle(path: &Path) -> io::Result<()> {
    let home = path.parent().unwrap_or(path);
    let Some(from) = [READY, OLD].map(|name| path.join(name)).into_iter().find(|folder| folder.is_dir()) else {
        return Ok(());
    };
    names_in(&from)?.into_iter().try_for_each(|name| fs::rename(from.join(&name), home.join(&name)))
}

/// What lies in a folder, all of it before anything is moved.
fn names_in(folder: &Path) -> io::Result<Vec<OsString>> {
    fs::read_dir(folder)?.map(|entry| Ok(entry?.file_name())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::leftovers;

    /// A home in which `a` and `b` are old, `theirs` is somebody's, and a workshop has made a new `a`.
    fn exchanging(steps: usize) -> (tempfile::TempDir, Workshop) {
        let home = tempfile::tempdir().expect("a temporary folder");
        for name in ["a", "b", "theirs"] {
            fs::write(home.path().join(name), "old").expect("a file");
        }
        let workshop = Workshop::in_folder(home.path()).expect("a workshop");
        fs::write(workshop.new_folder().join("a"), "new").expect("a file");
        let at = |name: &str| workshop.path.join(name);
        let moves: [(PathBuf, PathBuf); 4] = [
            (home.path().join("a"), at("old/a")),
            (home.path().join("b"), at("old/b")),
            (at(NEW), at(READY)),
            (at("ready/a"), home.path().join("a")),
        ];
        fs::create_dir(at(OLD)).expect("a folder");
        moves[..steps].iter().for_each(|(from, to)| fs::rename(from, to).expect("a move"));
        (home, workshop)
    }

    /// Each file with its content.
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

    /// Wherever a process is killed, there is the old or the new, and never some of both.
    #[test]
    fn an_exchange_that_was_broken_off_is_settled() {
        let files = |all: &[(&str, &str)]| -> Vec<(String, String)> {
            all.iter().map(|(name, content)| (name.to_string(), content.to_string())).collect()
        };
        let old = files(&[("a", "old"), ("b", "old"), ("theirs", "old")]);
        let new = files(&[("a", "new"), ("theirs", "old")]);
        for (steps, expected) in [(0, &old), (1, &old), (2, &old), (3, &new), (4, &new)] {
            let (home, workshop) = exchanging(steps);
            leftovers::clear(home.path());
            assert!(workshop.path.is_dir(), "its process is at work");
            // A killed process drops nothing, but its locks are gone.
            workshop._lock.unlock().expect("a lock");
            std::mem::forget(workshop);
            leftovers::clear(home.path());
            assert_eq!(&listing(home.path()), expected, "after {steps} moves");
        }
    }

    #[test]
    fn what_fails_halfway_is_as_it_was() {
        let home = tempfile::tempdir().expect("a temporary folder");
        fs::write(home.path().join("a"), "old").expect("a file");
        // A folder that is not empty is in the way of a file.
        fs::create_dir_all(home.path().join("z/theirs")).expect("a folder");
        let workshop = Workshop::in_folder(home.path()).expect("a workshop");
        for name in ["a", "z"] {
            fs::write(workshop.new_folder().join(name), "new").expect("a file");
        }
        workshop.exchange(|name| name == "a").expect_err("z is in the way");
        drop(workshop);
        assert_eq!(listing(home.path()), [("a".into(), "old".into()), ("z".into(), String::new())]);
    }
}
