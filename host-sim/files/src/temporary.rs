//! Temporary names: recognisable, locked while their process is at work, and known to it, so that nothing stays under them.

use std::collections::BTreeSet;
use std::fs::{self, File, TryLockError};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use tempfile::{Builder, NamedTempFile};

/// Between these stand random letters and digits.
const PREFIX: &str = ".mindgap-";
const SUFFIX: &str = ".tmp";
const RANDOM: usize = 6;

/// Those of this process.
pub type Names = BTreeSet<PathBuf>;
static IN_USE: Mutex<Names> = Mutex::new(Names::new());

/// The temporary names of this process. While they are held, none is added, and no signal ends the process.
pub fn in_use() -> MutexGuard<'static, Names> {
    IN_USE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Keeps a path among the temporary names of this process.
pub struct InUse(pub PathBuf);

impl Drop for InUse {
    fn drop(&mut self) {
        in_use().remove(&self.0);
    }
}

/// A file that is given its name once it is complete.
pub struct TemporaryFile {
    file: NamedTempFile,
    _in_use: InUse,
}

impl TemporaryFile {
    /// A new file in a folder, as readable as any new file there.
    ///
    /// # Errors
    /// When it cannot be made.
    pub fn in_folder(folder: &Path) -> io::Result<Self> {
        let mut names = in_use();
        loop {
            let mut builder = builder();
            #[cfg(unix)]
            {
                use std::os::unix::fs::PermissionsExt;
                builder.permissions(fs::Permissions::from_mode(0o666));
            }
            let file = builder.tempfile_in(folder)?;
            if is_kept(file.as_file(), file.path()) {
                names.insert(file.path().to_owned());
                let in_use = InUse(file.path().to_owned());
                return Ok(TemporaryFile { file, _in_use: in_use });
            }
        }
    }

    /// Writes to it; the system tells now what it could not keep, and not when it is too late.
    ///
    /// # Errors
    /// When something cannot be written.
    pub fn write(&mut self, content: &[u8]) -> io::Result<()> {
        self.file.write_all(content)?;
        self.file.as_file().sync_all()
    }

    /// Gives it the mode of another file, if that is there.
    ///
    /// # Errors
    /// When it cannot have that.
    pub fn take_mode_of(&self, path: &Path) -> io::Result<()> {
        fs::metadata(path).map_or(Ok(()), |before| self.file.as_file().set_permissions(before.permissions()))
    }

    /// Puts it in the place of what is at `path`.
    ///
    /// # Errors
    /// When it cannot be there.
    pub fn become_file(self, path: &Path) -> io::Result<()> {
        self.file.persist(path)?;
        Ok(())
    }
}

/// What makes temporary names.
pub fn builder() -> Builder<'static, 'static> {
    let mut builder = Builder::new();
    builder.prefix(PREFIX).suffix(SUFFIX).rand_bytes(RANDOM);
    builder
}

/// Whether a path has a temporary name.
pub fn is_temporary(path: &Path) -> bool {
    let between = |name: &str| Some(name.strip_prefix(PREFIX)?.strip_suffix(SUFFIX)?.len());
    path.file_name().and_then(|name| name.to_str()).and_then(between) == Some(RANDOM)
}

/// Locks what has just been made at `path` until it is closed. False when somebody who clears leftovers came between the two
/// and took it away.
pub fn is_kept(lock: &File, path: &Path) -> bool {
    // Where the file system has no locks, nobody clears leftovers.
    !matches!(lock.try_lock(), Err(TryLockError::WouldBlock)) && path.exists()
}
