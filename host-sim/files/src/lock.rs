//! Locks by which only one process works on a folder.

use std::fs::{File, TryLockError};
use std::path::Path;

use super::write::is_writing;
use mindgap_foundations::error::{Error, Result};

/// Locks a folder until the file is dropped. Programs that this process starts hold the lock too, so that a folder stays
/// locked while a program outlives a killed process. Returns `None` where the system cannot lock folders, and in a process
/// that does not write.
///
/// # Errors
/// When the folder is locked.
pub fn lock_folder(folder: &Path) -> Result<Option<File>> {
    let Some(lock) = File::open(folder).ok().filter(|_| is_writing()) else { return Ok(None) };
    match lock.try_lock() {
        Err(TryLockError::WouldBlock) => {
            let what = "is in use by another process, or by a program that it started: wait for its end, or end it";
            Err(Error::in_file(folder, what))
        }
        Err(TryLockError::Error(_)) => Ok(None),
        Ok(()) => {
            #[cfg(unix)]
            {
                // On failure programs do not hold the lock.
                let _ = rustix::io::fcntl_setfd(&lock, rustix::io::FdFlags::empty());
            }
            Ok(Some(lock))
        }
    }
}

#[cfg(all(test, unix))]
mod tests {
    use std::process::Command;
    use std::time::{Duration, Instant};

    use super::*;

    /// Far longer than any program of another test runs.
    const PATIENCE: Duration = Duration::from_secs(60);

    #[test]
    fn a_folder_is_locked_until_its_last_program_ends() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let lock = || lock_folder(folder.path());
        let first = lock().expect("free");
        assert!(first.is_some() && lock().is_err());
        let mut program = Command::new("sleep").arg("60").spawn().expect("a program");
        drop(first);
        assert!(lock().expect_err("still locked").to_string().contains("is in use by another process"));
        program.kill().and_then(|()| program.wait()).expect("it ends");
        // A program that another test of this process started meanwhile holds the lock too, until it ends.
        let deadline = Instant::now() + PATIENCE;
        while lock().is_err() {
            assert!(Instant::now() < deadline, "the folder stays locked");
            std::thread::sleep(Duration::from_millis(10));
        }
    }
}
