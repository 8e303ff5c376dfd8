//! What is left under temporary names: of killed processes, and of this one when a signal ends it.

use std::fs::{self, OpenOptions};
use std::path::Path;
use std::sync::MutexGuard;

use super::temporary::{Names, in_use, is_temporary};
use super::workshop;

/// Clears a folder of what killed processes left in it. What a process at work holds locked stays.
pub fn clear(folder: &Path) {
    let Ok(entries) = fs::read_dir(folder) else { return };
    for entry in entries.flatten().filter(|entry| is_temporary(&entry.path())) {
        let path = entry.path();
        match entry.file_type() {
            Ok(kind) if kind.is_dir() => workshop::clear(&path),
            Ok(kind) if kind.is_file() => clear_file(&path),
            _ => (),
        }
    }
}

fn clear_file(path: &Path) {
    let lock = OpenOptions::new().read(true).write(true).open(path);
    if lock.is_ok_and(|lock| lock.try_lock().is_ok()) {
        let _ = fs::remove_file(path);
    }
}

/// Removes all that this process has under temporary names. Nothing more is begun while the result is held.
pub fn remove_ours() -> MutexGuard<'static, Names> {
    let names = in_use();
    for path in names.iter() {
        if path.is_dir() {
            workshop::discard(path);
        } else {
            let _ = fs::remove_file(path);
        }
    }
    names
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::temporary::TemporaryFile;

    #[test]
    fn what_is_locked_or_somebody_elses_stays() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let at_work = TemporaryFile::in_folder(folder.path()).expect("a file");
        let others = [".mindgap-notes", ".mindgap-abcdef", "mindgap-abcdef.tmp", ".mindgap-abcdefg.tmp"];
        for name in others.iter().chain(&[".mindgap-abcdef.tmp"]) {
            fs::write(folder.path().join(name), "").expect("a file");
        }
        clear(folder.path());
        assert_eq!(fs::read_dir(folder.path()).expect("a folder").count(), 1 + others.len());
        drop(at_work);
        assert_eq!(fs::read_dir(folder.path()).expect("a folder").count(), others.len());
    }
}
